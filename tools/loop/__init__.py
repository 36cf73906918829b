"""The loop observe, update, decide, act: `Mind`, `World`, what a run is made of, and the verdict.

May import: the folders below, and nothing of tools.
"""
