"""Whether two machines compute the same floats, as far as a trace tells."""

from collections.abc import Mapping
from typing import Final

from skolem.traces.file.environment import environment

DECIDES_FLOATS: Final = (  # what may change the last digits of what the mind computes
    "python",
    "system",
    "machine",
    "simd",
    "OPENBLAS_CORETYPE",
    "NPY_DISABLE_CPU_FEATURES",
    "version clingo",
    "version example-robot-data",
    "version gtsam",
    "version numpy",
    "version ompl",
    "version pybullet",
    "version scipy",
)


def differences(recorded: Mapping[str, str]) -> list[str]:
    """Return what is different here from the machine and the libraries of a run; empty if floats must be equal."""
    here = environment()
    return [key for key in DECIDES_FLOATS if recorded.get(key, "") != here.get(key, "")]
