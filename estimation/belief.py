"""The robot's belief. Actions and observations update it, and pure questions read it.

Only events change the belief. The same events give the same belief, to the last bit.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from skolem.estimation.acting import events_of
from skolem.estimation.checks import check_prior
from skolem.estimation.colour import ColourBelief
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import (
    Began,
    Consolidated,
    Event,
    Gone,
    Looked,
    Lost,
    Merged,
    Moved,
    Place,
    Split,
    Weighed,
    canonical_order,
)
from skolem.estimation.extrinsics import expected_look
from skolem.estimation.fluents import JointRelations, joint_relations, prob_near, prob_on
from skolem.estimation.identity import Identity
from skolem.estimation.looking import Look
from skolem.estimation.places import believed_places, is_beside, is_sought, sought
from skolem.estimation.pose_graph import BASE, Joint, PoseGraph
from skolem.estimation.regions import Regions
from skolem.estimation.se2 import Matrix, Vector, upper
from skolem.estimation.tracks import Track, Tracks
from skolem.estimation.weight import WeightBelief
from skolem.traces import messages
from skolem.traces.errors import InternalError
from skolem.traces.messages import (
    GRAVITY,
    HANDS,
    ColourMeaning,
    Hand,
    Meaning,
    ObjectBelief,
    Pose2,
    Pose4,
    Quantity,
    TypeIs,
    TypeIsNot,
)
from skolem.traces.messages.poses import raised

# Equal beliefs have equal answers, and one event changes few objects.
_MEMORY: Final = 4096
_colour_prob = lru_cache(_MEMORY)(ColourBelief.prob)
_colour_favourable = lru_cache(_MEMORY)(ColourBelief.prob_favourable)
_colour_matched = lru_cache(_MEMORY)(ColourBelief.matched)
_weight_prob = lru_cache(_MEMORY)(WeightBelief.prob)
_weight_favourable = lru_cache(_MEMORY)(WeightBelief.prob_favourable)
_weight_matched = lru_cache(_MEMORY)(WeightBelief.matched)


@dataclass(frozen=True, slots=True)
class Gaussian:
    """A Gaussian belief on one quantity of one object.

    Attributes:
        mean: Shape (n,). pose: x, y, theta of base_T_object (m, rad); colour: hue, saturation, value (0..1);
            weight: ln(kg).
        covariance: Shape (n, n), same units squared. pose: tangent space of the mean, object frame.
        probability: Mixture weight P_b: that the object exists at all.
    """

    mean: Vector
    covariance: Matrix
    probability: float


class Belief:
    """The joint belief on the poses of base and objects, and on the existence and properties of the objects."""

    def __init__(self, prior: messages.Prior, config: EstimatorConfig | None = None) -> None:
        """Begin with a prior.

        Raises:
            InputError: If the prior contradicts itself; it lists all faults.
        """
        check_prior(prior)
        self._begin(config or EstimatorConfig())
        self.apply(Began(prior=prior))
        for anchor in self.anchors():  # the prior may put an object beside its support
            if is_beside(self._graph, self._tracks, anchor):
                self._seek_first(anchor)

    @classmethod
    def from_events(cls, events: Iterable[Event], config: EstimatorConfig | None = None) -> "Belief":
        """Return the belief after a log of events; its first event is `Began`."""
        belief = cls.__new__(cls)
        belief._begin(config or EstimatorConfig())
        for event in events:
            belief.apply(event)
        return belief

    def _begin(self, config: EstimatorConfig) -> None:
        self._config = config
        self._graph, self._tracks, self._regions = PoseGraph(config), Tracks(config), Regions(config)
        self._events: list[Event] = []
        self._identity: list[messages.IdentityChange] = []
        self._unsummed = 0  # drives and looks since the past was summed up
        self._relative: dict[tuple[str, str], tuple[Pose2, Matrix]] = {}

    # ------------------------------------------------------------ change

    def update(self, action: messages.Action, result: messages.ActionResult, observation: messages.Observation) -> None:
        """Take in one executed action, its result by the joints, and the observation after it."""
        grasps = {hand: (anchor, self._graph.tool_T_object(hand)) for hand in HANDS if (anchor := self.held(hand))}
        noise, top_m = self._tracks.prior.noise, self._top_under(action)
        for event in events_of(action, result, grasps, noise, self._config, top_m):
            self.apply(event)
            if isinstance(event, Lost):
                self._seek_first(event.anchor)
        if observation.kind == "look":
            self._look(observation)
        if observation.wrench is not None and (anchor := self.held(observation.wrench.hand)):
            self.apply(Weighed(anchor=anchor, kg=-observation.wrench.force_newton[2] / GRAVITY))
        self._consolidate()

    def _top_under(self, action: messages.Action) -> float | None:
        """Return the believed height, metres, of the top on which a place puts an object; None for other actions."""
        onto = action.args[1] if action.command.kind == "place" and len(action.args) > 1 else None
        return None if onto is None or self._tracks.get(onto) is None else self._tracks.top(onto)

    def _look(self, observation: messages.Observation) -> None:
        """Take in a look, with the splits and merges of anchors that it shows."""
        identity = Identity(self._graph, self._tracks, self._config)
        for split in tuple(identity.splits(canonical_order(observation.detections))):
            self.apply(split)
        picture = Look(observation, self._graph, self._tracks, self._regions, self._config)
        look = picture.event()
        for gone in [miss.anchor for miss in look.missed if self._tracks.is_gone(miss)]:
            self.apply(Gone(anchor=gone))
        self.apply(look)
        for anchor, places in picture.sought().items():
            self._seek(anchor, places)
        for merged in tuple(identity.merges(look)):
            self.apply(merged)

    def _seek_first(self, anchor: str) -> None:
        """Give an object with an uncertain place its weighted places, if it has any."""
        if is_sought(self._graph, self._tracks, anchor, self._config):
            self._seek(anchor, believed_places(self._graph, self._tracks, anchor, self._config))

    def _seek(self, anchor: str, places: tuple[Place, ...]) -> None:
        """Move an object to the place with the most weight, if it has weighted places."""
        if places:
            self.apply(sought(places, self._graph, self._tracks, anchor, self._config))

    def _consolidate(self) -> None:
        """Sum up the past after `consolidate_after` drives and looks."""
        if self._unsummed >= self._config.consolidate_after:
            given_up = (anchor for anchor in self._tracks.given_up() if anchor not in self._graph.forgotten)
            self.apply(Consolidated(forgotten=tuple(given_up)))

    def apply(self, event: Event) -> None:
        """Take in one event.

        Raises:
            InternalError: If the event does not fit; nothing is changed then.
        """
        self._graph.apply(event)
        self._tracks.apply(event)
        self._regions.apply(event, self._graph, self._tracks)
        self._identity += _identity(event, self.version)
        self._events.append(event)
        self._unsummed = 0 if isinstance(event, Consolidated) else self._unsummed + isinstance(event, Moved | Looked)
        self._relative.clear()

    @property
    def events(self) -> tuple[Event, ...]:
        """All events so far, in order."""
        return tuple(self._events)

    def identity_changes(self) -> tuple[messages.IdentityChange, ...]:
        """Return the merges and splits of anchors so far, in order."""
        return tuple(self._identity)

    # ------------------------------------------------------------ questions of the reasoner

    @property
    def version(self) -> int:
        """Number of events applied so far."""
        return len(self._events)

    def anchors(self) -> tuple[str, ...]:
        """Every anchor that may exist, in order of introduction."""
        return self._tracks.listed()

    def prob_exists(self, anchor: str) -> float:
        """P(the object exists); 0 for an unknown anchor."""
        track = self._tracks.get(anchor)
        return track.exists if track else 0.0

    def prob_property(self, anchor: str, meaning: Meaning) -> float:
        """P(the object has the property), given that it exists."""
        return _prob(self._tracks[anchor], meaning)

    def prob_property_of_new(self, meaning: Meaning) -> float:
        """P(an arbitrary object that is not met yet has the property)."""
        return _prob(self._tracks.stranger(), meaning)

    def prob_on(self, anchor: str, support: str) -> float:
        """P(the object rests wholly on the top of `support`), given that both exist; 0 while a hand holds it."""
        return prob_on(anchor, support, self._tracks, self._graph, self._relation, earlier=False)

    def prob_near(self, anchor: str, other: str, distance_m: float) -> float:
        """P(the middles of two objects are at most `distance_m` apart in the plane), given that both exist.

        It is 0 while a hand holds one of them.
        """
        return prob_near(anchor, other, distance_m, self._tracks, self._graph, earlier=False)

    def prob_was_on(self, anchor: str, support: str) -> float:
        """`prob_on` of the time before the robot first picked the objects, by all evidence since."""
        return prob_on(anchor, support, self._tracks, self._graph, self._relation, earlier=True)

    def prob_was_near(self, anchor: str, other: str, distance_m: float) -> float:
        """`prob_near` of the time before the robot first picked the objects, by all evidence since."""
        return prob_near(anchor, other, distance_m, self._tracks, self._graph, earlier=True)

    def regions(self) -> tuple[str, ...]:
        """Every region of space that can be searched, in order of introduction."""
        return self._regions.names()

    def region_support(self, region: str) -> str:
        """The anchor on whose top the region lies."""
        return self._regions[region].prior.support

    def support(self, anchor: str) -> str | None:
        """The most likely support of the object; None for the floor, for a hand, and if nothing is known."""
        return self._tracks[anchor].support

    def relations(self, asked: Sequence[messages.Relation]) -> JointRelations:
        """The joint distribution of relations between objects that exist; each must be possible at all."""
        return joint_relations(asked, self._graph, self._tracks)

    def strangers(self) -> tuple[messages.Strangers, ...]:
        """The objects that nobody has met, for each region, in order of introduction."""
        return self._regions.strangers()

    def prob_contents(self, region: str) -> float:
        """BContents: the seen share of the region, without the space of known objects."""
        return self._regions.prob_contents(region)

    def prob_exists_in(self, region: str, match: float) -> float:
        """P(the unseen part of the region holds an object of some kind); `match` is P(an arbitrary object is of it)."""
        return self._regions.prob_exists_in(region, match)

    def graspable(self, anchor: str) -> bool:
        """Whether the most likely type can be grasped by a hand."""
        return self._tracks.kind(anchor).graspable

    def held(self, hand: Hand) -> str | None:
        """The anchor in that hand, or None."""
        return self._tracks.held(hand)

    def gaussian(self, quantity: Quantity, anchor: str) -> Gaussian:
        """The present belief on pose (relative to the base), colour or weight (ln kg)."""
        track = self._tracks[anchor]
        if quantity == "pose":
            mean, covariance = self._relation(BASE, anchor)
            return Gaussian(np.array(mean), covariance.copy(), track.exists)
        if quantity == "colour":
            hsv, variances = _colour_matched(track.colour)
            return Gaussian(np.array(hsv), np.diag(variances), track.exists)
        if quantity == "weight":
            log_kg, variance = _weight_matched(track.weight)
            return Gaussian(np.array([log_kg]), np.array([[variance]]), track.exists)
        raise InternalError(f"'{quantity}' is not a Gaussian quantity; those are: pose, colour, weight")

    def observation_covariance(self, quantity: Quantity, anchor: str, at: Matrix | None = None) -> Matrix:
        """Covariance of one observation of the quantity, in the space of `gaussian`, if its value is `at`, shape (n,).

        None: at the mean of the belief. A pose is always observed at the mean.
        """
        track = self._tracks[anchor]
        if quantity == "pose":
            mean, _ = self._relation(BASE, anchor)
            return expected_look(mean, self._tracks.kind(anchor), self._tracks.prior.noise, self._config)
        if quantity == "colour":
            hsv = _colour_matched(track.colour)[0] if at is None else at.tolist()
            return np.diag(track.colour.sensor.variance(hsv[1], hsv[2]))
        if quantity == "weight":
            log_kg = _weight_matched(track.weight)[0] if at is None else float(at[0])
            return np.array([[track.weight.observation_variance(log_kg)]])
        raise InternalError(f"'{quantity}' is not a Gaussian quantity; those are: pose, colour, weight")

    def prob_detected(self, anchor: str) -> float:
        """P(a look at the object reports it | it exists and is in view); 0 for a type that the detector ignores."""
        return self._tracks.prior.noise.found if self._tracks.is_reported(anchor) else 0.0

    def prob_type_right(self) -> float:
        """P(a look reports the true type | it reports the object)."""
        return self._tracks.prior.noise.type_right

    def prob_favourable(self, anchor: str, meaning: Meaning, p: float) -> float:
        """P(one observation raises the belief in the property to at least `p` | the object has the property)."""
        track = self._tracks[anchor]
        if isinstance(meaning, TypeIs | TypeIsNot):
            return track.types.prob_favourable(meaning.type, p, other=isinstance(meaning, TypeIsNot))
        if isinstance(meaning, ColourMeaning):
            return _colour_favourable(track.colour, meaning, p)
        return _weight_favourable(track.weight, meaning, p)

    def _relation(self, a: str, b: str) -> tuple[Pose2, Matrix]:
        """Return mean and covariance, (3, 3), of a_T_b; they are kept until the next event."""
        if (a, b) not in self._relative:
            self._relative[a, b] = self._graph.relative(a, b)
        return self._relative[a, b]

    # ------------------------------------------------------------ snapshot

    def snapshot(self, step: int) -> messages.Belief:
        """Return the whole belief as a message, with the listed anchors and their joint covariance."""
        anchors = self.anchors()
        joint = self._graph.joint((BASE, *anchors))
        x, y, theta = joint.world_T_body[0]
        return messages.Belief(
            step=step,
            version=self.version,
            world_T_base=(x + 0.0, y + 0.0, theta + 0.0),
            base_covariance=upper(joint.block(0)),
            robot=self._graph.robot,
            anchors=anchors,
            objects={anchor: self._object(anchor, joint, i + 1) for i, anchor in enumerate(anchors)},
            regions=self._regions.messages(),
            identity=self.identity_changes(),
            keys=joint.names,
            joint_covariance=tuple((joint.covariance[np.triu_indices(len(joint.covariance))] + 0.0).tolist()),
        )

    def _object(self, anchor: str, joint: Joint, index: int) -> ObjectBelief:
        track = self._tracks[anchor]
        log_kg, variance = _weight_matched(track.weight)
        hsv, variances = _colour_matched(track.colour)
        arbitrary, listed = self._tracks.arbitrary(self._tracks.kind(anchor)), self._tracks.listed()
        return ObjectBelief(
            exists=track.exists,
            type=track.types.probabilities,
            world_T_object=raised(joint.world_T_body[index], self._z(track)),
            covariance=upper(joint.block(index)),
            support=track.support if track.support in listed else None,
            in_hand=track.hand,
            tool_T_object=self._grasp(track),
            colour=messages.HsvBelief(mean=hsv, variance=variances),
            colour_seen=track.colour != arbitrary.colour,
            log_weight=(log_kg + 0.0, variance + 0.0),
            weighed=track.weight != arbitrary.weight,
        )

    def _z(self, track: Track) -> float:
        return self._graph.base_T_held(track.hand)[2] if track.hand else track.z

    def _grasp(self, track: Track) -> Pose4 | None:
        return self._graph.tool_T_object(track.hand) if track.hand else None


def _identity(event: Event, version: int) -> tuple[messages.IdentityChange, ...]:
    """Return the change of identity that an event makes, if any."""
    if isinstance(event, Merged):
        return (messages.IdentityChange(version=version, kind="merged", anchor=event.anchor, other=event.other),)
    if isinstance(event, Split):
        return (messages.IdentityChange(version=version, kind="split", anchor=event.anchor),)
    return ()


def _prob(track: Track, meaning: Meaning) -> float:
    """Return P(the object has the property), given that it exists."""
    if isinstance(meaning, TypeIs):
        return track.types.prob(meaning.type)
    if isinstance(meaning, TypeIsNot):
        return 1.0 - track.types.prob(meaning.type)
    if isinstance(meaning, ColourMeaning):
        return _colour_prob(track.colour, meaning)
    return _weight_prob(track.weight, meaning)
