"""The benchmarks' own ground: the peers agree with the product where all should, and a page keeps its sections."""

import math
from pathlib import Path

import numpy as np
import pytest

from benchmarks import estimator_logs
from benchmarks.detector import reliability
from benchmarks.estimator_logs import Log, sighting, simulated
from benchmarks.estimator_peers import Ekf, Estimator, Ukf
from benchmarks.estimator_scores import Smoother, band, compared
from benchmarks.headings import least_turn
from benchmarks.tables import Table, Target, keep_only, write
from skolem.estimation.events import Looked
from skolem.traces.messages import ObjectType

OBJECTS, STEPS = 12, 8
# What is not linear grows with the product of two errors: a base that is 0.02 rad off bends what is 0.1 m off by 2 mm,
# beside the 10 mm to which a look shows a place. With a tenth of all errors that ratio is a tenth too, 0.02 sd for each
# look; over a few looks it stays within 0.1. The smoother passes no change below 1 mm on to variables that its last
# update did not touch, and its floor of 0.1 mm adds 2 % to the sd of a sighting, 0.5 mm.
TENTH, BEND_SDS, PASSED_ON, FLOOR = 0.1, 0.1, 1e-3, 0.05
SDS = ("MOVED_SDS", "CAMERA_SDS", "SIGHTED_SDS", "TOLD_SDS", "BASE_SDS")


def fed(log: Log) -> list[Estimator]:
    """Return the product's smoother and both filters after a log."""
    estimators: list[Estimator] = [Smoother(log.began), Ekf(log.began), Ukf(log.began)]
    for step in log.steps:
        for estimator in estimators:
            estimator.take(step.moved)
            estimator.take(step.looked)
    return estimators


@pytest.mark.parametrize("seed", range(3))
def test_filters_and_smoother_agree_where_all_is_nearly_linear(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in SDS:
        monkeypatch.setattr(estimator_logs, name, TENTH * getattr(estimator_logs, name))
    log = simulated(OBJECTS, STEPS, seed, float(estimator_logs.BASE_SDS[2]))
    seen = sorted({s.anchor for step in log.steps for s in step.looked.sightings})
    assert len(seen) > 1, "a log that shows nothing compares nothing"
    ours, *peers = ([e.base(), *(e.relative(anchor) for anchor in seen)] for e in fed(log))
    for theirs in peers:
        for (mean, covariance), (other, spread) in zip(ours, theirs, strict=True):
            sds = np.sqrt(np.diag(covariance))
            off = np.subtract(mean, other)
            off[2] = math.remainder(off[2], math.tau)
            assert (np.abs(off) < BEND_SDS * sds + PASSED_ON).all()
            assert np.sqrt(np.diag(spread)) == pytest.approx(sds, rel=FLOOR)


def test_filters_pass_over_what_was_not_told_of() -> None:
    log = simulated(OBJECTS, STEPS, 0)
    look = next(step.looked for step in log.steps if step.looked.sightings)
    stranger = sighting("stranger", (1.0, 0.0, 0.0), np.array([0.01, 0.01, 0.01]))
    for make in (Ekf, Ukf):
        plain, more = make(log.began), make(log.began)
        plain.take(look)
        more.take(Looked(camera_covariance=look.camera_covariance, sightings=(*look.sightings, stranger), missed=()))
        assert np.array_equal(plain.mean, more.mean)
        assert np.array_equal(plain.covariance, more.covariance)


def test_worse_is_farther_from_ideal_by_more_than_two_standard_errors() -> None:
    near, noise = np.full(50, 3.1), np.linspace(-0.1, 0.1, 50)
    assert compared("", near + 0.5 + noise, near, 3.0).is_worse
    assert not compared("", near + 0.5 + 40.0 * noise, near, 3.0).is_worse
    assert not compared("", near, near + 0.5 + noise, 3.0).is_worse


def test_band_holds_the_ideal_and_narrows_with_runs() -> None:
    few, many = band(5, 2), band(500, 2)
    assert few[0] < many[0] < 2.0 < many[1] < few[1]


def test_boxes_look_alike_after_half_a_turn_and_square_ones_after_a_quarter() -> None:
    oblong = ObjectType(shape="box", size_m=(0.06, 0.09, 0.14), graspable=True)
    square = oblong.model_copy(update={"size_m": (0.06, 0.06, 0.14)})
    assert least_turn(math.pi + 0.1, oblong) == pytest.approx(0.1)
    assert abs(least_turn(math.pi / 2.0, oblong)) == pytest.approx(math.pi / 2.0)
    assert least_turn(math.pi / 2.0 - 0.1, square) == pytest.approx(-0.1)


def test_reliability_counts_every_claim_once() -> None:
    claims = [(p, p > 0.6) for p in (0.2, 0.5, 0.6, 0.7, 0.95, 0.99, 1.0)]
    rows = reliability(claims)
    assert sum(n for _, _, n in rows) == len(claims)
    claimed, right, number = rows[-1]
    assert (claimed, right, number) == pytest.approx((0.995, 1.0, 2))


def table(title: str, cell: str) -> Table:
    return Table(title, "About it.", ("what",), [(cell,)], [Target("small", True, "3")], ["A note."])


def test_a_section_takes_the_place_of_its_own_and_leaves_others(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    for title in ("First: one", "Second", "Third"):
        write(table(title, f"old {title}"), page)
    write(table("Second", "new"), page)
    text = page.read_text(encoding="utf-8")
    assert [line for line in text.splitlines() if line.startswith("## ")] == ["## First: one", "## Second", "## Third"]
    assert "old First: one" in text
    assert "new" in text
    assert "old Second" not in text


def test_sections_that_are_no_more_go_and_the_rest_stays_as_it_was(tmp_path: Path) -> None:
    with_all, without = tmp_path / "all.md", tmp_path / "without.md"
    for title in ("First", "Second", "Third"):
        write(table(title, title), with_all)
    for title in ("First", "Third"):
        write(table(title, title), without)
    keep_only(["Third", "First"], with_all)
    assert with_all.read_bytes() == without.read_bytes()
