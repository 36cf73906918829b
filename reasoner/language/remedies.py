"""What to write instead: the nearest construct of the goal language for words and signs that it does not have there."""

from collections.abc import Collection
from difflib import get_close_matches
from typing import Final

from skolem.reasoner.terms import ANY

# Words of the language itself, which name no variable and no object.
KEYWORDS: Final = frozenset(
    "exists distinct lambda the iota heaviest lightest nearest to not exactly at least most every forall".split()
) | {ANY}
HEADS: Final = ("B", "KRD", "Den", "Holds", "Was")

_COUNT: Final = "at least 2 x. Can(x)"
_NEGATION: Final = "negation is written 'not', inside of a description or of B(..): not Green(x)"
_IFF: Final = "'if and only if' is not part of the goal language; write (A & B) | (not A & not B)"
_XOR: Final = "'xor' is not part of the goal language; write (A | B) & not (A & B)"
_IMPLIES: Final = "an arrow '->' follows the condition of 'every'; elsewhere write (not A) | B"
_COMPARE: Final = "weights are compared by HeavierThan(x, y) and HeavierThan(x, 400); no other quantity is"
_DIFFERENT: Final = "write x != y inside of a description; at the head of a goal, write exists distinct o, p."
_COUNTING: Final = f"counts stand inside of B(..) or of a description: B({_COUNT}, 0.9)"
_EVERY: Final = "'every' stands inside of B(..) or of a description: B(every x. Can(x) -> On(x, table1), 0.9)"
_SUPERLATIVES: Final = "'{}' is not part of the goal language; its superlatives are heaviest, lightest and nearest"
_ROUGH: Final = f"'{{}}' is not part of the goal language; state a number: {_COUNT}"
_SOME: Final = "'{}' is not part of the goal language; write exists x. Can(x)"

_WORDS: Final = {
    "not": _NEGATION,
    "the": "'the' begins a description: Den(the x. Can(x), o)",
    "lambda": "'lambda' begins a description: Den(lambda x. Can(x), o)",
    "heaviest": "'heaviest' begins a description: Den(heaviest x. Can(x), o)",
    "lightest": "'lightest' begins a description: Den(lightest x. Can(x), o)",
    "nearest": "'nearest' begins a description: Den(nearest x to table1. Can(x), o)",
    "exactly": _COUNTING,
    "at": _COUNTING,
    "least": _COUNTING,
    "every": _EVERY,
    "distinct": _DIFFERENT,
    "was": "'Was' stands inside of a description or of B(..): Den(the x. Was(On(x, table1)), o)",
    "different": _DIFFERENT,
    "same": "write x = y inside of a description",
    "equal": "write x = y inside of a description",
    "equals": "write x = y inside of a description",
    "iff": _IFF,
    "xor": _XOR,
    "if": _IMPLIES,
    "implies": _IMPLIES,
    "and": "write & for 'and'",
    "or": "write | for 'or'",
    "some": _SOME,
    "all": _EVERY,
    "each": _EVERY,
    "no": "write not exists x. Can(x)",
    "none": "write not exists x. Can(x)",
    "only": "'only' is not part of the goal language; write every x. On(x, table1) -> Can(x)",
    "than": _COMPARE,
} | dict.fromkeys(["most", "many", "few", "several", "half"], _ROUGH)
_SIGNS: Final = {
    "<->": _IFF,
    "<=>": _IFF,
    "↔": _IFF,
    "⇔": _IFF,
    "⊕": _XOR,
    "=>": _IMPLIES,
    "->": _IMPLIES,
    "!=": _DIFFERENT,
    "⇒": _IMPLIES,
    "~": _NEGATION,
    "!": _NEGATION,
    "-": _NEGATION,
    "<": _COMPARE,
    ">": _COMPARE,
    "≤": _COMPARE,
    "≥": _COMPARE,
}
_OTHER_SUPERLATIVES: Final = frozenset(
    "biggest largest smallest tallest shortest widest highest lowest farthest furthest newest oldest best".split()
)
_TOGETHER: Final = {"atleast": "at least", "atmost": "at most", "forevery": "every", "closest": "nearest"}


def remedy_of_sign(text: str) -> str:
    """Return what to write instead of the sign at the start of a text; empty if nothing is known."""
    return next((remedy for sign, remedy in _SIGNS.items() if text.startswith(sign)), "")


def remedy_of_word(word: str, words: Collection[str]) -> str:
    """Return what to write instead of a word in a place where it cannot stand; empty if nothing is known.

    Args:
        word: As it is written.
        words: Every known relation word.
    """
    small = word.lower()
    if small in _WORDS:
        return _WORDS[small].format(word)
    of_a_word = small.endswith("est") and any(small.startswith(known.lower()[:3]) for known in words)
    if small in _OTHER_SUPERLATIVES or (of_a_word and not hint_at_keyword(small, ())):
        return _SUPERLATIVES.format(word)
    return ""


def hint(wrong: str, known: Collection[str]) -> str:
    """Return the end of a message that names the known word that is meant, or all of them."""
    close = get_close_matches(wrong, sorted(known), 1)
    if close:
        return f"; did you mean {close[0]!r}?"
    return f" (known: {', '.join(sorted(known))})" if known else ""


def hint_at_keyword(wrong: str, words: Collection[str]) -> str:
    """Return the end of a message that names the word of the language that is meant; empty if none is close."""
    known = sorted({*KEYWORDS - {ANY}, *HEADS, "at least", "at most", *words})
    if wrong in known:
        return ""
    same = [_TOGETHER[wrong.lower()]] if wrong.lower() in _TOGETHER else []
    same += [each for each in known if each.lower() == wrong.lower()]
    close = same or (get_close_matches(wrong, known, 1, 0.75) if len(wrong) > 2 else [])
    return f"; did you mean {close[0]!r}?" if close else ""
