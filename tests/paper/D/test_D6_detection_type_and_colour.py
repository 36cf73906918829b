"""D6: detections are categorised by type and carry the mean colour of their points."""

import colorsys

import numpy as np
import pytest
from kit.papers import STANDS, Handler, at_five_percent, can, colour, seen_as
from kit.tabletop import BLUE, CLEAR, GREEN, TABLE, TABLE_M, TYPES, seen_cloud

from skolem.sim.detector.cloud import Cloud
from skolem.sim.detector.detect import detect

SODA_HALF_M = 0.06
TWO_REDS = ((0.8, 0.08, 0.22), (0.8, 0.22, 0.08))  # hues .97 and .03: their mean is red, not cyan


@pytest.fixture(scope="module")
def cloud() -> Cloud:
    """A noisy cloud of a green soda and a blue carton on a table."""
    return seen_cloud(
        [TABLE, ("soda", (1.0, -0.2, TABLE_M, 0.0), GREEN), ("carton", (1.0, 0.2, TABLE_M, 0.3), BLUE)], CLEAR
    )


@pytest.mark.physics
def test_each_detection_is_most_like_the_type_it_is_of(cloud: Cloud) -> None:
    """ "Detections are categorized by type"."""
    found = sorted(detect(cloud, TYPES, CLEAR).detections, key=lambda seen: seen.base_T_object[1])
    likely = [max(seen.type_log_likelihood, key=lambda kind: seen.type_log_likelihood[kind]) for seen in found]
    assert likely == ["soda", "carton"]


@pytest.mark.physics
def test_the_colour_is_the_mean_over_the_points_of_the_detection(cloud: Cloud) -> None:
    """ "Computed as the mean of the colors of the points associated to the object by the detector." """
    x, y, z = cloud.points_base.T
    of_soda = (np.hypot(x - 1.0, y + 0.2) < SODA_HALF_M) & (z > TABLE_M + 0.01)
    left = of_soda & (y > -0.2)
    rgb = cloud.rgb.copy()
    rgb[of_soda], rgb[left] = TWO_REDS[0], TWO_REDS[1]
    painted = Cloud(cloud.points_base, rgb, cloud.at_border, cloud.under_nearer, cloud.pixel, cloud.camera_base)
    (soda,) = (seen for seen in detect(painted, TYPES, CLEAR).detections if seen.base_T_object[1] < 0.0)
    assert soda.rgb == pytest.approx(rgb[of_soda].mean(axis=0), abs=0.02)
    hue, _, _ = colorsys.rgb_to_hsv(*soda.rgb)
    assert min(hue, 1.0 - hue) < 0.03


def test_a_mean_at_the_end_of_the_hue_circle_is_believed_red() -> None:
    """ "Accompanied by a color observation": hue is a circle, whose ends are one colour."""
    red = colour("red")
    robot = Handler(at_five_percent([can()], colour_gain=1.0))
    for rgb in TWO_REDS:
        robot.see(seen_as(STANDS, rgb=rgb))
    assert robot.belief.prob_property("can1", red) > 0.9
