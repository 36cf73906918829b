"""What a goal speaks of: properties, their complements, and numbers of objects. May import: language, rulebook.

`literals` finds the properties that make a description true or false, `complements` the properties of what lacks one.
`statements` reads a sentence as a number of objects that fit a description. `universe` holds all that a goal leads to.
`evaluations` finds what the chosen evaluation gives no value to.
"""

__all__ = ()
