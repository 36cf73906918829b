"""Wall time by part, on a clock that is turned by hand."""

from skolem.tools.loop.stopwatch import Stopwatch


def test_a_part_inside_another_stops_the_other_meanwhile() -> None:
    now = [0.0]
    watch = Stopwatch(lambda: now[0])
    now[0] = 1.0
    with watch.part("reasoning"):
        now[0] = 3.0
        with watch.part("planning"):
            now[0] = 6.0
        now[0] = 7.0
    now[0] = 10.0
    with watch.part("planning"):
        now[0] = 10.5
    assert watch.seconds() == {"reasoning": 3.0, "planning": 3.5}
    assert watch.total() == 10.5
