"""The probability that a description holds, over the possible worlds. May import: protocols, language, rulebook.

`circuits` compiles a description by the axioms of `denote.lp`. `grounding` puts the objects of a `universe` in place of
its variables; that gives formulas over independent variables (`diagrams`, `cells`). `counting` computes their
probabilities, and `sampling` integrates over relations of poses. `evaluator` is what others ask.
"""

__all__ = ()
