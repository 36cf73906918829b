"""What the pose graph knows beside its log: the smoother, which variable stands for what, and who is in which hand.

Beside it stands the factor that ties a grasp to the base and to what is held.
"""

from copy import copy
from dataclasses import dataclass, field
from typing import Literal

import gtsam
import numpy as np

from skolem.estimation.se2 import Matrix
from skolem.traces.messages import Hand, Pose2, RobotState

Factorization = Literal["CHOLESKY", "QR"]
RELINEARIZE_FROM = 0.001  # change of a variable, metres or radians, from which its factors are linearised anew


@dataclass(frozen=True, slots=True)
class Grasp:
    """The variable of a grasp and what it holds."""

    key: int
    anchor: str
    z: float  # of tool_T_object, metres


@dataclass(slots=True)
class State:
    """Everything that events change.

    Attributes:
        isam: The smoother.
        robot: What the encoders last said.
        noise: Sds of a grasp, metres and radians.
        base: Key of where the base is now.
        entry: Key of where it was at the last consolidation, or at the start.
        moves, looks, picks: How many there were.
        numbers: Of each anchor.
        epochs: How often each anchor was moved.
        grasps: By the hand that holds something.
        forgotten: Where anchors that were given up were last believed.
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
    grasps: dict[Hand, Grasp] = field(default_factory=dict)
    forgotten: dict[str, Pose2] = field(default_factory=dict)

    def copied(self) -> "State":
        """Return a state that changes of this one leave alone."""
        fields = {name: copy(getattr(self, name)) for name in self.__slots__ if name != "isam"}
        return State(gtsam.ISAM2(self.isam), **fields)


def empty(factorization: Factorization = "CHOLESKY") -> State:
    """Return the state before the first event.

    Args:
        factorization: Of the smoother. Cholesky finds graphs indeterminate in which a place is known a thousand times
            better than another: where wheels are exact, or the robot has driven far without a look. QR does not; it
            takes a tenth longer, of large factors half as long again and more memory.
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
        base_T_tool: Exact.
        sds: Of the object's motion in its own frame, metres and radians.
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
    """Return the noise of a pose by the sds of its place and of its turn."""
    return gtsam.noiseModel.Diagonal.Sigmas(np.array([sd_m, sd_m, sd_rad]))
