"""The verb `explain`. May import: loop, recorded, words, reasoner.planning."""

__all__ = ()
