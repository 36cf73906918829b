from .agent import Agent as Agent, Limits as Limits, Turn as Turn
from .language.expressions import Goal as Goal
from .language.parser import parse_goal as parse_goal
from .plain import Normal as Normal, PlainBelief as PlainBelief
from .planning.queries import load_rules as load_rules
from .protocols import BeliefQueries as BeliefQueries, Geometry as Geometry
