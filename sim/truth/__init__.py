"""What worlds alone may know: the bodies that are there, and the draws of noise. May import: nothing."""

__all__ = ()
