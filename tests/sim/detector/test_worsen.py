import math

import numpy as np
import pytest
from kit.tabletop import EXACT, GREEN, HEAD, RED, TABLE, TABLE_M, TYPES, seen_cloud

from skolem.sim.detector.detect import Seen, canonical_order, detect
from skolem.sim.detector.worsen import worsen
from skolem.traces.messages import Detection, NoiseModel

LOOKS = 300


@pytest.fixture(scope="module")
def seen() -> Seen:
    """Return what an exact look at two things on a table shows."""
    things = [TABLE, ("soda", (1.0, -0.2, TABLE_M, 0.0), RED), ("bottle", (1.1, 0.2, TABLE_M, 0.0), GREEN)]
    return detect(seen_cloud(things, EXACT), TYPES, EXACT)


def looks(seen: Seen, **changes: float) -> list[tuple[Detection, ...]]:
    """Return the reports of many looks, tables left out."""
    return [tuple(d for d in look if type_of(d) != "table") for look in whole_looks(seen, **changes)]


def whole_looks(seen: Seen, **changes: float) -> list[tuple[Detection, ...]]:
    noise: NoiseModel = EXACT.model_copy(update=changes)
    return [worsen(seen, TYPES, noise, noise, 0, step) for step in range(LOOKS)]


def type_of(detection: Detection) -> str:
    return max(detection.type_log_likelihood, key=lambda name: detection.type_log_likelihood[name])


def three_sd(probability: float, count: int) -> float:
    return 3.0 * math.sqrt(probability * (1.0 - probability) / count)


def test_a_perfect_detector_is_left_as_it_is(seen: Seen) -> None:
    assert worsen(seen, TYPES, EXACT, EXACT, 0, 0) == canonical_order([*seen.detections, *seen.tables])


def test_things_are_missed_at_the_given_rate(seen: Seen) -> None:
    found = sum(map(len, looks(seen, found=0.8))) / (2 * LOOKS)
    assert found == pytest.approx(0.8, abs=three_sd(0.8, 2 * LOOKS))


def test_types_are_right_at_the_given_rate_and_poses_stay(seen: Seen) -> None:
    reported = [detection for look in looks(seen, type_right=0.7) for detection in look]
    truth = {detection.base_T_object: type_of(detection) for detection in seen.detections}
    right = np.mean([type_of(detection) == truth[detection.base_T_object] for detection in reported])
    assert right == pytest.approx(0.7, abs=three_sd(0.7, 2 * LOOKS))


def test_colours_scatter_by_the_given_sd(seen: Seen) -> None:
    green = [
        detection.rgb[1] for look in looks(seen, colour_sd_rgb=0.05) for detection in look if detection.rgb[1] > 0.3
    ]
    assert np.std(green) == pytest.approx(0.05, rel=3.0 / math.sqrt(2.0 * LOOKS))


def test_false_alarms_come_at_the_given_rate_and_lie_on_supports(seen: Seen) -> None:
    false = [detection for look in looks(seen, found=0.0, false_per_look=0.5) for detection in look]
    assert len(false) / LOOKS == pytest.approx(0.5, abs=3.0 * math.sqrt(0.5 / LOOKS))
    for detection in false:
        x, y, z, _ = detection.base_T_object
        assert min(abs(support.z_at(x, y) - z) for support in seen.supports) < 0.015
    assert {type_of(detection) for detection in false} == {"bottle", "carton", "soda"}


def test_tables_are_missed_at_the_given_rate_and_never_taken_for_something_else(seen: Seen) -> None:
    (table,) = seen.tables
    reported = [
        [d for d in look if type_of(d) == "table"]
        for look in whole_looks(seen, found=0.8, type_right=0.1, false_per_look=2.0)
    ]
    assert sum(map(len, reported)) / LOOKS == pytest.approx(0.8, abs=three_sd(0.8, LOOKS))
    assert all(d == table for look in reported for d in look)


def test_no_support_in_view_no_false_alarm() -> None:
    noise = EXACT.model_copy(update={"false_per_look": 5.0})
    assert worsen(Seen((), (), HEAD.origin), TYPES, noise, noise, 0, 0) == ()


def test_what_is_reported_is_in_canonical_order(seen: Seen) -> None:
    for look in whole_looks(seen, false_per_look=3.0, type_right=0.5)[:20]:
        assert look == canonical_order(list(look))


def test_more_false_alarms_change_no_other_draw(seen: Seen) -> None:
    calm, busy = (looks(seen, found=0.7, colour_sd_rgb=0.03, false_per_look=rate) for rate in (0.0, 2.0))
    assert all(set(a) <= set(b) for a, b in zip(map(_keys, calm), map(_keys, busy), strict=True))


def _keys(look: tuple[Detection, ...]) -> list[bytes]:
    return [detection.canonical() for detection in look]
