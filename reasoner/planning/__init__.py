"""What holds, what is offered, and what to do next. May import: protocols, language, rulebook."""

__all__ = ()
