"""The verb `generate`. May import: loop."""

__all__ = ()
