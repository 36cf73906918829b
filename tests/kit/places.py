"""Folders of a checkout that tests read."""

from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).parents[2]
TESTS: Final = ROOT / "tests"
DATA: Final = TESTS / "data"
GOLDEN: Final = TESTS / "golden"
RULES: Final = ROOT / "rules"
SCENARIOS: Final = ROOT / "scenarios"
