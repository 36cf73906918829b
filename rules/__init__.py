"""The inference rules, denotation axioms and operator descriptions, as ASP files; no Python logic lives here."""

__all__ = ()
