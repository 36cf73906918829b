"""Goals posed of beliefs in a few objects on two tables, drawn by hypothesis."""

import math

from hypothesis import strategies as st
from kit.minds import Region, TableBelief, TableGeometry, Thing
from kit.papers import EXAMPLE_GOAL, posed

from skolem.reasoner.planning.goals import PosedGoal

ONE_WORD = "exists o. B(Den(lambda x. Soda(x), o), 0.9)"


@st.composite
def scenes(draw: st.DrawFn, most: int = 4, fine: bool = False) -> PosedGoal:
    """Draw a goal posed of a belief in some objects on two tables.

    One object may be in a hand, and one in the way of another. Probabilities are round ones or, if `fine`, any from .88
    on.
    """
    share = st.integers(880, 999).map(lambda k: k / 1000) if fine else st.sampled_from([0.05, 0.3, 0.6, 0.9, 0.99])
    things = {name: Thing({"table": 1.0}, pose_sd=draw(st.sampled_from([0.004, 0.03]))) for name in ("desk", "side")}
    movable = [f"o{k + 1}" for k in range(draw(st.integers(1, most)))]
    for name in movable:
        soda = draw(share)
        things[name] = Thing(
            {"soda": soda, "bottle": 1.0 - soda},
            on=draw(st.sampled_from(["desk", "side"])),
            hsv=(draw(st.sampled_from([0.2, 0.33, 0.6])), 0.8, 0.8),
            hsv_sd=draw(st.sampled_from([0.01, 0.05, 0.2])),
            ln_kg=(math.log(draw(st.sampled_from([0.1, 0.3, 0.5]))), draw(st.sampled_from([0.05, 0.6]))),
            pose_sd=draw(st.sampled_from([0.004, 0.03, 0.08])),
            exists=draw(share if fine else st.sampled_from([0.6, 0.97, 1.0])),
        )
    if draw(st.booleans()):
        held = things[draw(st.sampled_from(movable))]
        held.on, held.hand = None, draw(st.sampled_from(["right", "left"]))
    regions = {f"_reg{k}_": Region("side", draw(st.floats(0.1, 3.0))) for k in range(draw(st.integers(0, 2)))}
    geometry = TableGeometry()
    if len(movable) > 1 and draw(st.booleans()):
        geometry.in_the_way = {f"pick({hand}, o1)": ("o2",) for hand in ("right", "left")}
    geometry.at = set(draw(st.sampled_from([[], ["look(o1)"], ["pick(right, o1)", "look(o1)"]])))
    goal = draw(st.sampled_from([EXAMPLE_GOAL, ONE_WORD])) if fine else EXAMPLE_GOAL
    return posed(goal, TableBelief(things, regions), geometry=geometry)
