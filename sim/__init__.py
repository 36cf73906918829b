"""The simulated world: the only holder of the truth, and the robot's motion planning in a client of its own."""
