"""The verb `explain`. May import: loop, recorded, words, reasoner.agent, reasoner.planning."""

__all__ = ()
