"""A stage for the reasoner: every action succeeds, and the play states the results of looks and weighings."""

from collections.abc import Callable, Iterator

from kit.minds import Region, TableBelief, TableGeometry, Thing

from skolem.reasoner.agent import Agent, Turn
from skolem.reasoner.language.parser import parse_goal
from skolem.reasoner.rulebook.book import Rulebook
from skolem.traces.messages import Limits

LIMITS = Limits(steps=60, expansions=2000, hierarchy_depth=16, min_plan_probability=1e-4)
RED, GREEN, BLUE = 0.99, 0.33, 0.63


class Play:
    """An agent in a world in which every action succeeds.

    Attributes:
        hues: Hue of an object after a look.
        log_kg: Weight of an object after a weighing, ln(kg).
        found: New objects, by anchor, after a look at a region.
        shows_type: Function from an anchor to its type belief after a look.
        fails: Operators that change nothing.
    """

    def __init__(
        self,
        rulebook: Rulebook,
        goal: str,
        things: dict[str, Thing],
        hues: dict[str, float] | None = None,
        log_kg: dict[str, float] | None = None,
        limits: Limits = LIMITS,
        regions: dict[str, Region] | None = None,
        found: dict[str, dict[str, Thing]] | None = None,
        shows_type: Callable[[str], dict[str, float]] = lambda _: {"soda": 0.997, "bottle": 0.003},
    ) -> None:
        self.belief = TableBelief(things, regions)
        self.found = found or {}
        self.shows_type = shows_type
        self.fails: set[str] = set()
        self.geometry = TableGeometry()
        self.hues = hues or {}
        self.log_kg = log_kg or {}
        names = frozenset(things)
        self.agent = Agent(
            parse_goal(goal, rulebook.vocabulary.words(), names), rulebook, self.belief, self.geometry, limits
        )
        self.turns: list[Turn] = []

    def turns_to_the_end(self) -> Iterator[Turn]:
        for step in range(200):
            turn = self.agent.decide(step)
            self.turns.append(turn)
            yield turn
            if turn.end is not None:
                return
            self.carry_out(turn)
        raise AssertionError("the agent never ended")

    def run(self) -> list[str]:
        """Carry out all actions, and return their operators."""
        return [turn.action.op for turn in self.turns_to_the_end() if turn.action is not None]

    def carry_out(self, turn: Turn) -> None:
        assert turn.action is not None
        command = turn.action.command
        if turn.action.op in self.fails:
            self.belief.changed()
            return
        if turn.action.op.startswith("LookAtRegion"):
            region = turn.action.args[0]
            self.belief.spaces[region].seen = 0.95
            self.belief.things |= self.found.get(region, {})
            self.belief.changed()
            return
        if command.kind == "move_base":
            self.geometry.drive(self.geometry.asked[-1].removeprefix("approach "))
            for thing in self.belief.things.values():
                thing.pose_sd = max(thing.pose_sd, 0.03)
            self.belief.changed()
            return
        obj = self.belief.things[turn.action.args[0]]
        match command.kind:
            case "look_at":
                for seen in (obj, *([self.belief.things[obj.on]] if obj.on else [])):
                    seen.pose_sd = 0.004
                if "table" not in obj.types:
                    obj.types = self.shows_type(turn.action.args[0])
                if turn.action.args[0] in self.hues:
                    obj.hsv, obj.hsv_sd = (self.hues[turn.action.args[0]], 0.9, 0.8), 0.01
            case "pick":
                obj.hand, obj.on = command.hand, None
            case "place":
                obj.hand, obj.on, obj.pose_sd = None, turn.action.args[1], 0.01
                moved = turn.action.args[0]
                blocked = self.geometry.in_the_way.items()
                self.geometry.in_the_way = {a: tuple(x for x in xs if x != moved) for a, xs in blocked}
            case "weigh":
                obj.ln_kg = (self.log_kg[turn.action.args[0]], 0.05)
        self.belief.changed()
