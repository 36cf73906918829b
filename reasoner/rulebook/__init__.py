"""Rule files: read, judged, and asked through clingo. May import: language."""

__all__ = ()
