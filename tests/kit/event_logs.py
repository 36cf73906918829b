"""Logs of events for the pose graph, made by hand or drawn."""

import gtsam
from numpy.random import PCG64, Generator, SeedSequence

from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import Began, Event, Looked, Moved, Picked, PickFailed, Placed, Sighting
from skolem.estimation.pose_graph import PoseGraph
from skolem.estimation.se2 import compose, exp
from skolem.traces.messages import (
    Detection,
    HsvBelief,
    NoiseModel,
    ObjectType,
    Pose2,
    Prior,
    PriorObject,
    RobotState,
)

NOISE = NoiseModel(
    **{name: 0.01 for name in NoiseModel.model_fields} | {"found": 0.9, "type_right": 0.9, "colour_gain": 1.0}
)
GREY = HsvBelief(mean=(0.5, 0.5, 0.5), variance=(0.1, 0.1, 0.1))
SIGHT = (1e-4, 0.0, 0.0, 1e-4, 0.0, 9e-4)
CAMERA = (1e-6, 0.0, 0.0, 1e-6, 0.0, 1e-6)
STRETCHED = (0.0,) * 7


def began(objects: dict[str, Pose2], sd_m: float = 0.1, sd_rad: float = 0.2, base_sd: float = 0.01) -> Began:
    priors = tuple(
        PriorObject(anchor=a, type={"can": 1.0}, world_T_object=(x, y, 0.7, t), sd_xy_m=sd_m, sd_theta_rad=sd_rad)
        for a, (x, y, t) in objects.items()
    )
    return Began(
        prior=Prior(
            world_T_base=(0.0, 0.0, 0.0),
            base_sd_xy_m=base_sd,
            base_sd_theta_rad=base_sd,
            robot=RobotState(right_arm=STRETCHED, left_arm=STRETCHED),
            objects=priors,
            types={"can": ObjectType(shape="cylinder", size_m=(0.06, 0.06, 0.1), graspable=True)},
            colour=GREY,
            log_weight=(0.0, 1.0),
            noise=NOISE,
        )
    )


def looked(seen: dict[str, Pose2], new: tuple[str, ...] = (), camera: tuple[float, ...] = CAMERA) -> Looked:
    a, b, c, d, e, f = camera
    sightings = tuple(
        Sighting(
            anchor=anchor,
            new=anchor in new,
            camera_T_object=pose,
            covariance=SIGHT,
            z=0.7,
            z_sd_m=0.01,
            odds=10.0,
            detection=Detection(
                base_T_object=(0.0, 0.0, 0.0, 0.0),
                covariance=SIGHT,
                type_log_likelihood={},
                rgb=(0.0, 0.0, 0.0),
                points=1,
            ),
        )
        for anchor, pose in seen.items()
    )
    return Looked(camera_covariance=(a, b, c, d, e, f), sightings=sightings, missed=())


def graph_of(events: list[Event]) -> PoseGraph:
    graph = PoseGraph(EstimatorConfig())
    for event in events:
        graph.apply(event)
    return graph


def relative(a: Pose2, b: Pose2) -> Pose2:
    pose = gtsam.Pose2(*a).between(gtsam.Pose2(*b))
    return (pose.x(), pose.y(), pose.theta())


def random_log(seed: int, moves: int = 6) -> list[Event]:
    draws = Generator(PCG64(SeedSequence([seed])))
    cans = {f"can{i}": (float(draws.uniform(1, 2)), float(draws.uniform(-1, 1)), 0.3 * i) for i in range(4)}
    log: list[Event] = [began(cans)]
    base: Pose2 = (0.0, 0.0, 0.0)
    for step in range(moves):
        motion = exp(draws.normal(size=3) * 0.3)
        base = compose(base, motion)
        log.append(Moved(start_T_end=compose(motion, exp(draws.normal(size=3) * 0.02)), sd_m=0.02, sd_rad=0.02))
        noisy = {a: compose(relative(base, p), exp(draws.normal(size=3) * 0.01)) for a, p in cans.items()}
        new = (f"_o{step}_",)
        log.append(looked({**dict(list(noisy.items())[: 1 + step % 4]), new[0]: (1.0, 0.1 * step, 0.0)}, new))
        if step == 2:
            tool, grasp = (0.6, 0.1, 0.75, 0.2), (0.1, 0.0, -0.05, 0.1)
            log.append(Picked(hand="right", anchor="can1", base_T_tool=tool, tool_T_object=grasp))
            cans.pop("can1")
        if step == 4:
            placed = Placed(
                hand="right",
                anchor="can1",
                base_T_tool=(0.7, -0.1, 0.75, 0.1),
                tool_z_object=-0.05,
                support=None,
                sd_m=0.01,
                sd_rad=0.03,
            )
            log += [placed, PickFailed(anchor="can2")]
    return log
