"""What holds, what is offered, and what to do next.

May import: protocols, language, rulebook, worlds, meaning.
"""

__all__ = ()
