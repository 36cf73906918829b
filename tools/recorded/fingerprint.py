"""A check, by what a trace records, whether two machines compute the same floats."""

from collections.abc import Mapping
from typing import Final

from skolem.traces.file.environment import environment

DECIDES_FLOATS: Final = (  # entries of the environment that may change the last digits of computed numbers
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
    """Return how this machine and its libraries differ from those of a run; empty if floats must be equal."""
    here = environment()
    return [key for key in DECIDES_FLOATS if recorded.get(key, "") != here.get(key, "")]
