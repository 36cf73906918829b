"""Record a small run that touches every class of topic: `python sample_run.py OUT.mcap`."""

import sys
from hashlib import sha256
from pathlib import Path

from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms

from skolem.traces.file.writer import TraceWriter
from skolem.traces.messages import (
    Action,
    ActionResult,
    Detection,
    Limits,
    LookAt,
    Observation,
    Perf,
    RobotState,
    RunEnd,
    RunStart,
)

SCENARIO = b"skolem: 1\n"
RULES = {f"{name}.lp": f"% {name}, Schlüssel\n".encode() for name in ("look", "pick", "move", "place")}
ARM = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7)
TICKS_PER_STEP = 480


def record(path: Path, steps: int = 3, profile: bool = False, wall_ms: float = 1.0, last_words: bool = True) -> str:
    """Record `steps` looks and return the content hash; without last words, the trace has no end record of the run."""
    writer = TraceWriter(
        path,
        attachments={"scenario.yaml": SCENARIO} | {f"rules/{name}": text for name, text in RULES.items()},
        run={"seed": "7"},
        env={"python": "3"},
        profile=profile,
    )
    with writer:
        writer.write("/run/start", run_start(), 0)
        for step in range(steps):
            record_step(writer, step, wall_ms)
        if last_words:
            tick = steps * TICKS_PER_STEP
            end = RunEnd(status="goal_achieved", steps=steps, reason="o1 is green", goal_probability=0.9, anchor="o1")
            writer.write("/run/end", end, tick)
    return writer.content_hash


def run_start() -> RunStart:
    limits = Limits(steps=60, expansions=2000, hierarchy_depth=16, min_plan_probability=1e-4)
    return RunStart(
        scenario="sample",
        scenario_sha256=sha256(SCENARIO).hexdigest(),
        rules_sha256={name: sha256(RULES[name]).hexdigest() for name in set(RULES)},  # a set has no fixed order
        robot_sha256="00",
        world="symbolic",
        seed=7,
        goal="exists o. B(Den(lambda x. Green(x), o), 0.9)",
        limits=limits,
    )


def record_step(writer: TraceWriter, step: int, wall_ms: float = 1.0) -> None:
    tick = step * TICKS_PER_STEP
    likelihood = {name: -len(name) / 7 for name in {"soda", "bottle", "table"}}  # a set has no fixed order
    seen = Detection(
        base_T_object=(1 / 3 + step, 0.1, 0.7, 0.0),
        covariance=(1e-4, 0.0, 0.0, 1e-4, 0.0, 1e-2),
        type_log_likelihood=likelihood,
        rgb=(0.1, 0.8, 0.1),
        points=150,
    )
    command = LookAt(pan=0.1 * step, tilt=0.4)
    writer.write("/action", Action(step=step, op="LookAt(o1)", args=("o1",), command=command), tick)
    writer.write("/action/result", ActionResult(step=step, status="done", robot=robot()), tick)
    writer.write("/tf", transforms(step), tick)
    writer.write("/obs", Observation(step=step, kind="look", detections=(seen,)), tick)
    writer.write("/perf", Perf(step=step, milliseconds={"sim": wall_ms}), tick)
    writer.candidate(0.25 * step % 1.0, "o1")
    writer.close_step(step, tick)


def robot() -> RobotState:
    return RobotState(right_arm=ARM, left_arm=ARM)


def transforms(step: int) -> FrameTransforms:
    message = FrameTransforms()
    message.transforms.add(parent_frame_id="world", child_frame_id="truth/o1").translation.x = step / 7
    return message


if __name__ == "__main__":
    record(Path(sys.argv[1]))
