"""What a scenario file may say: frozen models, no unknown key, numbers that are numbers.

A scenario has two readers. `world`, `noise` and `disturbances` are the truth, for `skolem.sim` alone; `belief`,
`priors` and `model` are what the robot is told. `expect` is read by tests and reports, never by the robot.
"""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

from skolem.traces.messages import Limits, NoiseModel

Number = Annotated[float, Field(strict=True)]
Positive = Annotated[float, Field(gt=0, strict=True)]
NonNegative = Annotated[float, Field(ge=0, strict=True)]
Fraction = Annotated[float, Field(ge=0, le=1, strict=True)]
Count = Annotated[int, Field(ge=0, strict=True)]
Name = Annotated[
    str,
    Field(pattern=r"^[a-z][A-Za-z0-9_]*$", max_length=64, description="a name given from outside: a rigid designator"),
]
REGION_NAME = r"^_reg\d+_$"
RegionName = Annotated[str, Field(pattern=REGION_NAME, max_length=64, description="the name of a region: _reg1_")]
Place = Annotated[
    tuple[Number, Number, Number],
    Field(description="x, y [m], theta [rad]: in the world, or from the centre of the top of `on`"),
]
Hsv = Annotated[tuple[Fraction, Fraction, Fraction], Field(description="hue, saturation, value, each 0..1")]
BY_CONTACT = "drawn in the world without physics; with physics, contacts decide, and this is what is believed of them"


class Model(BaseModel):
    """Base of every part: frozen, no unknown key, no NaN or infinity."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class LogNormal(Model):
    """A weight nobody has measured."""

    median_kg: Positive
    sigma: Annotated[Positive, Field(description="sd of ln(kg)")]


class ColourPrior(Model):
    """A colour nobody has seen."""

    hsv: Hsv
    sd: tuple[Positive, Positive, Positive]


class Priors(Model):
    """What the robot believes of an arbitrary object."""

    log_weight: LogNormal
    colour: ColourPrior
    type: Annotated[
        dict[str, Fraction] | None,
        Field(description="probability of each type of what can be grasped; they sum to 1; null: all alike"),
    ] = None
    objects_per_region: Annotated[
        NonNegative, Field(description="how many objects nobody has told of are expected in a region")
    ] = 0.5


class DepthNoise(Model):
    """Error of the depth image."""

    sd_scale: Annotated[NonNegative, Field(description="times the Kinect's axial noise; 0 = exact depth")]


class RigidNoise(Model):
    """Independent errors along each axis and about it."""

    sd_m: NonNegative
    sd_rad: NonNegative


class DetectionNoise(Model):
    """What the detector misses, invents and confuses."""

    found: Annotated[Fraction, Field(description="probability that a visible object is detected")]
    false_per_look: Annotated[NonNegative, Field(description="expected number of detections without an object")]
    type_right: Annotated[Fraction, Field(description="probability that the reported type is the true one")]


class ColourNoise(Model):
    """Error of a detection's mean colour."""

    gain: Annotated[Positive, Field(description="mean observed value over true value: shading")]
    sd_rgb: NonNegative


class OdometryNoise(Model):
    """Error of one drive, in the frame of the base."""

    sd_m: NonNegative
    sd_per_m: NonNegative
    sd_rad: NonNegative
    sd_per_rad: NonNegative


class WristNoise(Model):
    """Error of the force at the wrist."""

    sd_newton: Annotated[NonNegative, Field(description="sd of one averaged reading")]
    drift_newton: Annotated[NonNegative, Field(description="sd of the slow bias, drawn once per run")]


class Noise(Model):
    """How sensors and motion err."""

    depth: DepthNoise
    extrinsics: Annotated[RigidNoise, Field(description="of the camera's frame, drawn once per look")]
    detection: DetectionNoise
    colour: ColourNoise
    odometry: OdometryNoise
    wrist: WristNoise
    grasp: Annotated[RigidNoise, Field(description=f"how far an object moves when the fingers close; {BY_CONTACT}")]
    place: Annotated[RigidNoise, Field(description=f"how far an object moves when it is released; {BY_CONTACT}")]

    def message(self) -> NoiseModel:
        """Return the same numbers as they cross borders."""
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
    colour=ColourNoise(gain=0.83, sd_rgb=0.0),  # shading is no error: light falls on things as it does
    odometry=OdometryNoise(sd_m=0.0, sd_per_m=0.0, sd_rad=0.0, sd_per_rad=0.0),
    wrist=WristNoise(sd_newton=0.0, drift_newton=0.0),
    grasp=RigidNoise(sd_m=0.0, sd_rad=0.0),
    place=RigidNoise(sd_m=0.0, sd_rad=0.0),
)


class BasePose(Model):
    """Where the base stands in the world."""

    x: Number
    y: Number
    theta: Number


class BaseSd(Model):
    """How well the robot knows that."""

    xy_m: Annotated[NonNegative, Field(description="along each axis")]
    theta_rad: NonNegative


class Robot(Model):
    """The robot's start; its arms are in their carry poses."""

    base: BasePose
    base_sd: BaseSd
    torso_m: Annotated[Number, Field(ge=0, le=0.31)]


class WorldObject(Model):
    """One thing that is really there."""

    id: Name
    type: str
    on: Annotated[Name | None, Field(description="a table; null: the floor")] = None
    at: Place
    hsv: Annotated[Hsv | None, Field(description="needed by what can be grasped")] = None
    kg: Annotated[Positive | None, Field(description="needed by what can be grasped")] = None


class Disturbance(Model):
    """Somebody moves a thing while the robot does not look."""

    before_step: Annotated[Count, Field(description="just before the robot executes its action of this number")]
    id: Name
    on: Annotated[Name | None, Field(description="a table; null: the floor")] = None
    at: Place


class BeliefDefaults(Model):
    """How well objects are known unless they say otherwise."""

    sd_xy_m: NonNegative
    sd_theta_rad: NonNegative


class BelievedObject(Model):
    """One object the robot is told of, either `like: world` or `at` a place."""

    id: Name
    type: Annotated[dict[str, Fraction], Field(description="probability of each possible type; they sum to 1")]
    like: Annotated[
        Literal["world"] | None, Field(description="the mean is drawn around the true pose with the stated sd")
    ] = None
    on: Annotated[Name | None, Field(description="with `at`: the believed table it stands on")] = None
    at: Place | None = None
    sd_xy_m: NonNegative | None = None
    sd_theta_rad: NonNegative | None = None
    colour: ColourPrior | None = None
    log_weight: LogNormal | None = None


class BelievedRegion(Model):
    """A region the robot may search: the air above the top of a support it is told of."""

    id: RegionName
    on: Annotated[Name, Field(description="a table the robot is told of")]
    height_m: Positive
    objects: Annotated[
        NonNegative | None,
        Field(
            description="how many objects the robot is not told of it expects there; null: priors.objects_per_region"
        ),
    ] = None


class InitialBelief(Model):
    """What the robot is told before it starts; the names are rigid designators."""

    defaults: BeliefDefaults
    objects: tuple[BelievedObject, ...]
    regions: tuple[BelievedRegion, ...] = ()


class Witness(Model):
    """A thing that a variable of the goal may stand for, with what shows that the goal can be achieved with it."""

    variable: Annotated[str, Field(description="of the goal")]
    thing: Annotated[Name, Field(description="an object of the world")]
    margin_sd: Annotated[NonNegative, Field(description="how surely it fits, in deviations of one sensor reading")]
    stand: Annotated[BasePose, Field(description="where the base can stand so that an arm reaches it")]
    cleared: Annotated[tuple[Name, ...], Field(description="what is put aside before, in this order")] = ()
    room: Annotated[Place | None, Field(description="a free place on the goal's table; null: none is needed")] = None


class Certificate(Model):
    """The known answer of a drawn world, from its truth alone."""

    family: str
    variant: str
    seed: Count
    retries: Annotated[Count, Field(description="attempts that were dropped: no place found, or no answer shown")]
    witnesses: Annotated[tuple[Witness, ...], Field(description="one for each variable of the goal")] = ()
    impossible: Annotated[
        Literal["nothing_fits", "nothing_reached", "no_room"] | None, Field(description="why there are no witnesses")
    ] = None
    off_m: Annotated[NonNegative, Field(description="how far beside the truth the told places are")] = 0.0
    noise: Annotated[Positive, Field(description="times the usual deviations of sensors and wheels")] = 1.0
    noise_told: Annotated[bool, Field(description="whether the robot is told so")] = True


class Expect(Model):
    """How the run should end."""

    status: Literal["goal_achieved", "goal_unachievable", "limit_reached"]
    chosen: str | None = None
    operators: tuple[str, ...] = ()
    replans_at_least: Count = 0
    certificate: Annotated[Certificate | None, Field(description="of a world drawn by `skolem generate`")] = None


class Scenario(Model):
    """A goal, a true world, and what the robot believes of it."""

    skolem: Annotated[Literal[1], Field(description="version of this format")]
    name: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=64)]
    about: str = ""
    goal: str
    seed: Annotated[Count, Field(lt=2**63, description="every draw is keyed by (seed, step, stream)")]
    limits: Limits
    rules: Annotated[tuple[str, ...], Field(description="extra rule files, relative to this file")] = ()
    priors: Priors
    noise: Annotated[
        Annotated[Literal["none"], Tag("none")] | Annotated[Noise, Tag("noise")],
        Discriminator(lambda value: "noise" if isinstance(value, dict | Noise) else "none"),
        Field(
            description="how sensors and motion truly err; none: not at all, and the robot is told exactly where it is "
            "and where all is that it is told of `like: world`"
        ),
    ]
    model: Annotated[
        Annotated[Literal["same"], Tag("same")] | Annotated[Noise, Tag("noise")],
        Discriminator(lambda value: "noise" if isinstance(value, dict | Noise) else "same"),
        Field(description="what the robot believes of the noise"),
    ] = "same"
    robot: Robot
    world: tuple[WorldObject, ...]
    disturbances: tuple[Disturbance, ...] = ()
    belief: InitialBelief
    expect: Expect | None = None

    @property
    def true_noise(self) -> Noise:
        """How sensors and motion truly err."""
        return EXACT if self.noise == "none" else self.noise
