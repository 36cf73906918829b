"""The machine and the library versions of a run, which are recorded outside every hash."""

import os
import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGES = (
    "clingo",
    "example-robot-data",
    "foxglove-schemas-protobuf",
    "gtsam",
    "mcap",
    "numpy",
    "ompl",
    "protobuf",
    "pybullet",
    "pydantic",
    "scipy",
    "skolem",
    "zstandard",
)
SIMD_PREFIXES = ("avx", "fma", "sse4")


def environment() -> dict[str, str]:
    """Return what may explain that two machines differ in last digits: no date, host name or path."""
    return {
        "python": platform.python_version(),
        "system": platform.system(),
        "machine": platform.machine(),
        "simd": _simd_flags(),
        "OPENBLAS_CORETYPE": os.environ.get("OPENBLAS_CORETYPE", ""),
        "NPY_DISABLE_CPU_FEATURES": os.environ.get("NPY_DISABLE_CPU_FEATURES", ""),
    } | {f"version {name}": _version(name) for name in PACKAGES}


@cache  # a loaded library does not change
def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _simd_flags(cpu_info: Path = Path("/proc/cpuinfo")) -> str:
    """Return the vector instructions of the first processor, sorted; empty if the system does not list them."""
    if not cpu_info.exists():
        return ""
    lines = (line for line in cpu_info.read_text().splitlines() if line.startswith(("flags", "Features")))
    flags = next(lines, ":").partition(":")[2].split()
    return " ".join(sorted(flag for flag in flags if flag.startswith(SIMD_PREFIXES)))
