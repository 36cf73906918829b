"""PyBullet, imported without output on the standard streams; users import `p` from here."""

from skolem.sim.robot.assets import quiet_output

with quiet_output():
    import pybullet as p

__all__ = ["p"]
