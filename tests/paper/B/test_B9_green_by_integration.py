"""B9: a colour word is integrated over the set of colours so called."""

import numpy as np
import pytest
from kit.papers import STANDS, Handler, at_five_percent, can, green, seen_as
from numpy.random import PCG64, Generator, SeedSequence

from skolem.traces.messages import HsvBelief

GAIN, SD_RGB = 0.83, 0.08


def believed(rgb: tuple[float, float, float]) -> tuple[HsvBelief, float]:
    """Return the prior of a can's colour, and what the belief says of green after one noisy look."""
    told = at_five_percent([can()], colour_sd_rgb=SD_RGB, colour_gain=GAIN)
    robot = Handler(told)
    robot.see(seen_as(STANDS, rgb=rgb))
    return told.colour, robot.belief.prob_property("can1", green())


@pytest.mark.parametrize("rgb", [(0.08, 0.64, 0.08), (0.3, 0.6, 0.1), (0.3, 0.42, 0.3), (0.1, 0.3, 0.25)])
def test_green_is_the_share_of_sampled_colours(rgb: tuple[float, float, float]) -> None:
    """ "Integrating the probability over the set of colors defined to be" green: prior colours, weighed by the look."""
    prior, said = believed(rgb)
    draws = Generator(PCG64(SeedSequence([7]))).normal(prior.mean, np.sqrt(prior.variance), size=(1_000_000, 3))
    draws = draws[((draws[:, 1:] >= 0.0) & (draws[:, 1:] <= 1.0)).all(axis=1)]
    h, s, v = draws[:, 0] % 1.0, draws[:, 1], draws[:, 2]
    k = (np.array([[5.0], [3.0], [1.0]]) + 6.0 * h) % 6.0
    seen = GAIN * (v - v * s * np.clip(np.minimum(k, 4.0 - k), 0.0, 1.0)).T
    weight = np.exp(-0.5 * ((seen - rgb) ** 2).sum(axis=1) / SD_RGB**2)
    hsv = np.column_stack([h, s, v])
    boxes = [np.array((box.hue, box.saturation, box.value)) for box in green().boxes]
    inside = np.any([((hsv >= box[:, 0]) & (hsv <= box[:, 1])).all(axis=1) for box in boxes], axis=0)
    assert said == pytest.approx(weight @ inside / weight.sum(), abs=0.01)
