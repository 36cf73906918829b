"""Random worlds with a known answer, drawn family by family. May import: space."""

__all__ = ()
