"""A belief of one's own: two cans, of which everything is known but whether they are green."""

from numpy import array, eye

from skolem.reasoner import Agent, Geometry, Limits, Normal, PlainBelief, load_rules, parse_goal
from skolem.traces.messages import LookAt

green = {"left": 0.6, "right": 0.3}  # P(it is green)


class Cans(PlainBelief):
    version = 0  # counts the changes

    def anchors(self):
        return tuple(green)

    def prob_property(self, anchor, meaning):
        return green[anchor]  # the goal asks for no other property

    def gaussian(self, quantity, anchor):
        return Normal(array([0.33, 0.9, 0.8]), 0.1 * eye(3))  # hue, saturation, value


class Here(Geometry):
    def ready(self, activity):
        return LookAt(pan=0.0, tilt=0.5)  # everything can be seen from here


rules, cans = load_rules(), Cans()
goal = parse_goal("exists o. B(Den(lambda x. Green(x), o), 0.9)", rules.vocabulary.words(), cans.anchors())
agent = Agent(goal, rules, cans, Here(), Limits())
for look in ({"left": 0.02}, {"right": 0.98}, {}):  # what the camera will show
    turn = agent.decide(cans.version)
    print(turn.action.op if turn.action else f"{turn.end.status}: {turn.end.anchor}, p = {turn.end.goal_probability}")
    green |= look
    cans.version += 1
