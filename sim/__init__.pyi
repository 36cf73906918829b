from .physics.pybullet import PyBulletWorld as PyBulletWorld
from .planner.planner import PlanningWorld as PlanningWorld
from .scenario.scenario import load_scenario as load_scenario
from .symbolic.geometry import SymbolicGeometry as SymbolicGeometry
from .symbolic.world import SymbolicWorld as SymbolicWorld
