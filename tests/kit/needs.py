"""What a test needs of the machine beyond Python."""

import os
from typing import NoReturn

import pytest


def missing(what: str) -> NoReturn:
    """Skip the test, or fail it on a machine that is expected to have everything, which SKOLEM_CI says."""
    said = f"missing on this machine: {what}"
    if os.environ.get("SKOLEM_CI"):
        pytest.fail(said)
    pytest.skip(said)
