"""The verb `sweep`: many runs, their tables, and calibration.

May import: loop, recorded, words, reasoner.planning.
"""

__all__ = ()
