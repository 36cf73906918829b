"""Faults of an input as fields of `--json`."""

from skolem.traces.errors import InputError


def fault_rows(error: InputError) -> list[dict[str, object]]:
    """Return faults as the fields of `--json`."""
    return [
        {"file": f.file, "line": f.line, "column": f.column, "at": f.at, "message": f.message} for f in error.faults
    ]
