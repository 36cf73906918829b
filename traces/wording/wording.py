"""The record of a run in words: fluents, operations, codes, and sentences with terms in them.

A fluent such as `b(den(e1,sodaE),105361)` reads `P(sodaE is the green thing) >= .9`, an operation such as
`Move(pick(left,sodaC))` reads `drive to pick sodaC with the left hand`. Fluents and operations that a user's rule files
add are shown as recorded. No record changes: words are made when text is shown.
"""

import re
from collections.abc import Iterable
from typing import Final

from skolem.traces.messages import Plan, PlanCause, RunEnd, RunStatus
from skolem.traces.wording import activities, fluents
from skolem.traces.wording.reasons import CAUSES, REFUSALS, RISKS, STATUSES, in_words
from skolem.traces.wording.recorded import Recorded, read, within
from skolem.traces.wording.things import Things

_VARIABLE: Final = re.compile(r"(?<!sk\()\bvar\((\w+)\)")
_CODE: Final = re.compile(r": ([a-z]+(?:_[a-z]+)+)(?= \[)")  # the reason of a rule, before its file and line
_OBVIOUS: Final = re.compile(r"krd\(\w+\)")


class Wording:
    """Shows everything as recorded, for `--raw`; `InWords` shows the same in words."""

    in_words = False

    def fluent(self, text: str) -> str:
        """Return a fluent."""
        return text

    def aim(self, texts: Iterable[str]) -> str:
        """Return a conjunction of fluents."""
        return " & ".join(map(self.fluent, texts))

    def operation(self, text: str) -> str:
        """Return an operation, an activity or a rule instance."""
        return text

    def described(self, expression: str) -> str:
        """Return the object of the goal's description with a constant."""
        return expression

    def meant(self, expression: str) -> str:
        """Return the heading for the probabilities that objects are meant by a description."""
        return f"P(Den) of {expression}"

    def sentence(self, text: str) -> str:
        """Return a text in which there may be fluents and operations."""
        return text

    def cause(self, cause: PlanCause) -> str:
        """Return why the plan stack changed."""
        return cause

    def refusal(self, code: str) -> str:
        """Return why rules refuse a step."""
        return code

    def risk(self, code: str, p: float) -> str:
        """Return the cost of a step: the risk, and the probability `p` that it does not happen."""
        return f"cost: {code}, p = {p:.3f}"

    def ended(self, status: RunStatus, reason: str) -> str:
        """Return how a run ended, and why."""
        return f"{status}: {reason}"

    def end(self, end: RunEnd) -> str:
        """Return how a run ended, and why."""
        return self.ended(end.status, end.reason)

    def drop(self, plan: Plan) -> str:
        """Return why plans were dropped; `plan` is the change of the stack that says so."""
        return f"{plan.cause}: {', '.join(plan.false_fluents) or 'no step applies'}"


class InWords(Wording):
    """Shows everything in words."""

    in_words = True

    def __init__(self, things: Things) -> None:
        """Use the facts about a run."""
        self._things = things

    def fluent(self, text: str) -> str:
        """Return a fluent as a clause: `P(sodaE is the green thing) >= .9`."""
        term = read(text)
        return text if term is None else fluents.clause(self._things, term)

    def aim(self, texts: Iterable[str]) -> str:
        """Return a conjunction of fluents, with `some object` for variables of the goal.

        Fluents that say only that a named object is known by its name are left out.
        """
        found = tuple(texts)
        variables = dict.fromkeys(name for text in found for name in _VARIABLE.findall(text))
        stated = [text for text in found if not _OBVIOUS.fullmatch(text)] or found
        head = f"some object {' and some object '.join(variables)}: " if variables else ""
        return head + " and ".join(map(self.fluent, stated))

    def operation(self, text: str) -> str:
        """Return an operation as an infinitive: `look at sodaE`."""
        term = read(text)
        return text if term is None else activities.do(self._things, term)

    def described(self, expression: str) -> str:
        """Return the object of a description: `the green thing`."""
        return self._things.described(Recorded(expression))

    def meant(self, expression: str) -> str:
        """Return the heading for the probabilities that objects are meant by a description."""
        return f"P(it is {self.described(expression)})"

    def sentence(self, text: str) -> str:
        """Return a text with its fluents and operations in words; terms with variables of the rules stay."""
        parts, end = list[str](), 0
        for start, after in within(text):
            parts += [text[end:start], self._term(text[start:after])]
            end = after
        return _CODE.sub(lambda code: f": {in_words(code[1], REFUSALS)}", "".join([*parts, text[end:]]))

    def _term(self, text: str) -> str:
        term = read(text)
        if term is None or _is_pattern(term):
            return text
        if fluents.known(term):
            return fluents.clause(self._things, term)
        return activities.do(self._things, term) if activities.verb(term) else text

    def cause(self, cause: PlanCause) -> str:
        """Return why the plan stack changed."""
        return CAUSES[cause]

    def refusal(self, code: str) -> str:
        """Return why rules refuse a step: `no hand can grasp it`."""
        return self.sentence(in_words(code, REFUSALS))

    def risk(self, code: str, p: float) -> str:
        """Return the risk of a step, and the probability that it does not happen."""
        term = read(code)
        match term:
            case Recorded("missed", (thing,)):
                said = f"{self._things.name(thing)} is not detected"
            case Recorded("missed_again", (thing,)):
                said = f"{self._things.name(thing)} is not detected in one of the looks that are needed too"
            case _:
                said = in_words(code, RISKS)
        return f"goes well with p = {p:.3f}; the risk: {said}"

    def ended(self, status: RunStatus, reason: str) -> str:
        """Return how a run ended, and why."""
        return f"{STATUSES[status]}: {self.sentence(reason)}"

    def drop(self, plan: Plan) -> str:
        """Return why plans were dropped: `P(sodaE is the green thing) >= .9 is no longer believed`."""
        if plan.cause == "refused":
            step, *lacking = map(self._refused, plan.false_fluents)
            return f"cannot be done here: {step}{', which needs that ' if lacking else ''}{' and '.join(lacking)}"
        lost = fluents.weakest((text, read(text)) for text in plan.false_fluents)
        if not lost:
            return "no step of the plan can be taken any more"
        said = [self.fluent(text) for text in lost]
        if all(text.startswith("P(") for text in said):
            return f"{' and '.join(said)} {'is' if len(said) == 1 else 'are'} no longer believed"
        return f"this is not so now: {'; '.join(said)}"

    def _refused(self, text: str) -> str:
        term = read(text)
        if term is not None and fluents.known(term):
            return fluents.clause(self._things, term)
        return self.operation(text)


def _is_pattern(term: Recorded) -> bool:
    """Return whether a term has variables of the rules: then it is about rules, not about the run."""
    return (not term.args and term.name[:1].isupper()) or any(map(_is_pattern, term.args))


AS_RECORDED: Final = Wording()
