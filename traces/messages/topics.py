"""The topics of a trace, each with its message and its class.

The classes are INPUT (fed to a replay), DERIVED (regenerated and compared), TRUTH (of the simulator, never read by the
robot) and PERF (ignored).
"""

from typing import Final, Literal

from skolem.traces.messages.actions import Action
from skolem.traces.messages.base import Message
from skolem.traces.messages.belief import Belief
from skolem.traces.messages.prior import Prior
from skolem.traces.messages.reasoning import Decision, Denotation, Geometry, Memory, Plan
from skolem.traces.messages.run import Chain, Perf, RunEnd, RunStart
from skolem.traces.messages.sensing import ActionResult, Observation
from skolem.traces.messages.truth import TrueState, Verdict

INPUT: Final = "INPUT"
DERIVED: Final = "DERIVED"
TRUTH: Final = "TRUTH"
PERF: Final = "PERF"
TopicClass = Literal["INPUT", "DERIVED", "TRUTH", "PERF"]
JSON_TOPICS: dict[str, tuple[type[Message], TopicClass]] = {
    "/run/start": (RunStart, INPUT),
    "/prior": (Prior, INPUT),
    "/belief": (Belief, DERIVED),
    "/memory": (Memory, DERIVED),
    "/plan": (Plan, DERIVED),
    "/decision": (Decision, DERIVED),
    "/denotation": (Denotation, DERIVED),
    "/geometry": (Geometry, DERIVED),
    "/action": (Action, DERIVED),
    "/action/result": (ActionResult, INPUT),
    "/obs": (Observation, INPUT),
    "/chain": (Chain, DERIVED),
    "/run/end": (RunEnd, DERIVED),
    "/truth/state": (TrueState, TRUTH),
    "/truth/verdict": (Verdict, TRUTH),
    "/perf": (Perf, PERF),
}
PROTOBUF_TOPICS: dict[str, tuple[str, TopicClass]] = {
    "/robot/joint_states": ("foxglove.JointStates", TRUTH),
    "/tf": ("foxglove.FrameTransforms", TRUTH),
    "/camera/rgb": ("foxglove.CompressedImage", TRUTH),
    "/camera/depth": ("foxglove.RawImage", TRUTH),
    "/camera/info": ("foxglove.CameraCalibration", TRUTH),
    "/log": ("foxglove.Log", PERF),
}
CLASS_OF: dict[str, TopicClass] = {t: c for t, (_, c) in JSON_TOPICS.items()} | {
    t: c for t, (_, c) in PROTOBUF_TOPICS.items()
}
