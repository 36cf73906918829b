"""A trace as a rerun recording: the robot, true and believed objects, pictures, plans and decisions.

The recording is a function of the trace and of the robot's model alone. Messages may come all at once from a finished
trace, or step by step from a growing one.
"""

from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import rerun as rr

from skolem.traces.file.reader import Recorded, Trace
from skolem.traces.messages import (
    Action,
    Belief,
    Denotation,
    ObjectType,
    Observation,
    Plan,
    Prior,
    RunEnd,
    RunStart,
    TrueState,
)
from skolem.traces.scene.belief import Beliefs
from skolem.traces.scene.blueprint import blueprint
from skolem.traces.scene.camera import Camera
from skolem.traces.scene.eye import Eye
from skolem.traces.scene.labels import Labels
from skolem.traces.scene.log import Log
from skolem.traces.scene.plans import Plans
from skolem.traces.scene.plots import Plots
from skolem.traces.scene.regions import Regions
from skolem.traces.scene.robot import Robot, RobotModel
from skolem.traces.scene.rows import Rows, When
from skolem.traces.scene.shapes import FRAME
from skolem.traces.scene.stage import Stage
from skolem.traces.scene.truth import Truth
from skolem.traces.wording.of_run import wording
from skolem.traces.wording.wording import AS_RECORDED
from skolem.traces.written import put

APPLICATION: Final = "skolem"  # the viewer warns of a dot in this name


def convert(trace: Trace, out: Path, model: RobotModel, raw: bool = False) -> None:
    """Write a trace as a rerun recording with its layout; `raw` as in `Scene`.

    Rerun would write the file by itself, but it follows links, and waits for ever on a full disk.

    Raises:
        TraceError: If the trace holds a message that does not follow its schema.
        InputError: If the recording cannot be written.
    """
    stream = rr.RecordingStream(APPLICATION, recording_id=trace.path.stem)
    recording = rr.binary_stream(stream)
    scene = Scene(stream, model, raw)
    scene.survey(trace)
    for recorded in trace.messages(*scene.topics):
        scene.take(recorded)
    scene.flush(ended=True)
    put(out, recording.read() or b"")  # in one piece: each has an index of its own
    stream.disconnect()


# Stands for a type that is not recorded, as in a trace that was recovered from a damaged one.
_UNKNOWN: Final = ObjectType(shape="box", size_m=(0.06, 0.06, 0.06), graspable=True)


class Scene:
    """Draws the messages of a run into a recording, one after another.

    Attributes:
        topics: The topics that are drawn.
        eye: The first eye, for which labels are laid out; None before it is known.
    """

    def __init__(self, stream: rr.RecordingStream, model: RobotModel, raw: bool = False) -> None:
        """Send everything that does not depend on time.

        Args:
            stream: The recording.
            model: The robot's model.
            raw: Whether fluents and operations are shown as recorded, not in words.
        """
        stream.log("/", rr.ViewCoordinates.RIGHT_HAND_Z_UP, FRAME, static=True, strict=True)
        self._rows = rows = Rows(stream)
        self._robot = Robot(rows, model)
        self._camera = Camera(rows, model.base_link)
        self._truth, self._beliefs, self._regions = Truth(rows), Beliefs(rows), Regions(rows)
        self._labels = Labels(rows)
        self._plots, self._log = Plots(rows), Log(rows)
        self._plans = Plans(rows, "", AS_RECORDED)
        self._raw, self._goal = raw, ""
        self._types = defaultdict[str, ObjectType](lambda: _UNKNOWN)
        self._step = 0
        self._belief: tuple[Belief, When] | None = None
        self._stage = Stage(self._robot.limbs)
        self.eye: Eye | None = None
        self._laid_out: tuple[bool, Eye | None] | None = None
        self._takers: dict[str, Callable[[Any, When], None]] = {
            "/run/start": self._started,
            "/prior": self._told,
            "/belief": self._believed,
            "/denotation": self._meant,
            "/plan": self._planned,
            "/decision": self._log.decided,
            "/action": self._acted,
            "/action/result": self._log.resulted,
            "/obs": self._observed,
            "/run/end": self._ended,
            "/truth/state": self._is,
            "/truth/verdict": self._log.judged,
            "/robot/joint_states": self._robot.joints,
            "/tf": lambda message, when: self._truth.moved(message, when, self._types),
            "/camera/rgb": self._camera.picture,
            "/camera/info": lambda message, _: self._camera.calibrated(message),
        }
        self.topics = tuple(self._takers)

    def survey(self, run: Trace) -> None:
        """Choose the eye for a whole run before its first message; by default the first belief determines the eye."""
        types, stage = self._types.copy(), self._stage
        for recorded in run.messages("/prior", "/truth/state", "/belief"):
            message = recorded.message
            if isinstance(message, Prior):
                types.update(message.types)
            elif isinstance(message, TrueState):
                stage.state(message, types)
            elif isinstance(message, Belief):
                stage.believed(message, types)
        self.eye = stage.eye()

    def take(self, recorded: Recorded) -> None:
        """Draw a message of one of the topics; ignore others."""
        if recorded.topic not in self._takers:
            return
        message = recorded.message
        if isinstance(message, Belief):
            self._step = message.step
        self._takers[recorded.topic](message, When(recorded.tick, self._step))

    def flush(self, ended: bool = False) -> None:
        """Send the drawn rows, and the layout if it has changed: pictures have come, or axes have become longer."""
        self._robot.flush()
        self._rows.flush()
        layout = self._camera.pictures, self.eye
        if ended or self._laid_out != layout:
            self._laid_out = layout
            axis = self._plots.entropy_axis if ended else None
            self._rows.stream.send_blueprint(blueprint(*layout, axis))

    def _started(self, message: RunStart, when: When) -> None:
        self._goal = message.goal
        self._speak()

    def _told(self, message: Prior, when: When) -> None:
        self._types.update(message.types)
        self._speak()

    def _speak(self) -> None:
        """Use the words of the run as soon as they are known: its goal comes first, then its types."""
        words = wording(self._goal, self._types, {}, self._raw)
        self._plans = Plans(self._rows, self._goal, words)
        self._log.words = self._plots.words = words

    def _is(self, message: TrueState, when: When) -> None:
        self._truth.state(message, when, self._types)
        if self.eye is None:
            self._stage.state(message, self._types)

    def _believed(self, message: Belief, when: When) -> None:
        """Draw a belief without labels: they show P(Den), which comes next if it is recorded."""
        self._belief = message, when
        if self.eye is None:
            self._stage.believed(message, self._types)
            self.eye = self._stage.eye(going_on=True)
        self._robot.believed(message, when)
        self._beliefs.believed(message, when, self._types)
        self._regions.believed(message, when, self._types)
        self._plots.believed(message, when)
        self._plans.step_begins(when)

    def _meant(self, message: Denotation, when: When) -> None:
        self._plots.meant(message, when)
        self._label(message)

    def _label(self, denotation: Denotation | None) -> None:
        if self._belief is not None:
            belief, when = self._belief
            self._belief = None
            things, limbs = self._truth.things(self._types), self._robot.limbs(belief)
            assert self.eye is not None, "the first belief decides"
            self._labels.believed(self.eye, belief, denotation, when, self._types, things, limbs)

    def _planned(self, message: Plan, when: When) -> None:
        self._plans.changed(message, when)
        self._log.planned(message, when)

    def _acted(self, message: Action, when: When) -> None:
        self._label(None)
        self._log.acted(message, when)
        self._step = message.step + 1

    def _ended(self, message: RunEnd, when: When) -> None:
        self._label(None)
        self._log.ended(message, when)

    def _observed(self, message: Observation, when: When) -> None:
        self._camera.observed(message, when, self._types)
        self._log.observed(message, when)
