"""The verb `explain`. May import: recorded, words, reasoner.planning."""

__all__ = ()
