"""Looks at a crowded table, detection by detection: association, and the effect of gross errors."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.random import PCG64, Generator, SeedSequence
from numpy.typing import NDArray

from skolem.estimation.belief import Belief
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import Looked
from skolem.estimation.se2 import between, compose, exp
from skolem.sim.detector.detect import pose_covariance
from skolem.sim.symbolic.view import Solid, camera, depth_view
from skolem.traces.messages import (
    Action,
    ActionResult,
    Detection,
    HsvBelief,
    LookAt,
    MoveBase,
    NoiseModel,
    ObjectType,
    Observation,
    Pose2,
    Prior,
    PriorObject,
    RobotState,
)
from skolem.traces.messages.arm import CARRY

Array = NDArray[np.float64]
CAN = ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.115), graspable=True)
TABLE = ObjectType(shape="table", size_m=(0.8, 1.2, 0.7), graspable=False)
ROBOT = RobotState(torso=0.2, head=(0.0, 0.6), right_arm=CARRY["right"], left_arm=CARRY["left"])  # out of the view
NOISE = NoiseModel()
FIT_SD, ROUND_SD = 0.002, 1.8  # position, m, and heading, rad, of a detected can
CAMERA = camera(ROBOT.torso, *ROBOT.head)
GROSS_M = (0.15, 0.50)  # error of an outlier on each axis: well beyond the prior of a can
MODERATE_M = (0.08, 0.40)  # error of a moderate outlier, from two to four sds of the prior on
LEAST, MOST = (0.65, -0.60), (1.30, 0.60)  # x and y of the part of the table that the camera sees
SAME_M = 0.15  # an anchor farther than this from a can does not stand for it
GIVEN_UP = EstimatorConfig().retired
TESTED = 0.5  # below so many expected detections, looks do not test an anchor
GHOST_M = 0.05  # an anchor farther than this from every can stands for nothing


@dataclass(frozen=True, slots=True)
class Crowd:
    """The difficulty of a look.

    Attributes:
        name: Name for people.
        cans: Number of cans, on a square grid.
        spacing_m: Spacing of the grid.
        base_sds: Standard deviations of the base, x, y, theta.
        told_sd_m: Standard deviation of each can in the prior.
        found: Share of the cans that is detected.
    """

    name: str
    cans: int
    spacing_m: float
    base_sds: tuple[float, float, float]
    told_sd_m: float
    found: float


def whole_look_is_right(crowd: Crowd, seed: int, hypotheses: int) -> bool:
    """Return whether every detected can of a first look is associated with its own anchor."""
    draws = Generator(PCG64(SeedSequence([seed])))
    side = math.ceil(math.sqrt(crowd.cans))
    grid = [divmod(i, side) for i in range(crowd.cans)]
    middle = crowd.spacing_m * (side - 1) / 2.0
    told: dict[str, Pose2] = {
        f"can{i}": (0.7 + crowd.spacing_m * row, crowd.spacing_m * column - middle, 0.0)
        for i, (row, column) in enumerate(grid)
    }
    error = exp(draws.normal(size=3) * crowd.base_sds)
    true = {name: moved(pose, draws, crowd.told_sd_m) for name, pose in told.items()}
    seen = {name: between(error, pose) for name, pose in true.items() if draws.random() < crowd.found}
    config = EstimatorConfig(hypotheses=hypotheses)
    belief = Belief(prior(told, crowd.told_sd_m, crowd.base_sds, NOISE), config)
    look(belief, 0, [detection(pose) for pose in seen.values()], [])
    (event,) = (event for event in belief.events if isinstance(event, Looked))
    places = {s.anchor: s.detection.base_T_object[:2] for s in event.sightings}
    return {name: pose[:2] for name, pose in seen.items()} == places


@dataclass(frozen=True, slots=True)
class Gross:
    """The gross errors of a run.

    Attributes:
        outliers: Share of outliers among the detections.
        false: False detections, as a share of the cans.
        off_m: Least and largest error of outliers on each axis.
        counted: Whether the robot's noise model counts outliers, as a calibration would: each as a missed detection and
            a false one. It always counts false detections.
        looked_through: Whether the robot uses that its picture shows the space behind a detection.
        left_out: Whether the gross errors are removed, which shows the best possible result.
    """

    outliers: float
    false: float
    off_m: tuple[float, float] = GROSS_M
    counted: bool = True
    looked_through: bool = True
    left_out: bool = False

    def noise(self, cans: int) -> NoiseModel:
        """Return the robot's noise model of its detector."""
        outliers = self.outliers if self.counted else 0.0
        false = 0.0 if self.left_out else self.false + outliers * NOISE.found
        return NOISE.model_copy(
            update={
                "found": NOISE.found * (1.0 - outliers),
                "false_per_look": max(false * cans, NOISE.false_per_look),
            }
        )


@dataclass(frozen=True, slots=True)
class Endured:
    """The effect of gross errors on a run.

    Attributes:
        off_m: Distance of each can from its listed anchor, relative to the base, after each look, shape (looks, cans),
            metres; NaN for a can without listed anchor.
        strays: Number of listed anchors that stand for nothing, after each look, shape (looks,).
        untested: Number of those at the end that the calm looks would hardly have detected if they were real.
        lost: Number of cans without any anchor at the end, listed or doubted.
        duplicates: Number of listed anchors beyond one for each can, at the end.
        renamed: Number of cans that are listed under another name than in the prior.
    """

    off_m: Array
    strays: NDArray[np.int64]
    untested: int
    lost: int
    duplicates: int
    renamed: int


def endured(seed: int, cans: int, looks: int, calm: int, gross: Gross) -> Endured:
    """Return the effect of looks with gross errors, followed by a few calm ones, on a belief.

    Args:
        seed: Seed of every random draw; the other draws do not depend on the gross errors.
        cans: Number of cans on the table.
        looks: Number of looks with gross errors.
        calm: Number of looks without them.
        gross: The errors.
    """
    draws, errors = Generator(PCG64(SeedSequence([seed]))), Generator(PCG64(SeedSequence([seed, 1])))
    told: dict[str, Pose2] = {
        f"can{i}": (0.75 + 0.15 * (i % 2), 0.17 * (i - (cans - 1) / 2.0), 0.0) for i in range(cans)
    }
    config = EstimatorConfig() if gross.looked_through else EstimatorConfig(refuted=1.0)
    belief = Belief(prior(told, 0.03, (0.01, 0.01, 0.01), gross.noise(cans)), config)
    base = exp(draws.normal(size=3) * 0.01)
    true = {name: moved(pose, draws, 0.03) for name, pose in told.items()}
    here = {name: between(base, pose) for name, pose in true.items()}
    off, strays = [], []
    for step in range(looks + calm):
        if step % 3 == 2:
            motion = exp(draws.uniform(-0.05, 0.05, 3))
            base = compose(compose(base, motion), exp(draws.normal(size=3) * (0.006, 0.006, 0.011)))
            drive(belief, motion)
            here = {name: between(base, pose) for name, pose in true.items()}
        seen = _reported([*here.values()], draws)
        seen = seen if step >= looks else _with_errors(seen, gross, errors)
        look(belief, step, [detection(pose) for pose in seen if pose], [*here.values()])
        distances = _distances(belief, belief.anchors(), here)
        off.append(_nearest(distances))
        strays.append(int((distances.min(axis=1) >= GHOST_M).sum()))
    named = {s.anchor for event in belief.events if isinstance(event, Looked) for s in event.sightings} | set(told)
    left = [name for name in sorted(named) if belief.prob_exists(name) >= GIVEN_UP]
    near, listed = distances < GHOST_M, _loose(belief, belief.anchors())
    strange = [name not in told for name in listed]
    ghosts = [name for name, row in zip(listed, near, strict=True) if not row.any()]
    return Endured(
        off_m=np.array(off),
        strays=np.array(strays),
        untested=sum(_reports(belief, name, looks) < TESTED for name in ghosts),
        lost=int(np.isnan(_nearest(_distances(belief, left, here))).sum()),
        duplicates=int(np.maximum(near.sum(axis=0) - 1, 0).sum()),
        renamed=int(near[strange].any(axis=0).sum()),
    )


def _reports(belief: Belief, anchor: str, after: int) -> float:
    """Return the expected number of detections of an anchor by the looks from `after` on that missed it."""
    looks = [event for event in belief.events if isinstance(event, Looked)][after:]
    return sum(missed.p_reported for event in looks for missed in event.missed if missed.anchor == anchor)


def _reported(here: list[Pose2], draws: Generator) -> list[Pose2 | None]:
    """Return the detected pose of each can; None for a can that is not detected."""
    calibration = exp(draws.normal(size=3) * (0.004, 0.004, 0.004))
    seen = [moved(compose(calibration, pose), draws, FIT_SD) for pose in here]
    return [pose if luck < NOISE.found else None for pose, luck in zip(seen, draws.random(len(here)), strict=True)]


def _with_errors(seen: list[Pose2 | None], gross: Gross, draws: Generator) -> list[Pose2 | None]:
    """Return the poses with outliers and false detections added, unless these are left out."""
    far = [draws.random() < gross.outliers for _ in seen]
    wrong = [
        shifted(pose, gross.off_m, draws) if pose and is_far else None for pose, is_far in zip(seen, far, strict=True)
    ]
    nothing = draws.uniform(LEAST, MOST, (draws.poisson(gross.false * len(seen)), 2)).tolist()
    right = [pose for pose, is_far in zip(seen, far, strict=True) if not is_far]
    return right if gross.left_out else [*right, *wrong, *((x, y, 0.0) for x, y in nothing)]


def _loose(belief: Belief, anchors: Iterable[str]) -> list[str]:
    return [name for name in anchors if belief.graspable(name)]


def _distances(belief: Belief, anchors: Iterable[str], here: dict[str, Pose2]) -> Array:
    """Return the distance of each anchor from each can, shape (anchors, cans), metres."""
    rows = [[_off_m(belief, name, pose) for pose in here.values()] for name in _loose(belief, anchors)]
    return np.array(rows).reshape(-1, len(here))


def _nearest(distances: Array) -> Array:
    """Return the distance of each can from its anchor, shape (cans,), metres; NaN if none is near.

    An anchor belongs to the can that is nearest to it, so that a can without anchor does not get a neighbour's.
    """
    own = np.where(distances <= distances.min(axis=1, keepdims=True), distances, math.inf)
    nearest = own.min(axis=0, initial=math.inf)
    return np.where(nearest < SAME_M, nearest, math.nan)


def moved(pose: Pose2, draws: Generator, sd_m: float) -> Pose2:
    """Return a pose with a small drawn error."""
    return compose(pose, exp(draws.normal(size=3) * (sd_m, sd_m, 0.0)))


def shifted(pose: Pose2, off_m: tuple[float, float], draws: Generator) -> Pose2:
    """Return a pose with a gross drawn error, on the table and in view: a camera detects nothing out of view."""
    while True:
        far, sign = draws.uniform(*off_m, 2), np.sign(draws.uniform(-1.0, 1.0, 2))
        x, y = pose[0] + float(far[0] * sign[0]), pose[1] + float(far[1] * sign[1])
        if LEAST[0] <= x <= MOST[0] and LEAST[1] <= y <= MOST[1]:
            return (x, y, pose[2])


def _off_m(belief: Belief, name: str, base_T_can: Pose2) -> float:
    return math.dist(belief.gaussian("pose", name).mean[:2], base_T_can[:2])


# ---------------------------------------------------------------- the robot's prior, drives and looks


def prior(cans: dict[str, Pose2], sd_m: float, base_sds: tuple[float, float, float], noise: NoiseModel) -> Prior:
    """Return the prior of a table of cans."""
    table = PriorObject(
        anchor="table1", type={"table": 1.0}, world_T_object=(1.0, 0.0, 0.0, 0.0), sd_xy_m=0.01, sd_theta_rad=0.005
    )
    objects = [
        PriorObject(
            anchor=name,
            type={"soda": 1.0},
            world_T_object=(x, y, TABLE.size_m[2], theta),
            sd_xy_m=sd_m,
            sd_theta_rad=ROUND_SD,
            support="table1",
        )
        for name, (x, y, theta) in cans.items()
    ]
    return Prior(
        world_T_base=(0.0, 0.0, 0.0),
        base_sd_xy_m=base_sds[0],
        base_sd_theta_rad=base_sds[2],
        robot=ROBOT,
        objects=(table, *objects),
        types={"soda": CAN, "table": TABLE},
        colour=HsvBelief(mean=(0.5, 0.5, 0.5), variance=(0.1, 0.1, 0.1)),
        log_weight=(math.log(0.3), 0.36),
        noise=noise,
    )


def detection(base_T_can: Pose2) -> Detection:
    """Return a detection of a can at a pose."""
    x, y, _ = base_T_can
    place = (x, y, TABLE.size_m[2], 0.0)
    fit = np.diag([FIT_SD**2, FIT_SD**2, ROUND_SD**2])
    return Detection(
        base_T_object=place,
        covariance=pose_covariance(fit, place, CAMERA.origin, NOISE),
        type_log_likelihood={"soda": 0.0},
        rgb=(0.6, 0.1, 0.1),
        points=200,
    )


def look(belief: Belief, step: int, seen: list[Detection], standing: list[Pose2]) -> None:
    """Let the robot look: detections, and a depth image of the cans in `standing`, if any."""
    solids = [Solid("table1", TABLE, (1.0, 0.0, 0.0, 0.0))]
    solids += [Solid(f"can{i}", CAN, (x, y, TABLE.size_m[2], 0.0)) for i, (x, y, _) in enumerate(standing)]
    view = depth_view(CAMERA, solids, CAMERA) if standing else None
    command = LookAt(pan=ROBOT.head[0], tilt=ROBOT.head[1])
    observation = Observation(step=step, kind="look", detections=tuple(seen), view=view)
    belief.update(_action(step, command), ActionResult(step=step, status="done", robot=ROBOT), observation)


def drive(belief: Belief, odometry: Pose2) -> None:
    """Let the robot drive."""
    result = ActionResult(step=0, status="done", robot=ROBOT, odometry=odometry)
    belief.update(_action(0, MoveBase(start_T_waypoint=(odometry,))), result, Observation(step=0, kind="none"))


def _action(step: int, command: LookAt | MoveBase) -> Action:
    return Action(step=step, op=command.kind, args=(), command=command)
