"""The differences of two runs, in words and as fields of `--json`."""

from dataclasses import asdict

from skolem.traces.compare.diff import Comparison

MOST_FIELDS = 5  # counted fields that are printed


def divergence_lines(comparison: Comparison) -> list[str]:
    """Return where two runs part, and in which fields most often."""
    lines = [line for divergence in comparison.divergences for line in divergence.lines()]
    if comparison.fields:
        lines.append("most frequent fields:")
        lines += [f"{count:6}  {name}" for name, count in comparison.by_frequency()[:MOST_FIELDS]]
    if comparison.tolerated:
        lines.append(f"{comparison.tolerated} floats differ within tolerance")
    return lines


def comparison_fields(comparison: Comparison) -> dict[str, object]:
    """Return a comparison as fields of `--json`."""
    return {
        "compared": dict(comparison.compared),
        "differing": dict(comparison.differing),
        "missing": dict(comparison.missing),
        "surplus": dict(comparison.surplus),
        "moved": comparison.moved,
        "tolerated_floats": comparison.tolerated,
        "fields": dict(comparison.by_frequency()),
        "divergences": [asdict(divergence) for divergence in comparison.divergences],
    }
