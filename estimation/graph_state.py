"""The state of the pose graph: the smoother, the present variables, and the object in each hand.

The file also holds the factor between a grasp, the base and the held object.
"""

from copy import copy
from dataclasses import dataclass, field
from typing import Literal

import gtsam
import numpy as np

from skolem.estimation.se2 import Matrix
from skolem.traces.messages import Hand, Pose2, RobotState

Factorization = Literal["CHOLESKY", "QR"]
RELINEARIZE_FROM = 0.001  # least change of a variable, metres or radians, at which its factors are linearised anew


@dataclass(frozen=True, slots=True)
class Grasp:
    """The variable of a grasp, and the object that it holds."""

    key: int
    anchor: str
    z: float  # of tool_T_object, metres


@dataclass(slots=True)
class State:
    """The part of a pose graph that events change.

    Attributes:
        isam: The smoother.
        robot: The last reading of the encoders.
        noise: Sds of a grasp, metres and radians.
        base: Key of the base's present pose.
        entry: Key of the base's pose at the last consolidation, or at the start.
        moves, looks, picks: Number of each so far.
        numbers: Number of each anchor.
        epochs: Number of times that each anchor was moved.
        first: Key of the pose from which each anchor was first picked.
        grasps: Grasp of each hand that holds an object.
        forgotten: Last world_T_object of each anchor that was given up.
    """

    isam: gtsam.ISAM2
    robot: RobotState | None = None
    noise: tuple[float, float] = (0.0, 0.0)
    base: int = field(default_factory=lambda: int(gtsam.symbol("x", 0)))
    entry: int = field(default_factory=lambda: int(gtsam.symbol("x", 0)))
    moves: int = 0
    looks: int = 0
    picks: int = 0
    numbers: dict[str, int] = field(default_factory=dict)
    epochs: dict[str, int] = field(default_factory=dict)
    first: dict[str, int] = field(default_factory=dict)
    grasps: dict[Hand, Grasp] = field(default_factory=dict)
    forgotten: dict[str, Pose2] = field(default_factory=dict)

    def copied(self) -> "State":
        """Return a copy that shares nothing changeable with this state."""
        fields = {name: copy(getattr(self, name)) for name in self.__slots__ if name != "isam"}
        return State(gtsam.ISAM2(self.isam), **fields)


def empty(factorization: Factorization = "CHOLESKY") -> State:
    """Return the state before the first event.

    Args:
        factorization: Method of the smoother. Cholesky fails as indeterminate if one place is known a thousand times
            better than another: with exact wheels, or after a long drive without a look. QR does not fail then. It
            takes a tenth longer; with large factors half as long again, and more memory.
    """
    parameters = gtsam.ISAM2Params()
    parameters.setRelinearizeThreshold(RELINEARIZE_FROM)
    parameters.relinearizeSkip = 1
    parameters.findUnusedFactorSlots = True
    parameters.setFactorization(factorization)
    return State(gtsam.ISAM2(parameters))


def grasp_factor(base: int, item: int, grasp: int, base_T_tool: Pose2, sds: tuple[float, float]) -> gtsam.CustomFactor:
    """Return the factor base * base_T_tool * grasp = item, with an analytic Jacobian.

    Args:
        base: Key of world_T_base.
        item: Key of world_T_object.
        grasp: Key of tool_T_object.
        base_T_tool: The tool's pose, which is exact.
        sds: Sds of the object's motion in its own frame, metres and radians.
    """
    tool = gtsam.Pose2(*base_T_tool)

    def error(_: gtsam.CustomFactor, values: gtsam.Values, jacobians: list[Matrix] | None) -> Matrix:
        held = tool.compose(values.atPose2(grasp))
        seen = values.atPose2(base).between(values.atPose2(item))
        off = held.between(seen)
        if jacobians is not None:
            d = gtsam.Pose2.LogmapDerivative(off)
            jacobians[0] = -d @ seen.inverse().AdjointMap()
            jacobians[1] = d
            jacobians[2] = -d @ off.inverse().AdjointMap()
        return np.asarray(gtsam.Pose2.Logmap(off))

    return gtsam.CustomFactor(diagonal(*sds), [base, item, grasp], error)


def diagonal(sd_m: float, sd_rad: float) -> gtsam.noiseModel.Diagonal:
    """Return the noise of a pose with given sds of place, each axis, and heading."""
    return gtsam.noiseModel.Diagonal.Sigmas(np.array([sd_m, sd_m, sd_rad]))
