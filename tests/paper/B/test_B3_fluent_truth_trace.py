"""B3: the truth of a belief fluent changes while the robot acts."""

from kit.papers import NINE, STANDS, Handler, at_five_percent, can, denotes, holds, seen_as

RED_RGB = (0.64, 0.08, 0.08)


def test_fluents_become_true_and_false_again_as_observations_come_in() -> None:
    """ "It is a fluent because during execution the underlying belief b will change." """
    robot = Handler(at_five_percent([can(soda=0.8)]))
    fluents = {
        "soda": f"b(type(can1,soda),{NINE})",
        "green": f"b(prop(green,can1),{NINE})",
        "on": f"b(on(can1,table1),{NINE})",
        "held": "held(right,can1)",
        "light": f"b(prop(light,can1),{NINE})",
    }
    trace = []

    def note() -> None:
        trace.append(" ".join(name for name, fluent in fluents.items() if holds(fluent, robot.belief)))

    note()
    robot.see(seen_as(STANDS))
    note()
    robot.see(seen_as(STANDS, kind="bottle"))
    note()
    robot.pick("can1")
    note()
    robot.weigh(0.1)
    note()
    robot.place("can1", "table1", (1.0, 0.1, 0.0))
    note()
    assert trace == ["on", "soda green on", "green on", "green held", "green held light", "green on light"]


def test_a_description_is_a_fluent_too() -> None:
    """ "And so will the truth value of the belief fluent." """
    robot = Handler(at_five_percent([can(soda=0.97)]))
    values = []
    for rgb in (RED_RGB, (0.08, 0.64, 0.08)):
        values.append(denotes("lambda x. Green(x)", robot.belief)["can1"])
        robot = Handler(at_five_percent([can(soda=0.97)]))
        robot.see(seen_as(STANDS, rgb=rgb))
        values.append(denotes("lambda x. Green(x)", robot.belief)["can1"])
    prior, red, _, green = values
    assert red < 1e-3 < prior < 0.9 < green
    assert holds(f"b(den(e1,can1),{NINE})", robot.belief)
