"""PyBullet, imported without a word on the standard streams: import `p` from here, where it is used."""

from skolem.sim.robot.assets import quiet_output

with quiet_output():
    import pybullet as p

__all__ = ["p"]
