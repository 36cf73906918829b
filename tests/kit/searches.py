"""A table with a region above it, and an exact camera that may be anywhere, shared by the tests of regions."""

import math
from collections.abc import Sequence

from kit.tabletop import EXACT, looking

from skolem.estimation.belief import Belief
from skolem.sim.space.pinhole import Frame
from skolem.sim.symbolic.view import Solid, depth_view, in_sight
from skolem.traces.messages import (
    Action,
    ActionResult,
    DepthView,
    Detection,
    HsvBelief,
    LookAt,
    ObjectType,
    Observation,
    Pose4,
    Prior,
    PriorObject,
    PriorRegion,
    RobotState,
)

TOP = 0.7
TYPES = {
    "bottle": ObjectType(shape="cylinder", size_m=(0.06, 0.06, 0.2), graspable=True),
    "screen": ObjectType(shape="box", size_m=(0.04, 0.5, 0.25), graspable=False),
    "soda": ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.115), graspable=True),
    "table": ObjectType(shape="table", size_m=(0.6, 1.0, TOP), graspable=False),
}
BACKWARD = (math.pi, *(0.0,) * 6)  # both arms stretched out behind the robot
ROBOT = RobotState(right_arm=BACKWARD, left_arm=BACKWARD)
NOISE = EXACT.model_copy(update={"false_per_look": 0.1, "found": 0.9, "type_right": 0.9})
Point = tuple[float, float, float]
MIDDLE: Point = (1.1, 0.0, TOP)
TABLE: Pose4 = (1.1, 0.0, 0.0, 0.0)
FRONT, LEFT, RIGHT, BACK = (0.1, 0.0, 1.5), (1.1, 1.2, 1.5), (1.1, -1.2, 1.5), (2.1, 0.0, 1.5)
REGION = "_reg1_"
GREEN_RGB = (0.08, 0.64, 0.08)


def table_prior(
    table: Pose4 = TABLE,
    objects: Sequence[PriorObject] = (),
    regions: Sequence[PriorRegion] | None = None,
    types: dict[str, float] | None = None,
) -> Prior:
    """Return a prior with a table at an almost exact pose, objects on it, and by default one region above it."""
    region = PriorRegion(anchor=REGION, support="table1", height_m=0.3, expected_objects=0.5)
    return Prior(
        world_T_base=(0.0, 0.0, 0.0),
        base_sd_xy_m=0.001,
        base_sd_theta_rad=0.001,
        robot=ROBOT,
        objects=(thing("table1", "table", table, support=None), *objects),
        regions=(region,) if regions is None else tuple(regions),
        types=TYPES,
        type=types or {},
        colour=HsvBelief(mean=(0.5, 0.5, 0.5), variance=(0.25, 0.1, 0.1)),
        log_weight=(math.log(0.3), 0.36),
        noise=NOISE,
    )


def thing(
    anchor: str, kind: str, world_T_object: Pose4, sd_m: float = 0.001, support: str | None = "table1"
) -> PriorObject:
    """Return the prior of an object of known type."""
    return PriorObject(
        anchor=anchor,
        type={kind: 1.0},
        world_T_object=world_T_object,
        sd_xy_m=sd_m,
        sd_theta_rad=0.001,
        support=support,
    )


class Searcher:
    """A robot whose base stays at the origin of the world and whose camera may be anywhere."""

    def __init__(self, prior: Prior, scene: Sequence[tuple[str, Pose4]] = (), table: Pose4 = TABLE) -> None:
        self.belief = Belief(prior)
        self.solids = [Solid("table1", TYPES["table"], table)]
        self.solids += [Solid(f"thing{i}", TYPES[kind], pose) for i, (kind, pose) in enumerate(scene)]
        self.step = 0

    def look(self, eye: Point, at: Point = MIDDLE, found: bool = True) -> None:
        """Take in a look from `eye` that detects all graspable objects in sight, or none of them."""
        frame = looking(eye, at)
        seen = [solid for solid in self.solids if found and solid.type.graspable and self._sees(frame, solid)]
        self.report(depth_view(frame, self.solids, frame), [detection(solid) for solid in seen])

    def report(self, view: DepthView, detections: Sequence[Detection] = (), robot: RobotState = ROBOT) -> None:
        """Take in a look with a depth image and detections."""
        self.belief.update(
            Action(step=self.step, op="look", args=(), command=LookAt(pan=0.0, tilt=0.0)),
            ActionResult(step=self.step, status="done", robot=robot),
            Observation(step=self.step, kind="look", detections=tuple(detections), view=view),
        )
        self.step += 1

    def _sees(self, frame: Frame, solid: Solid) -> bool:
        return in_sight(frame, solid, [other for other in self.solids if other.id != solid.id])


def detection(solid: Solid) -> Detection:
    """Return the detection of a solid at its true place."""
    x, y, z, _ = solid.base_T_solid
    kind = next(name for name, known in TYPES.items() if known == solid.type)
    return Detection(
        base_T_object=(x, y, z, 0.0),
        covariance=(4e-6, 0.0, 0.0, 4e-6, 0.0, 3.29),
        type_log_likelihood={name: (0.0 if name == kind else -40.0) for name in ("bottle", "soda")},
        rgb=GREEN_RGB,
        points=200,
    )
