"""Requirements of tests on the machine beyond Python."""

import os
from typing import NoReturn

import pytest


def missing(what: str) -> NoReturn:
    """Skip the test, or fail it if SKOLEM_CI says that the machine has everything."""
    said = f"missing on this machine: {what}"
    if os.environ.get("SKOLEM_CI"):
        pytest.fail(said)
    pytest.skip(said)
