"""Colour words beside what people call colours: `python -m benchmarks.colours [--write]`.

The XKCD survey (Munroe, 2010), which matplotlib ships, has names of 949 colours; a colour counts if the last word of
its name is one of the vocabulary. `--write` puts the boxes that fit them into rules/vocabulary.lp.
"""

import argparse
import colorsys
import re
import sys
from collections.abc import Callable
from typing import Final

import numpy as np
from matplotlib.colors import XKCD_COLORS, to_rgb
from numpy.random import PCG64, Generator, SeedSequence
from numpy.typing import NDArray

from benchmarks.colour_boxes import LEAVES, Boxes, Labels, Named, called, fact, fit
from benchmarks.tables import ROOT, Table, Target

WORDS: Final = (
    *("black", "grey", "white", "red", "orange", "brown", "yellow"),
    *("lime", "green", "turquoise", "blue", "purple", "pink"),
)
VOCABULARY: Final = ROOT / "rules" / "vocabulary.lp"
FOLDS, FOLDINGS = 5, 5
STREAM = 15  # of the draws that divide the colours into folds
MANY = 20  # colours: words with at least so many are averaged
BOXES, RIGHT, RIGHT_OF_WORD = 40, 0.80, 0.75
OTHER_LEAVES = (12, 16, LEAVES, 24, 28)
_FACTS: Final = re.compile(r"(?:colour\(\w+, \d.*\n)+")

Guess = Callable[[Named, Named], Labels]  # from colours with names to names of others


def survey() -> Named:
    """Return the colours of the survey whose name ends in a word of the vocabulary, by name."""
    rows = [
        (hsv, WORDS.index(word))
        for name, code in sorted(XKCD_COLORS.items())
        if (word := re.split("[: /]", name)[-1]) in WORDS
        for hsv in (colorsys.rgb_to_hsv(*to_rgb(code)),)
    ]
    hsv = np.array([row[0] for row in rows]) * (360.0, 100.0, 100.0)
    return Named(hsv, np.array([row[1] for row in rows], dtype=np.intp), WORDS)


def facts(boxes: Boxes) -> str:
    """Return the facts of boxes, a line each, in the order of the words."""
    return "".join(f"{fact(word, box)}\n" for word, box in sorted(boxes, key=lambda item: (WORDS.index(item[0]), item)))


def guessed(named: Named, guess: Guess, folding: int) -> Labels:
    """Return what each colour is called by those who know the other folds, shape (n,)."""
    draw = Generator(PCG64(SeedSequence([folding, STREAM])))
    fold, found = draw.permutation(len(named.word)) % FOLDS, np.empty_like(named.word)
    for k in range(FOLDS):
        found[fold == k] = guess(named.only(fold != k), named.only(fold == k))
    return found


def by_boxes(leaves: int) -> Guess:
    """Return a guess by fitted boxes."""
    return lambda known, asked: called(fit(known, leaves), asked)


def by_neighbour(known: Named, asked: Named) -> Labels:
    """Return the name of the nearest colour in the cone of hue, saturation times value, and value."""
    apart = np.linalg.norm(_cone(asked)[:, None] - _cone(known)[None], axis=2)
    return np.asarray(known.word[np.argmin(apart, axis=1)])


def _cone(named: Named) -> NDArray[np.float64]:
    hue, saturation, value = named.hsv.T
    chroma, angle = saturation * value / 100.0, np.deg2rad(hue)
    return np.column_stack((chroma * np.cos(angle), chroma * np.sin(angle), value))


def rates(named: Named, guess: Guess) -> dict[str, float]:
    """Return the share of colours called by their word, in the mean over foldings: by word, of all, and in the mean."""
    right = np.mean([guessed(named, guess, k) == named.word for k in range(FOLDINGS)], axis=0)
    of_word = {word: float(right[named.word == i].mean()) for i, word in enumerate(WORDS)}
    many = [rate for i, rate in enumerate(of_word.values()) if (named.word == i).sum() >= MANY]
    return {**of_word, "all": float(right.mean()), "mean": float(np.mean(many))}


def tables() -> list[Table]:
    """Return the table of the colour words."""
    named = survey()
    boxes = fit(named)
    found = {leaves: rates(named, by_boxes(leaves)) for leaves in OTHER_LEAVES}
    nearest, ours = rates(named, by_neighbour), found[LEAVES]
    count = {word: sum(each == word for each, _ in boxes) for word in WORDS}
    rows: list[tuple[object, ...]] = [
        (word, int((named.word == i).sum()), count[word], f"{ours[word]:.2f}", f"{nearest[word]:.2f}")
        for i, word in enumerate(WORDS)
    ]
    total = ("all colours", len(named.word), len(boxes), f"{ours['all']:.3f}", f"{nearest['all']:.3f}")
    mean = (f"mean over words with {MANY} colours or more", "", "", f"{ours['mean']:.3f}", f"{nearest['mean']:.3f}")
    others = ", ".join(
        f"{leaves} leaves: {rate['all']:.3f} in {len(fit(named, leaves))} boxes" for leaves, rate in found.items()
    )
    about = (
        f"Colours of the XKCD survey whose name ends in a word of the vocabulary, and the share of them that is called "
        f"by that word by boxes fitted to the others: {FOLDS}-fold cross-validation, mean over {FOLDINGS} foldings."
    )
    return [
        Table(
            "Colour words",
            about,
            ("word", "colours", "boxes", "called so", "called so by the nearest neighbour"),
            [*rows, total, mean],
            [
                Target(f"at most {BOXES} boxes", len(boxes) <= BOXES, str(len(boxes))),
                Target(f"at least {RIGHT} of all colours", ours["all"] >= RIGHT, total[3]),
                Target(f"at least {RIGHT_OF_WORD} in the mean over words", ours["mean"] >= RIGHT_OF_WORD, mean[3]),
            ],
            [f"By the number of leaves of the tree: {others}."],
        )
    ]


def main() -> None:
    """Print the table and the facts; with `--write`, put the facts into the vocabulary."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.colours", description=__doc__)
    parser.add_argument("--write", action="store_true", help="replace the colours of rules/vocabulary.lp")
    write = parser.parse_args().write
    made = facts(fit(survey()))
    sys.stdout.write("\n\n".join(map(str, tables())) + f"\n\n{made}")
    if write:
        VOCABULARY.write_text(_FACTS.sub(made, VOCABULARY.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
