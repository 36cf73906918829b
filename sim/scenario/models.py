"""The models of scenario files: frozen, without unknown keys, NaN or infinity.

A scenario has two readers. `world`, `noise` and `disturbances` are the truth, for `skolem.sim` alone; `belief`,
`priors` and `model` make the robot's prior. `expect` is read by tests and reports, never by the robot.
"""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

from skolem.sim.scenario.sizes import (
    MOST_FILES,
    MOST_MOVES,
    MOST_REGIONS,
    MOST_THINGS,
    ColourDeviation,
    Deviation,
    Expected,
    Factor,
    FalseDetections,
    Gain,
    Height,
    Kilograms,
    LimitsWithin,
    LogDeviation,
    Metres,
    Newtons,
    Radians,
    Seed,
    SensorDeviation,
    SensorTurned,
    Shade,
    Step,
    Torso,
    Turned,
)
from skolem.traces.messages import Evaluation, Limits, NoiseModel

Fraction = Annotated[float, Field(ge=0, le=1, strict=True)]
Name = Annotated[
    str,
    Field(pattern=r"^[a-z][A-Za-z0-9_]*$", max_length=64, description="a name given from outside: a rigid designator"),
]
REGION_NAME = r"^_reg\d+_$"
RegionName = Annotated[str, Field(pattern=REGION_NAME, max_length=64, description="the name of a region: _reg1_")]
Place = Annotated[
    tuple[Metres, Metres, Radians],
    Field(description="x, y [m], theta [rad]: in the world, or from the centre of the top of `on`"),
]
Hsv = Annotated[tuple[Fraction, Fraction, Fraction], Field(description="hue, saturation, value, each 0..1")]
BY_CONTACT = "drawn in the world without physics; with physics, contacts decide, and this is what is believed of them"


class Model(BaseModel):
    """Base of every part: frozen, no unknown key, no NaN or infinity."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class LogNormal(Model):
    """The prior of a weight that is not measured yet."""

    median_kg: Kilograms
    sigma: Annotated[LogDeviation, Field(description="sd of ln(kg)")]


class ColourPrior(Model):
    """The prior of a colour that is not seen yet."""

    hsv: Hsv
    sd: tuple[ColourDeviation, ColourDeviation, ColourDeviation]


class Priors(Model):
    """The robot's prior of an arbitrary object."""

    log_weight: LogNormal
    colour: ColourPrior
    type: Annotated[
        dict[str, Fraction] | None,
        Field(description="probability of each graspable type; they sum to 1; null: all alike"),
    ] = None
    objects_per_region: Annotated[
        Expected, Field(description="expected number of objects in a region that are not in the prior")
    ] = 0.5


class DepthNoise(Model):
    """Error of the depth image."""

    sd_scale: Annotated[Factor, Field(description="times the Kinect's axial noise; 0 = exact depth")]


class RigidNoise(Model):
    """Independent errors along each axis and about each axis."""

    sd_m: SensorDeviation
    sd_rad: SensorTurned


class DetectionNoise(Model):
    """Missed detections, false detections and confusions of types."""

    found: Annotated[Fraction, Field(description="probability that a visible object is detected")]
    false_per_look: Annotated[FalseDetections, Field(description="expected number of detections without an object")]
    type_right: Annotated[Fraction, Field(description="probability that the reported type is the true one")]


class ColourNoise(Model):
    """Error of a detection's mean colour."""

    gain: Annotated[Gain, Field(description="mean observed value over true value: shading")]
    sd_rgb: Shade


class OdometryNoise(Model):
    """Error of one drive, in the frame of the base."""

    sd_m: SensorDeviation
    sd_per_m: SensorDeviation
    sd_rad: SensorTurned
    sd_per_rad: SensorTurned


class WristNoise(Model):
    """Error of the force at the wrist."""

    sd_newton: Annotated[Newtons, Field(description="sd of one averaged reading")]
    drift_newton: Annotated[Newtons, Field(description="sd of the slow bias, drawn once per run")]


class Noise(Model):
    """Errors of sensors and motion."""

    depth: DepthNoise
    extrinsics: Annotated[RigidNoise, Field(description="of the camera's frame, drawn once per look")]
    detection: DetectionNoise
    colour: ColourNoise
    odometry: OdometryNoise
    wrist: WristNoise
    grasp: Annotated[RigidNoise, Field(description=f"how far an object moves when the fingers close; {BY_CONTACT}")]
    place: Annotated[RigidNoise, Field(description=f"how far an object moves when it is released; {BY_CONTACT}")]

    def message(self) -> NoiseModel:
        """Return the same numbers as a message."""
        return NoiseModel(
            depth_sd_scale=self.depth.sd_scale,
            extrinsics_sd_m=self.extrinsics.sd_m,
            extrinsics_sd_rad=self.extrinsics.sd_rad,
            found=self.detection.found,
            false_per_look=self.detection.false_per_look,
            type_right=self.detection.type_right,
            colour_gain=self.colour.gain,
            colour_sd_rgb=self.colour.sd_rgb,
            odometry_sd_m=self.odometry.sd_m,
            odometry_sd_per_m=self.odometry.sd_per_m,
            odometry_sd_rad=self.odometry.sd_rad,
            odometry_sd_per_rad=self.odometry.sd_per_rad,
            wrist_sd_newton=self.wrist.sd_newton,
            wrist_drift_newton=self.wrist.drift_newton,
            grasp_sd_m=self.grasp.sd_m,
            grasp_sd_rad=self.grasp.sd_rad,
            place_sd_m=self.place.sd_m,
            place_sd_rad=self.place.sd_rad,
        )


EXACT = Noise(
    depth=DepthNoise(sd_scale=0.0),
    extrinsics=RigidNoise(sd_m=0.0, sd_rad=0.0),
    detection=DetectionNoise(found=1.0, false_per_look=0.0, type_right=1.0),
    colour=ColourNoise(gain=0.83, sd_rgb=0.0),  # shading is no error of the camera, so it stays
    odometry=OdometryNoise(sd_m=0.0, sd_per_m=0.0, sd_rad=0.0, sd_per_rad=0.0),
    wrist=WristNoise(sd_newton=0.0, drift_newton=0.0),
    grasp=RigidNoise(sd_m=0.0, sd_rad=0.0),
    place=RigidNoise(sd_m=0.0, sd_rad=0.0),
)


class BasePose(Model):
    """The pose of the base in the world."""

    x: Metres
    y: Metres
    theta: Radians


class BaseSd(Model):
    """The standard deviations of the believed pose of the base."""

    xy_m: Annotated[Deviation, Field(description="along each axis")]
    theta_rad: Turned


class Robot(Model):
    """The robot's start; its arms are in their carry poses."""

    base: BasePose
    base_sd: BaseSd
    torso_m: Torso


class WorldObject(Model):
    """One true object."""

    id: Name
    type: str
    on: Annotated[Name | None, Field(description="a table; null: the floor")] = None
    at: Place
    hsv: Annotated[Hsv | None, Field(description="needed by what can be grasped")] = None
    kg: Annotated[Kilograms | None, Field(description="needed by what can be grasped")] = None


class Disturbance(Model):
    """A move of an object from outside, unseen by the robot."""

    before_step: Annotated[Step, Field(description="just before the robot executes its action of this number")]
    id: Name
    on: Annotated[Name | None, Field(description="a table; null: the floor")] = None
    at: Place


class BeliefDefaults(Model):
    """The default standard deviations of the places of objects."""

    sd_xy_m: Deviation
    sd_theta_rad: Turned


class BelievedObject(Model):
    """One object of the prior, either `like: world` or `at` a place."""

    id: Name
    type: Annotated[dict[str, Fraction], Field(description="probability of each possible type; they sum to 1")]
    like: Annotated[
        Literal["world"] | None, Field(description="the mean is drawn around the true pose with the stated sd")
    ] = None
    on: Annotated[Name | None, Field(description="with `at`: the believed table it stands on")] = None
    at: Place | None = None
    sd_xy_m: Deviation | None = None
    sd_theta_rad: Turned | None = None
    colour: ColourPrior | None = None
    log_weight: LogNormal | None = None


class BelievedRegion(Model):
    """A region that the robot may search: the air above the top of a support in the prior."""

    id: RegionName
    on: Annotated[Name, Field(description="a table in the prior")]
    height_m: Height
    objects: Annotated[
        Expected | None,
        Field(
            description="expected number of objects there that are not in the prior; null: priors.objects_per_region"
        ),
    ] = None


class InitialBelief(Model):
    """The robot's prior of objects and regions; the names are rigid designators."""

    evaluation: Annotated[
        Evaluation,
        Field(
            description="worlds: the share of possible worlds in which the goal's beliefs are true; independent: the "
            "paper's product of the probabilities of their parts"
        ),
    ] = "worlds"
    defaults: BeliefDefaults
    objects: Annotated[tuple[BelievedObject, ...], Field(max_length=MOST_THINGS)]
    regions: Annotated[tuple[BelievedRegion, ...], Field(max_length=MOST_REGIONS)] = ()


class Witness(Model):
    """An object for a variable of the goal, with the evidence that the goal can be achieved with it."""

    variable: Annotated[str, Field(description="of the goal")]
    thing: Annotated[Name, Field(description="an object of the world")]
    margin_sd: Annotated[Factor, Field(description="how surely it fits, in deviations of one sensor reading")]
    stand: Annotated[BasePose, Field(description="where the base can stand so that an arm reaches it")]
    cleared: Annotated[tuple[Name, ...], Field(description="what is put aside before, in this order")] = ()
    room: Annotated[Place | None, Field(description="a free place on that table; null: none is needed")] = None
    on: Annotated[Name | None, Field(description="the table of `room`; null: the one that the goal names")] = None


class Certificate(Model):
    """The known answer of a drawn world, from its truth alone."""

    family: str
    variant: str
    seed: Seed
    retries: Annotated[Seed, Field(description="attempts that were dropped: no place found, or no answer shown")]
    witnesses: Annotated[
        tuple[Witness, ...],
        Field(description="one for each variable of the goal, or for each object that is counted or moved"),
    ] = ()
    impossible: Annotated[
        Literal["nothing_fits", "too_few_fit", "too_many_fit", "nothing_reached", "no_room"] | None,
        Field(description="why there are no witnesses"),
    ] = None
    off_m: Annotated[Deviation, Field(description="distance of the prior's places from the true ones, metres")] = 0.0
    noise: Annotated[Factor, Field(description="times the usual deviations of sensors and wheels")] = 1.0
    noise_told: Annotated[bool, Field(description="whether the robot knows that factor")] = True


class Expect(Model):
    """How the run should end."""

    status: Literal["goal_achieved", "goal_unachievable", "no_referent", "no_unique_referent", "limit_reached"]
    chosen: str | None = None
    operators: tuple[str, ...] = ()
    replans_at_least: Step = 0
    certificate: Annotated[Certificate | None, Field(description="of a world drawn by `skolem generate`")] = None


class Scenario(Model):
    """A goal, a true world, and the robot's prior."""

    skolem: Annotated[Literal[1], Field(description="version of this format")]
    name: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=64)]
    about: str = ""
    goal: Annotated[
        str,
        Field(
            description="what is to be believed of which objects, as docs/goals.md explains: exists o."
            " B(Den(lambda x. Green(x), o), 0.9) & B(On(o, table1), 0.9)"
        ),
    ]
    seed: Annotated[Seed, Field(description="every draw is keyed by (seed, step, stream)")]
    limits: Annotated[Limits, LimitsWithin()]
    rules: Annotated[
        tuple[str, ...], Field(max_length=MOST_FILES, description="extra rule files, relative to this file")
    ] = ()
    priors: Priors
    noise: Annotated[
        Annotated[Literal["none"], Tag("none")] | Annotated[Noise, Tag("noise")],
        Discriminator(lambda value: "noise" if isinstance(value, dict | Noise) else "none"),
        Field(
            description="true errors of sensors and motion; none: no errors, and the prior has the exact places of the "
            "robot and of all objects `like: world`"
        ),
    ]
    model: Annotated[
        Annotated[Literal["same"], Tag("same")] | Annotated[Noise, Tag("noise")],
        Discriminator(lambda value: "noise" if isinstance(value, dict | Noise) else "same"),
        Field(description="the noise that the robot believes"),
    ] = "same"
    robot: Robot
    world: Annotated[tuple[WorldObject, ...], Field(max_length=MOST_THINGS)]
    disturbances: Annotated[tuple[Disturbance, ...], Field(max_length=MOST_MOVES)] = ()
    belief: InitialBelief
    expect: Expect | None = None

    @property
    def true_noise(self) -> Noise:
        """The true errors of sensors and motion."""
        return EXACT if self.noise == "none" else self.noise
