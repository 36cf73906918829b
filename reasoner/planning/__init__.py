"""What holds, what is offered, and what to do next. May import: rulebook."""

__all__ = ()
