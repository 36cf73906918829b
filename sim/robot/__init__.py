"""The PR2: its model, its bodies in the physics engine, its arms and their reach. May import: nothing."""

__all__ = ()
