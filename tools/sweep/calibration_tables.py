"""Calibration as tables of a report: reliability of each kind of claim, and the size of the errors."""

from skolem.tools.sweep.calibration import BINS, Bin, Calibration
from skolem.tools.sweep.shares import CONFIDENCE, wilson


def calibration_tables(found: Calibration) -> list[str]:
    """Return the lines of both tables; a kind without claims or errors is left out."""
    return [
        "Calibration: a claim of the belief counts whenever its probability changes.",
        "",
        "| claim | number | expected calibration error | probability: share that is true, of how many |",
        "|---|---|---|---|",
        *(_claims(kind, bins, error) for kind, bins in found.claims.items() if (error := found.ece(kind)) is not None),
        "",
        f"| errors at the end | degrees of freedom | NEES for each | {CONFIDENCE:.0%} band of right covariances |",
        "|---|---|---|---|",
        *(_errors(found, kind) for kind, errors in found.errors.items() if errors.freedom),
    ]


def _claims(kind: str, bins: list[Bin], error: float) -> str:
    cells = [f"{_range(i)}: {_share(each)}" for i, each in enumerate(bins) if each.claims]
    return f"| {kind} | {sum(each.claims for each in bins)} | {error:.3f} | {'; '.join(cells)} |"


def _range(number: int) -> str:
    return f"{number / BINS:.1f} to {(number + 1) / BINS:.1f}"


def _share(found: Bin) -> str:
    low, high = wilson(found.hits, found.claims)
    return f"{found.hits / found.claims:.2f} ({low:.2f} to {high:.2f}), of {found.claims}"


def _errors(found: Calibration, kind: str) -> str:
    errors = found.errors[kind]
    low, high = errors.band(CONFIDENCE)
    return f"| {kind} | {errors.freedom} | {errors.nees / errors.freedom:.2f} | {low:.2f} to {high:.2f} |"
