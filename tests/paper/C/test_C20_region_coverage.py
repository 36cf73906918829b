"""C20: regions are a spatial structure of their own, of which some is seen and some is not."""

from kit.papers import at_five_percent, can
from kit.searches import BACK, FRONT, LEFT, REGION, RIGHT, TOP, Point, Searcher, table_prior, thing as known

SCREEN = (1.1, 0.0, TOP, 0.0)


def behind_a_screen() -> Searcher:
    """A robot that knows of a screen across the middle of its table."""
    return Searcher(table_prior(objects=[known("screen1", "screen", SCREEN)]), [("screen", SCREEN)])


def test_regions_have_anchors_and_are_not_objects() -> None:
    """ "An index into a separate spatial data structure with internal anchor _reg2_." """
    belief = Searcher(at_five_percent([can()])).belief
    assert belief.regions() == (REGION,)
    assert REGION not in belief.anchors()
    assert belief.region_support(REGION) == "table1"
    assert set(belief.snapshot(0).regions) == {REGION}


def test_contents_rise_by_what_a_look_really_shows() -> None:
    """ "Regions of space that have not previously been explored." """
    free, screened = Searcher(table_prior()), behind_a_screen()
    for robot in (free, screened):
        assert robot.belief.prob_contents(REGION) == 0.0
        robot.look(FRONT)
    hidden = free.belief.prob_contents(REGION) - screened.belief.prob_contents(REGION)
    assert hidden > 0.1  # behind the screen
    screened.look(BACK)
    assert screened.belief.prob_contents(REGION) > 0.95


def test_contents_never_fall_and_looking_again_from_the_same_place_shows_nothing_new() -> None:
    """ "If we come to know its contents." """
    robot = behind_a_screen()
    seen = [0.0]
    looks: list[Point] = [FRONT, FRONT, LEFT, FRONT, RIGHT, BACK, FRONT]
    for eye in looks:
        robot.look(eye)
        seen.append(robot.belief.prob_contents(REGION))
    assert seen == sorted(seen)
    assert seen[1] == seen[2]
    assert seen[-1] > 0.95


def test_the_unseen_points_lie_behind_the_screen() -> None:
    """ "Substantial occlusion": what is hidden is not counted as seen."""
    robot = behind_a_screen()
    robot.look(FRONT)
    points = robot.belief.snapshot(0).regions[REGION].unseen_mm
    assert points
    low = [point for point in points if point[2] < 200 and abs(point[1]) < 200]
    assert all(point[0] > 0 for point in low)  # beyond the screen, as seen from the front
