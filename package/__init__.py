"""A robot that achieves goals about objects that are only described.

Its parts are packages: `skolem.reasoner`, `skolem.estimation`, `skolem.sim`, `skolem.traces` and `skolem.tools.loop`
say in `__all__` what they promise. Here is the version alone. May import: tools.cli.
"""

from typing import TYPE_CHECKING

__all__ = ("__version__",)

if TYPE_CHECKING:
    __version__: str
else:

    def __getattr__(name):
        """Return the version, as it was installed; looked up when it is asked for, since that takes time."""
        if name != "__version__":
            raise AttributeError(f"module 'skolem' has no attribute {name!r}")
        from importlib.metadata import version

        return version("skolem")
