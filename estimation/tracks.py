"""The belief on each anchor without its planar pose: existence, type, colour, weight, height, support and hand."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from skolem.estimation.association import MAX_LOG_ODDS
from skolem.estimation.attributes import TypeBelief, after_evidence
from skolem.estimation.colour import ColourBelief, ColourSensor
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import (
    Began,
    Event,
    Looked,
    Lost,
    Merged,
    Missed,
    Picked,
    PickFailed,
    Place,
    Placed,
    Sighting,
    Sought,
    Split,
    Weighed,
)
from skolem.estimation.weight import WeightBelief, WeightSensor
from skolem.traces.errors import InternalError
from skolem.traces.messages import GRAVITY, Detection, Hand, HsvBelief, ObjectType, Prior, PriorObject
from skolem.traces.messages.likeliest import likeliest

# The prior of colours is that of graspable objects. Other types have an unknown hue, and nearly unknown other axes.
ANY_COLOUR = HsvBelief(mean=(0.5, 0.5, 0.5), variance=(1.0, 1.0, 1.0))
INTRODUCED = re.compile(r"_o(\d+)_")  # form of the names that the robot gives to new anchors


@dataclass(frozen=True, slots=True)
class Track:
    """The belief on one anchor, without its planar pose.

    Attributes:
        exists: P(the object exists).
        types, colour, weight: Beliefs on the object's properties, given that it exists.
        z: Height of its base, metres; without meaning while a hand holds it.
        z_variance: Variance of `z`, square metres.
        support: Its support; None for the floor, for a hand, and if nothing is known.
        hand: The hand that holds it.
        places: Weighted places, while its place is uncertain; otherwise none, and the pose graph has its place.
        rests: P(it stands on a known support, and not on the floor or elsewhere | it exists).
        otherwise: P(something else stands in its place | it does not exist).
        surest: Greatest P(the object exists) so far.
    """

    exists: float
    types: TypeBelief
    colour: ColourBelief
    weight: WeightBelief
    z: float
    z_variance: float
    support: str | None
    otherwise: float
    hand: Hand | None = None
    places: tuple[Place, ...] = ()
    rests: float = 1.0
    surest: float = 0.0

    def __post_init__(self) -> None:
        """Keep the greatest P(the object exists)."""
        object.__setattr__(self, "surest", max(self.surest, self.exists))


class Tracks:
    """The tracks of all anchors so far, in order of introduction; names are never reused."""

    def __init__(self, config: EstimatorConfig) -> None:
        self._config = config
        self._tracks: dict[str, Track] = {}
        self._first: dict[str, Track] = {}  # before it was first picked, by anchor
        self._prior: Prior | None = None

    @property
    def prior(self) -> Prior:
        """The prior of the robot."""
        assert self._prior is not None, "the first event is Began"
        return self._prior

    def __getitem__(self, anchor: str) -> Track:
        if anchor not in self._tracks:
            raise InternalError(f"no anchor '{anchor}'; there are: {', '.join(self._tracks)}")
        return self._tracks[anchor]

    def get(self, anchor: str) -> Track | None:
        """Return the track of an anchor, or None for an unknown name."""
        return self._tracks.get(anchor)

    def first(self, anchor: str) -> Track:
        """Return the track of an anchor with height and support as they were before it was first picked."""
        track, first = self[anchor], self._first.get(anchor)
        if first is None:
            return track
        return replace(
            track,
            z=first.z,
            z_variance=first.z_variance,
            support=first.support,
            hand=None,
            places=first.places,
            rests=first.rests,
        )

    def kind(self, anchor: str) -> ObjectType:
        """Return the most likely type of an anchor."""
        return self.prior.types[self[anchor].types.most_likely()]

    def seen_as(self, detection: Detection) -> ObjectType:
        """Return the likeliest type of a detection."""
        return self.prior.types[likeliest(detection.type_log_likelihood)]

    def top(self, support: str) -> float:
        """Return the height, in metres, of the top of a support."""
        return self[support].z + self.kind(support).size_m[2]

    def rests_at(self, z: float, variance: float, support: str) -> bool:
        """Return whether an object can rest on `support` if its base is at height `z` (metres; variance in m^2)."""
        return abs(z - self.top(support)) <= self._config.height_tolerance_m + 2.0 * math.sqrt(variance)

    def listed(self) -> tuple[str, ...]:
        """Return the listed anchors: held ones, and all whose P(exists) is not below `listed`."""
        least = self._config.listed
        return tuple(name for name, track in self._tracks.items() if track.exists >= least or track.hand)

    def likely(self) -> tuple[str, ...]:
        """Return the anchors that are likely to exist."""
        return tuple(name for name, track in self._tracks.items() if track.exists >= self._config.likely)

    def possible(self) -> tuple[str, ...]:
        """Return the anchors that have not been given up."""
        return tuple(name for name, track in self._tracks.items() if track.exists >= self._config.retired)

    def given_up(self) -> tuple[str, ...]:
        """Return the anchors that have been given up."""
        return tuple(name for name, track in self._tracks.items() if track.exists < self._config.retired)

    def detectable(self) -> tuple[str, ...]:
        """Return the anchors that a detection may be of: not given up, not held, and reported by the detector."""
        loose = [name for name in self.possible() if self._tracks[name].hand is None]
        return tuple(name for name in loose if self.is_reported(name))

    def is_reported(self, anchor: str) -> bool:
        """Return whether the detector reports the most likely type of an anchor: a graspable one, or a table."""
        return self.kind(anchor).graspable or self.kind(anchor).shape == "table"

    def held(self, hand: Hand) -> str | None:
        """Return the anchor in a hand, or None."""
        return next((name for name, track in self._tracks.items() if track.hand == hand), None)

    def new_names(self, count: int) -> tuple[str, ...]:
        """Return names for new anchors; their numbers are above all in use, those of the prior included."""
        used = (INTRODUCED.fullmatch(name) for name in self._tracks)
        first = 1 + max((int(found[1]) for found in used if found), default=0)
        return tuple(f"_o{first + i}_" for i in range(count))

    # ------------------------------------------------------------ change

    def apply(self, event: Event) -> None:
        """Take in one event."""
        match event:
            case Began():
                self._prior = event.prior
                self._tracks = {item.anchor: self._of_prior(item) for item in event.prior.objects}
            case Looked():
                self._look(event)
            case Picked():
                self._first.setdefault(event.anchor, self[event.anchor])
                track = self._evidence(event.anchor, (1.0 - self._config.pick_fails) / self._config.pick_deceives)
                self._tracks[event.anchor] = replace(track, hand=event.hand, support=None)
            case PickFailed():
                odds = self._config.pick_fails / (1.0 - self._config.pick_deceives)
                self._tracks[event.anchor] = self._evidence(event.anchor, odds)
            case Placed():
                self._tracks[event.anchor] = self._placed(event)
            case Sought():
                z, variance = self.top(event.support), self._config.height_sd_m**2
                moved = replace(self[event.anchor], z=z, z_variance=variance, support=event.support)
                self._tracks[event.anchor] = replace(moved, places=event.places)
            case Lost():
                z, variance = event.base_T_tool[2], event.sd_z_m**2
                lost = replace(self[event.anchor], hand=None, support=None, z=z, z_variance=variance)
                self._tracks[event.anchor] = replace(lost, rests=self._config.lost_rests)
            case Weighed():
                track = self[event.anchor]
                self._tracks[event.anchor] = replace(track, weight=track.weight.updated(event.kg))
            case Merged():
                self._merge(event)
            case Split():
                self._tracks[event.anchor] = self._split(event.anchor)

    def _split(self, anchor: str) -> Track:
        """Return a track that keeps only existence, height and support; the rest is as before the first detection."""
        track, fresh = self[anchor], self._unseen(anchor)
        return replace(fresh, exists=track.exists, z=track.z, z_variance=track.z_variance, support=track.support)

    def _merge(self, event: Merged) -> None:
        """Add to the first anchor the observations of the other, and give the other up."""
        track, other = self[event.anchor], self[event.other]
        if event.other in self._first:
            self._first.setdefault(event.anchor, self._first[event.other])
        stranger = self.arbitrary(self.kind(event.anchor))
        gain = track.z_variance / (track.z_variance + other.z_variance)
        merged = replace(
            track,
            types=track.types.fused(other.types, stranger.types),
            colour=track.colour.fused(other.colour, stranger.colour),
            weight=track.weight.fused(other.weight),
            z=track.z + gain * (other.z - track.z),
            z_variance=(1.0 - gain) * track.z_variance,
            support=track.support or other.support,
            places=(),
            rests=1.0,
        )
        self._tracks |= {event.anchor: merged, event.other: replace(other, exists=0.0)}
        odds = other.exists / (1.0 - other.exists)
        self._tracks[event.anchor] = self._evidence(event.anchor, max(odds, 1.0))

    def _unseen(self, anchor: str) -> Track:
        """Return the belief on an anchor before its first detection."""
        item = next((item for item in self.prior.objects if item.anchor == anchor), None)
        return self._of_prior(item) if item else self.stranger()

    def _look(self, event: Looked) -> None:
        for sighting in event.sightings:
            track = self._new(sighting) if sighting.new else self._seen(sighting)
            self._tracks[sighting.anchor] = track
        for miss in event.missed:
            self._tracks[miss.anchor] = self._missed(miss)

    def is_gone(self, miss: Missed) -> bool:
        """Return whether a missed detection unlists an anchor of whose object the robot was sure before."""
        track, least = self[miss.anchor], self._config.listed
        return track.surest >= self._config.sure and track.exists >= least > self._missed(miss).exists

    def _missed(self, miss: Missed) -> Track:
        """Return the track of an anchor after a missed detection, given the solid that the picture shows in its place.

        The solid is the object or something else. It is evidence only once after each detection of the object.
        """
        track = self[miss.anchor]
        without = 1.0 - miss.solid * (1.0 - track.otherwise)
        exists = after_evidence(track.exists, (1.0 - miss.p_reported) / without)
        silent = 1.0 - miss.p_reported
        rests = (track.rests - miss.p_reported) / silent if track.places and silent > 0.0 else track.rests
        surest = self._config.most_sure
        return replace(track, exists=min(exists, surest), otherwise=track.otherwise / without, rests=max(rests, 0.0))

    def _of_prior(self, item: PriorObject) -> Track:
        arbitrary = self.arbitrary(self.prior.types[likeliest(item.type)])
        weight = arbitrary.weight
        return self._track(
            exists=self._config.most_sure,
            types=item.type,
            colour=ColourBelief.of(item.colour, self._colour_sensor()) if item.colour else arbitrary.colour,
            log_weight=item.log_weight or (weight.mean, weight.variance),
            z=item.world_T_object[2],
            support=item.support,
        )

    def stranger(self) -> Track:
        """Return the belief on an arbitrary object that is not met yet; its height has no meaning."""
        return self._track(
            exists=0.5,
            types=self.prior.type or dict.fromkeys(self._reported(), 1.0),
            colour=ColourBelief.of(self.prior.colour, self._colour_sensor()),
            log_weight=self.prior.log_weight,
            z=0.0,
            support=None,
        )

    def arbitrary(self, kind: ObjectType) -> Track:
        """Return the belief on an arbitrary object of a type, given only whether that type can be grasped."""
        stranger = self.stranger()
        if kind.graspable:
            return stranger
        weight = WeightBelief(math.log(self._config.bulky_kg), self._config.bulky_sigma**2, stranger.weight.sensor)
        return replace(stranger, colour=ColourBelief.of(ANY_COLOUR, self._colour_sensor()), weight=weight)

    def _new(self, sighting: Sighting) -> Track:
        """Return the track of a new anchor: an arbitrary object, or a false detection.

        A detected table is of one of the types of tables, but an arbitrary object is of none of them.
        """
        support, seen_as = sighting.support, sighting.detection.type_log_likelihood
        stranger = self.arbitrary(self.seen_as(sighting.detection))
        types = stranger.types
        if not any(self.prior.types[name].graspable for name in seen_as):
            types = replace(types, probabilities={name: 1.0 / len(seen_as) for name in sorted(seen_as)})
        return replace(
            stranger,
            exists=min(after_evidence(stranger.exists, sighting.odds), self._config.most_sure),
            types=types.updated(seen_as),
            colour=stranger.colour.updated(sighting.detection.rgb),
            z=sighting.z if support is None else self.top(support),
            z_variance=sighting.z_sd_m**2 if support is None else stranger.z_variance,
            support=support,
        )

    def _track(
        self,
        exists: float,
        types: Mapping[str, float],
        colour: ColourBelief,
        log_weight: tuple[float, float],
        z: float,
        support: str | None,
    ) -> Track:
        noise, total = self.prior.noise, sum(types.values())
        normal = {name: types[name] / total for name in sorted(types)}
        belief = TypeBelief(normal, self._reported(), noise.type_right)
        wrist = WeightSensor(noise.wrist_sd_newton / GRAVITY, noise.wrist_drift_newton / GRAVITY)
        weight = WeightBelief(*log_weight, wrist)
        z_variance, otherwise = self._config.height_sd_m**2, self._config.other_solid
        return Track(exists, belief, colour, weight, z, z_variance, support, otherwise)

    def _reported(self) -> tuple[str, ...]:
        """Return the graspable types, which the detector may confuse, sorted."""
        return tuple(sorted(name for name, kind in self.prior.types.items() if kind.graspable))

    def _colour_sensor(self) -> ColourSensor:
        return ColourSensor(self.prior.noise.colour_gain, self.prior.noise.colour_sd_rgb)

    def _seen(self, sighting: Sighting) -> Track:
        track = self._evidence(sighting.anchor, sighting.odds)
        gain = track.z_variance / (track.z_variance + sighting.z_sd_m**2)
        return replace(
            track,
            support=sighting.support or track.support,
            places=(),
            rests=1.0,
            types=track.types.updated(sighting.detection.type_log_likelihood),
            colour=track.colour.updated(sighting.detection.rgb),
            z=track.z + gain * (sighting.z - track.z),
            z_variance=(1.0 - gain) * track.z_variance,
        )

    def _placed(self, event: Placed) -> Track:
        track = self[event.anchor]
        z = event.base_T_tool[2] + event.tool_z_object if event.support is None else self.top(event.support)
        return replace(
            track,
            hand=None,
            support=event.support,
            z=z,
            z_variance=self._config.height_sd_m**2,
            otherwise=self._config.other_solid,
        )

    def _evidence(self, anchor: str, odds: float) -> Track:
        """Return the track after an observation that is `odds` times likelier if the object exists.

        P(exists) never exceeds `most_sure`; the added doubt is that someone takes the object from now on. In that case,
        the solid of earlier pictures was the object, and says nothing about what would stand there instead.
        """
        track, surest = self[anchor], self._config.most_sure
        exists = after_evidence(track.exists, min(odds, math.exp(MAX_LOG_ODDS)))
        if exists <= surest:
            return replace(track, exists=exists)
        before = (1.0 - exists) / (1.0 - surest)  # share of the older doubt
        otherwise = before * track.otherwise + (1.0 - before) * self._config.other_solid
        return replace(track, exists=surest, otherwise=otherwise)
