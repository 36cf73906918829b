"""The verb `explain`. May import: recorded, words, reasoner.agent, reasoner.planning."""

__all__ = ()
