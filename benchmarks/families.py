"""Description of the families of random worlds: their ranges, and histograms of drawn worlds."""

import argparse
import math
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import fields
from pathlib import Path
from typing import get_args

from skolem.reasoner.planning.queries import load_rules
from skolem.sim.families.compose import Drawn, drawn
from skolem.sim.families.ranges import FAMILIES, Proof, Variant
from skolem.sim.families.things import Thing
from skolem.sim.families.words import Words
from skolem.sim.space.footprints import distance, footprint
from skolem.tools.sweep.report import with_section

BARS = " ▁▂▃▄▅▆▇█"
HIDDEN = ("name", "about", "construct")  # fields of a variant that are no ranges


def main() -> None:
    """Print the ranges and the histograms, or put them into a page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.families", description=__doc__)
    parser.add_argument("--seeds", type=int, default=100, help="worlds of each family")
    parser.add_argument("--write", type=Path, help="Markdown file that gets the account, between its markers")
    args = parser.parse_args()
    vocabulary = load_rules().vocabulary
    words = Words(vocabulary.types, vocabulary.meanings)
    account = f"{ranges()}\n\n{histograms(words, args.seeds)}\n"
    if args.write is None:
        sys.stdout.write(account)
    else:
        args.write.write_text(with_section(args.write.read_text(encoding="utf-8"), "families", account))


def ranges() -> str:
    """Return the ranges of every variant that differ from the usual ones, in Markdown."""
    usual = Variant("", "")
    lines = [
        "### Ranges",
        "",
        f"Unless the table says otherwise: {'; '.join(_range(usual, name) for name in _names())}.",
        "",
        "| family | variant | what is hard | ranges |",
        "|---|---|---|---|",
    ]
    for family, variants in FAMILIES.items():
        for variant in variants:
            own = [name for name in _names() if getattr(variant, name) != getattr(usual, name)]
            lines.append(
                f"| {family} | {variant.name} | {variant.about} | {'; '.join(_range(variant, n) for n in own)} |"
            )
    return "\n".join(lines)


def _names() -> list[str]:
    return [field.name for field in fields(Variant) if field.name not in HIDDEN]


def _range(variant: Variant, name: str) -> str:
    value = getattr(variant, name)
    if name == "palette":
        spans = (f"{part} {_said(getattr(value, part))}" for part in ("hue", "saturation", "value"))
        return f"palette {', '.join(spans)}"
    return f"{name} {_said(value)}"


def _said(value: object) -> str:
    if isinstance(value, tuple):
        return " to ".join(_said(each) for each in value)
    return f"{value:g}" if isinstance(value, float) else str(value)


def histograms(words: Words, seeds: int) -> str:
    """Return a line for each family and quantity: least, most, and a histogram of the drawn values."""
    lines = [
        "### What is drawn",
        "",
        f"Of seeds 0 to {seeds - 1} of each family. A bar is a tenth of the way from the least to the most; it is as "
        "high as that part is frequent.",
        "",
        "| family | achievable | nothing fits, too few, too many, nothing reached, no room | retries | things | "
        "gap to the nearest, cm | margin of witnesses, sd | put aside |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for family in FAMILIES:
        worlds = [drawn(family, seed, words) for seed in range(seeds)]
        answers = Counter(made.certificate.impossible for made in worlds)
        proofs = ", ".join(str(answers[key]) for key in get_args(Proof))
        columns = [
            f"{answers[None]}",
            proofs,
            f"{sum(made.retries for made in worlds)}",
            *(_histogram(value(made, words) for made in worlds) for value in VALUES),
        ]
        lines.append(f"| {family} | {' | '.join(columns)} |")
    return "\n".join(lines)


def _things(made: Drawn, words: Words) -> Iterable[float]:
    return [sum(words.types[thing.type].graspable for thing in made.world.things)]


def _gaps(made: Drawn, words: Words) -> Iterable[float]:
    """Yield the gap to the nearest neighbour on the table for each object that has one, cm."""
    things = [thing for thing in made.world.things if words.types[thing.type].graspable]
    for thing in things:
        gaps = [_gap(thing, other, words) for other in things if other.id != thing.id and other.on == thing.on]
        yield from [100.0 * min(gaps)] if gaps else []


def _gap(a: Thing, b: Thing, words: Words) -> float:
    return distance(footprint(words.types[a.type], a.at), footprint(words.types[b.type], b.at))


def _margins(made: Drawn, words: Words) -> Iterable[float]:
    return [witness.margin_sd for witness in made.certificate.witnesses]


def _cleared(made: Drawn, words: Words) -> Iterable[float]:
    return [float(len(witness.cleared)) for witness in made.certificate.witnesses]


VALUES: tuple[Callable[[Drawn, Words], Iterable[float]], ...] = (_things, _gaps, _margins, _cleared)


def _histogram(parts: Iterable[Iterable[float]]) -> str:
    """Return the least number, the bars and the largest number as text."""
    numbers = [number for part in parts for number in part]
    if not numbers:
        return "-"
    low, high = min(numbers), max(numbers)
    counts = _counts(numbers, low, high)
    most = max(counts)
    bars = "".join(BARS[math.ceil(count / most * (len(BARS) - 1))] for count in counts)
    return f"{low:.3g} `{bars.replace(' ', '·')}` {high:.3g}"


def _counts(numbers: Sequence[float], low: float, high: float, parts: int = 10) -> list[int]:
    found = [0] * parts
    for number in numbers:
        found[min(parts - 1, int(parts * (number - low) / ((high - low) or 1.0)))] += 1
    return found


if __name__ == "__main__":
    main()
