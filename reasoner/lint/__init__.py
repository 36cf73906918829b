"""Doubtful rules, and the reference of rules made from their comments. May import: planning, rulebook."""

__all__ = ()
