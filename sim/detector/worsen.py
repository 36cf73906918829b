"""Errors of a real detector, added to clean ones: missed and false detections, wrong types and colours."""

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from skolem.sim.detector.detect import Seen, canonical_order, pose_covariance
from skolem.sim.detector.fitting import MODEL_SD_M, UNKNOWN_YAW_SD_RAD
from skolem.sim.detector.likelihood import likeness
from skolem.sim.truth.noise import Purpose, stream
from skolem.traces.messages import Detection, NoiseModel, ObjectType
from skolem.traces.messages.likeliest import likeliest

FALSE_POINTS = (40, 300)  # number of points of a false detection: least, greatest


def worsen(
    seen: Seen, types: dict[str, ObjectType], noise: NoiseModel, stated: NoiseModel, seed: int, step: int
) -> tuple[Detection, ...]:
    """Return the detections of one look after missed detections, type confusions, colour noise and false detections.

    Tables may be missed too. They are never confused with graspable objects, and there are no false tables.

    Args:
        seen: The clean detections, in canonical order, which is also the order of the draws.
        types: Every type; confusions and false detections are among the graspable ones.
        noise: True rates and standard deviations.
        stated: The stated noise, from which the detector computes covariances.
        seed: Seed of the run.
        step: Step of the look.
    """
    names = sorted(name for name, kind in types.items() if kind.graspable)
    count = len(seen.detections)
    kept = stream(seed, step, Purpose.MISSED).random(count) < noise.found
    tint = stream(seed, step, Purpose.COLOUR).normal(size=(count, 3)) * noise.colour_sd_rgb
    confusion = stream(seed, step, Purpose.CONFUSED)
    worse = [
        _confused(_tinted(detection, shift), names, noise.type_right, confusion)
        for detection, shift in zip(seen.detections, tint, strict=True)
    ]
    found = [detection for detection, keep in zip(worse, kept, strict=True) if keep]
    found += _false_detections(
        seen, names, types, noise.false_per_look, stated, stream(seed, step, Purpose.FALSE_ALARM)
    )
    return canonical_order(found + _tables(seen.tables, noise, stream(seed, step, Purpose.TABLES)))


def _tables(tables: tuple[Detection, ...], noise: NoiseModel, draws: Generator) -> list[Detection]:
    """Return the tables that are not missed, with colour noise."""
    kept = draws.random(len(tables)) < noise.found
    tint = draws.normal(size=(len(tables), 3)) * noise.colour_sd_rgb
    return [_tinted(table, shift) for table, keep, shift in zip(tables, kept, tint, strict=True) if keep]


def _tinted(detection: Detection, shift: NDArray[np.float64]) -> Detection:
    """Return the detection with its mean colour shifted by `shift`, kept within 0..1."""
    red, green, blue = (float(value) for value in np.clip(np.add(detection.rgb, shift), 0.0, 1.0))
    return detection.model_copy(update={"rgb": (red, green, blue)})


def _confused(detection: Detection, names: list[str], right: float, draws: Generator) -> Detection:
    """Return the detection; with probability 1 - `right`, its highest likelihood goes to another type."""
    luck, choice = draws.random(2)
    likelihood = dict(detection.type_log_likelihood)
    best = likeliest(likelihood)
    others = [name for name in names if name != best]
    if luck < right or not others:
        return detection
    other = others[int(choice * len(others))]
    likelihood[best], likelihood[other] = likelihood[other], likelihood[best]
    return detection.model_copy(update={"type_log_likelihood": likelihood})


def _false_detections(
    seen: Seen, names: list[str], types: dict[str, ObjectType], rate: float, stated: NoiseModel, draws: Generator
) -> list[Detection]:
    """Return false detections at visible places of the supports, of random type, heading and colour."""
    if not seen.supports or not names:
        return []
    return [_false_detection(seen, names, types, stated, draws) for _ in range(draws.poisson(rate))]


def _false_detection(
    seen: Seen, names: list[str], types: dict[str, ObjectType], stated: NoiseModel, draws: Generator
) -> Detection:
    """Return one false detection, as of an object of a random type at a random visible place."""
    places = np.concatenate([support.points for support in seen.supports])
    x, y, z = (float(value) for value in places[draws.integers(len(places))])
    claimed = types[names[int(draws.integers(len(names)))]]
    upright = claimed.shape == "cylinder"
    base_T_object = (x, y, z, 0.0 if upright else float(draws.uniform(-np.pi / 2.0, np.pi / 2.0)))
    fit = np.diag([MODEL_SD_M**2, MODEL_SD_M**2, UNKNOWN_YAW_SD_RAD**2 if upright else MODEL_SD_M**2])
    distance_m = float(np.linalg.norm(np.array([x, y, z]) - seen.camera_base))
    red, green, blue = (float(value) for value in draws.random(3))
    return Detection(
        base_T_object=base_T_object,
        covariance=pose_covariance(fit, base_T_object, seen.camera_base, stated),
        type_log_likelihood={name: likeness(claimed, types[name], distance_m) for name in names},
        rgb=(red, green, blue),
        points=int(draws.integers(*FALSE_POINTS)),
    )
