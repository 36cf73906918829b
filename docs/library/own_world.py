"""A world of one's own: the one without physics, in a fog that leaves every second picture empty."""

import sys
from pathlib import Path

from skolem.sim import SymbolicWorld
from skolem.tools.loop import WorldKind, prepare, run, worlds


class Foggy(SymbolicWorld):
    def execute(self, action):
        """Return what joints and sensors say after an action."""
        result, observation = super().execute(action)
        fog = {"detections": (), "view": None} if action.step % 2 == 0 else {}
        return result, observation.model_copy(update=fog)


def build(start):
    at = (start.world_T_base, start.torso_m)
    return Foggy(start.types, start.bodies, *at, start.noise, start.seed, start.believed_noise)


foggy = WorldKind("foggy", build, worlds.SYMBOLIC.planner)

if __name__ == "__main__":
    scenario, trace = map(Path, sys.argv[1:])
    outcome = run(prepare(scenario, seed=0, world=foggy), trace)
    print(f"{outcome.end.status} after {outcome.actions} actions; true: {outcome.verdict.true}")
