"""B10: KRD of a variable is false, not an error."""

from kit.papers import Handler, at_five_percent, can, holds


def test_an_existential_variable_is_not_a_rigid_designator() -> None:
    """ "A may be a variable or a constant; it has value True if and only if A is an internal anchoring constant." """
    belief = Handler(at_five_percent([can("can1")])).belief
    assert not holds("krd(var(o))", belief)
