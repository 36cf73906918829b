"""The joint Gaussian over base, objects and grasps: a GTSAM factor graph fed by events.

The event log is the source of truth and the incremental smoother a cache over it. Variables:

    x(t)            world_T_base after the t-th drive
    c(k)            world_T_base at the k-th look plus the camera's error, which all its sightings share
    o(anchor, n)    world_T_object after the object was moved n times
    g(k)            tool_T_object of the k-th pick

A consolidation keeps the latest x, the g of each held object and the latest o of each other anchor.

Covariances are in the tangent space of the mean, (x, y, theta) in the body's own frame.
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass

import gtsam
import numpy as np

from skolem.estimation import arm
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.consolidation import exchange
from skolem.estimation.events import (
    Began,
    Consolidated,
    Event,
    Looked,
    Lost,
    Merged,
    Moved,
    Picked,
    PickFailed,
    Placed,
    Posed,
    Sought,
    Split,
    Weighed,
)
from skolem.estimation.graph_state import Grasp, diagonal, empty, grasp_factor
from skolem.estimation.se2 import (
    Matrix,
    Vector,
    adjoint,
    apart,
    between,
    compose,
    inverse,
    relative_jacobian,
    symmetric,
)
from skolem.traces.errors import InternalError
from skolem.traces.messages import Hand, Pose2, Pose4, RobotState
from skolem.traces.messages.poses import flat, raised

BASE = "base"
FIRST = "first "  # begins the name of the pose from which an anchor was first picked; no anchor has a space
INDETERMINATE = "Indeterminate linear system"  # part of GTSAM's error message
EPOCHS = 1 << 20  # greatest number of epochs of one anchor
SETTLING_UPDATES = 2  # most extra updates after an event: a far sighting moves the mean, and the covariance follows


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint Gaussian over named poses.

    Attributes:
        names: Anchors, or "base".
        world_T_body: Mean pose of each.
        covariance: Shape (3n, 3n), tangent space of each mean, in the order of `names`.
    """

    names: tuple[str, ...]
    world_T_body: tuple[Pose2, ...]
    covariance: Matrix

    def block(self, index: int) -> Matrix:
        """Return the marginal covariance of one pose, shape (3, 3)."""
        return self.covariance[3 * index : 3 * index + 3, 3 * index : 3 * index + 3]


def _tuple(pose: gtsam.Pose2) -> Pose2:
    return (pose.x(), pose.y(), pose.theta())


class PoseGraph:
    """The joint belief on the poses of the base and the objects."""

    def __init__(self, config: EstimatorConfig) -> None:
        self._config = config
        self._start, self._log = empty(), list[Event]()  # the present state is `_start` after the events of `_log`
        self._is_robust = False  # whether the smoother factorises by QR
        self._now = self._start.copied()

    # ------------------------------------------------------------ change

    def apply(self, event: Event) -> None:
        """Take in one event.

        Raises:
            InternalError: If the event does not fit the graph; the graph is then as before.
        """
        try:
            self._take(event)
        except (RuntimeError, KeyError) as error:
            self._replay(tuple(self._log))
            raise InternalError(f"event '{event.kind}' does not fit the pose graph: {error}") from error

    def rebuild(self, events: Iterable[Event]) -> None:
        """Return to the empty graph and take in `events`."""
        self._start, self._is_robust = empty(), False
        self._replay(events)

    def _replay(self, events: Iterable[Event]) -> None:
        self._now, self._log = self._start.copied(), []
        for event in events:
            self._take(event)

    def _take(self, event: Event) -> None:
        """Take in an event and log it; once Cholesky fails, take in the whole log again by QR."""
        try:
            self._apply(event)
        except RuntimeError as error:
            begun = self._start.robot is not None  # the past is summed up and cannot be taken in again
            if self._is_robust or begun or INDETERMINATE not in str(error):
                raise
            self._start, self._is_robust = empty("QR"), True
            self._replay((*self._log, event))
        else:
            self._keep(event)

    def _keep(self, event: Event) -> None:
        """Log an event for a replay; a replay starts at the last consolidation."""
        if isinstance(event, Consolidated):
            self._start, self._log = self._now.copied(), []
        else:
            self._log.append(event)

    def _apply(self, event: Event) -> None:
        match event:
            case Began():
                self._begin(event)
            case Posed():
                self._now.robot = event.robot
            case Moved():
                self._move(event)
            case Looked():
                self._look(event)
            case Picked():
                self._pick(event)
            case PickFailed():
                self._loosen(event.anchor, self._config.pushed_sd_m, self._config.pushed_sd_rad)
            case Placed() | Lost():
                self._place(event)
            case Sought():
                self._seek(event)
            case Weighed():
                self._key(event.anchor)
            case Merged():
                self._merge(event)
            case Split():
                self._loosen(event.anchor, event.sd_m, event.sd_rad)
            case Consolidated():
                self._consolidate(event)

    def _begin(self, event: Began) -> None:
        prior = event.prior
        self._now.robot = prior.robot
        self._now.noise = (self._sd(prior.noise.grasp_sd_m), self._sd(prior.noise.grasp_sd_rad))
        sds = {self._now.base: diagonal(self._sd(prior.base_sd_xy_m), self._sd(prior.base_sd_theta_rad))}
        values = {self._now.base: prior.world_T_base}
        for item in prior.objects:
            key = self._introduce(item.anchor)
            sds[key] = diagonal(self._sd(item.sd_xy_m), self._sd(item.sd_theta_rad))
            values[key] = flat(item.world_T_object)
        self._update([gtsam.PriorFactorPose2(key, gtsam.Pose2(*values[key]), sds[key]) for key in values], values)

    def _move(self, event: Moved) -> None:
        start = self._now.base
        self._now.moves += 1
        end = gtsam.symbol("x", self._now.moves)
        noise = diagonal(self._sd(event.sd_m), self._sd(event.sd_rad))
        factor = gtsam.BetweenFactorPose2(start, end, gtsam.Pose2(*event.start_T_end), noise)
        self._update([factor], {end: compose(self._at(start), event.start_T_end)})
        self._now.base = end

    def _look(self, event: Looked) -> None:
        for miss in event.missed:
            self._key(miss.anchor)
        if not event.sightings:
            return
        self._now.looks += 1
        camera = gtsam.symbol("c", self._now.looks)
        values = {camera: self._at(self._now.base)}
        factors = [self._between(self._now.base, camera, (0.0, 0.0, 0.0), symmetric(event.camera_covariance))]
        for sighting in event.sightings:
            if sighting.new:
                key = self._introduce(sighting.anchor)
                values[key] = compose(values[camera], sighting.camera_T_object)
            key = self._key(sighting.anchor)
            factors.append(self._between(camera, key, sighting.camera_T_object, symmetric(sighting.covariance)))
        self._update(factors, values)

    def _pick(self, event: Picked) -> None:
        item = self._key(event.anchor)
        self._now.first.setdefault(event.anchor, item)
        self._now.picks += 1
        grasp = gtsam.symbol("g", self._now.picks)
        planned, capture = flat(event.tool_T_object), diagonal(self._config.capture_sd_m, self._config.capture_sd_rad)
        base_T_tool = flat(event.base_T_tool)
        tool_T_object = between(base_T_tool, between(self._at(self._now.base), self._at(item)))
        factors = [
            grasp_factor(self._now.base, item, grasp, base_T_tool, self._now.noise),
            gtsam.PriorFactorPose2(grasp, gtsam.Pose2(*planned), capture),
        ]
        self._update(factors, {grasp: tool_T_object})
        self._now.grasps[event.hand] = Grasp(grasp, event.anchor, event.tool_T_object[2])

    def _loosen(self, anchor: str, sd_m: float, sd_rad: float) -> None:
        """Add a motion of an object, with mean zero and some sds (metres, radians), to its pose."""
        before = self._key(anchor)
        after = self._next_epoch(anchor)
        factor = gtsam.BetweenFactorPose2(before, after, gtsam.Pose2(), diagonal(sd_m, sd_rad))
        self._update([factor], {after: self._at(before)})

    def _place(self, event: Placed | Lost) -> None:
        """Put an object at the pose of its release, or around the hand that was found empty."""
        grasp = self._now.grasps.pop(event.hand)
        after, base_T_tool = self._next_epoch(grasp.anchor), flat(event.base_T_tool)
        sds = (self._sd(event.sd_m), self._sd(event.sd_rad))
        start = compose(self._at(self._now.base), compose(base_T_tool, self._at(grasp.key)))
        self._update([grasp_factor(self._now.base, after, grasp.key, base_T_tool, sds)], {after: start})

    def _seek(self, event: Sought) -> None:
        """Put an object around a place, whatever its pose was."""
        self._key(event.anchor)
        after = self._next_epoch(event.anchor)
        factor = self._between(self._now.base, after, event.base_T_object, symmetric(event.covariance))
        self._update([factor], {after: compose(self._at(self._now.base), event.base_T_object)})

    def _merge(self, event: Merged) -> None:
        into, other = self._key(event.anchor), self._key(event.other)
        if event.other in self._now.first:
            self._now.first.setdefault(event.anchor, self._now.first[event.other])
        turn = gtsam.Pose2(0.0, 0.0, event.turn)
        self._update([gtsam.BetweenFactorPose2(into, other, turn, diagonal(self._config.same_sd_m, event.sd_rad))], {})

    def _consolidate(self, event: Consolidated) -> None:
        """Eliminate all variables but the present poses of base and objects and the present grasps."""
        now = self._now
        now.forgotten |= {anchor: self._at(self._key(anchor)) for anchor in event.forgotten}
        held = {grasp.anchor for grasp in now.grasps.values()}
        last = {self._key(anchor) for anchor in now.numbers.keys() - now.forgotten.keys() - held}
        kept = last | {now.base} | {grasp.key for grasp in now.grasps.values()}
        kept |= set(now.first.values()) if self._config.remembers else set()
        gone = frozenset(now.isam.getLinearizationPoint().keys()) - kept
        if gone:
            entry = now.entry if now.entry in gone else now.base
            change = exchange(now.isam, gone, entry, self._config.coupled)
            self._update(change.added, {}, change.removed)
        now.entry = now.base

    # ------------------------------------------------------------ questions

    @property
    def smoother(self) -> gtsam.ISAM2:
        """The smoother, for inspection only; do not change it."""
        return self._now.isam

    @property
    def forgotten(self) -> Collection[str]:
        """Anchors that were given up; only their last mean poses are kept."""
        return self._now.forgotten.keys()

    @property
    def robot(self) -> RobotState:
        """The last reading of the encoders."""
        assert self._now.robot is not None, "the first event is Began"
        return self._now.robot

    def tool_T_object(self, hand: Hand) -> Pose4:
        """Return the mean tool_T_object of a hand that holds an object."""
        grasp = self._now.grasps[hand]
        return raised(self._at(grasp.key), grasp.z)

    def base_T_held(self, hand: Hand) -> Pose4:
        """Return the present base_T_object of a held object; theta is the heading of its x axis."""
        x, y, z, theta = self.tool_T_object(hand)
        base_T_object = arm.base_T_tool(self.robot, hand) @ arm.upright(x, y, z, theta)
        return raised(arm.flattened(base_T_object), float(base_T_object[2, 3]))

    def first(self, anchor: str) -> str:
        """Return the name of the pose of an anchor before it was first picked; its own name if it never was."""
        return FIRST + anchor if anchor in self._now.first else anchor

    def joint(self, names: Iterable[str]) -> Joint:
        """Return the joint Gaussian of world poses; the pose of a held object follows the hand.

        Args:
            names: Anchors, `BASE`, and names that `first` returns, all different.

        Raises:
            InternalError: If there is no such anchor.
        """
        names = tuple(names)
        keys, means, terms = [self._now.base], [], []
        for name in names:
            mean, key, of_base = self._as_variable(name)
            means.append(mean)
            terms.append((of_base, None if key is None else len(keys)))
            keys += [] if key is None else [key]
        linear = np.zeros((3 * len(names), 3 * len(keys)))
        for row, (of_base, column) in enumerate(terms):
            if of_base is not None:
                linear[3 * row : 3 * row + 3, :3] = of_base
            if column is not None:
                linear[3 * row : 3 * row + 3, 3 * column : 3 * column + 3] = np.eye(3)
        covariance = linear @ self._covariance(keys) @ linear.T
        return Joint(names, tuple(means), (covariance + covariance.T) / 2.0)

    def _as_variable(self, name: str) -> tuple[Pose2, int | None, Matrix | None]:
        """Return world_T_body, the key of its own variable, if any, and its Jacobian by the base's tangent, (3, 3)."""
        if name == BASE:
            return self._at(self._now.base), None, np.eye(3)
        if name.startswith(FIRST):
            key = self._now.first[name.removeprefix(FIRST)]
            return self._at(key), key, None
        for hand, grasp in self._now.grasps.items():
            if grasp.anchor == name:
                base_T_object = flat(self.base_T_held(hand))
                return compose(self._at(self._now.base), base_T_object), grasp.key, adjoint(inverse(base_T_object))
        if name in self._now.forgotten:
            return self._now.forgotten[name], None, None
        if name not in self._now.numbers:
            raise InternalError(f"no anchor '{name}'; there are: {', '.join(self._now.numbers)}")
        return self._at(self._key(name)), self._key(name), None

    def relative(self, a: str, b: str) -> tuple[Pose2, Matrix]:
        """Return mean and covariance (3, 3) of a_T_b, tangent space of the mean (frame b), from the joint of both."""
        joint = self.joint((a, b))
        a_T_b = between(*joint.world_T_body)
        jacobian = relative_jacobian(a_T_b)
        return a_T_b, jacobian @ joint.covariance @ jacobian.T

    def apart(self, a: str, b: str) -> tuple[Vector, Matrix]:
        """Return mean (2,) and covariance (2, 2) of the vector from the place of `a` to that of `b`, base frame.

        Unlike a_T_b, the vector does not depend on the headings, which are unknown for cylinders.
        """
        joint = self.joint((BASE, a, b))
        mean, jacobian = apart(*joint.world_T_body)
        return mean, jacobian @ joint.covariance @ jacobian.T

    def mean(self, a: str, b: str) -> Pose2:
        """Return the mean of a_T_b without its covariance, which is much cheaper."""
        return between(self._as_variable(a)[0], self._as_variable(b)[0])

    # ------------------------------------------------------------ keys and values

    def _introduce(self, anchor: str) -> int:
        self._now.numbers[anchor] = len(self._now.numbers)
        self._now.epochs[anchor] = 0
        return self._key(anchor)

    def _key(self, anchor: str) -> int:
        return int(gtsam.symbol("o", self._now.numbers[anchor] * EPOCHS + self._now.epochs[anchor]))

    def _next_epoch(self, anchor: str) -> int:
        self._now.epochs[anchor] += 1
        return self._key(anchor)

    def _sd(self, sd: float) -> float:
        return max(sd, self._config.least_sd)

    def _at(self, key: int) -> Pose2:
        return _tuple(self._now.isam.calculateEstimatePose2(key))

    def _between(self, a: int, b: int, a_T_b: Pose2, covariance: Matrix) -> gtsam.BetweenFactorPose2:
        floored = covariance + self._config.least_sd**2 * np.eye(3)
        return gtsam.BetweenFactorPose2(a, b, gtsam.Pose2(*a_T_b), gtsam.noiseModel.Gaussian.Covariance(floored))

    def _covariance(self, keys: list[int]) -> Matrix:
        """Return the joint covariance of n variables, shape (3n, 3n), in the order of `keys` (all different)."""
        if len(keys) == 1:
            return np.asarray(self._now.isam.marginalCovariance(keys[0]))
        return np.asarray(self._now.isam.jointMarginalCovariance(keys).fullMatrix())

    def _update(
        self, factors: Iterable[gtsam.NonlinearFactor], values: Mapping[int, Pose2], removed: Iterable[int] = ()
    ) -> None:
        graph, start = gtsam.NonlinearFactorGraph(), gtsam.Values()
        for factor in factors:
            graph.add(factor)
        for key, pose in values.items():
            start.insert(key, gtsam.Pose2(*pose))
        self._now.isam.update(graph, start, list(removed))
        for _ in range(SETTLING_UPDATES):
            if not self._now.isam.update().getVariablesRelinearized():
                break
