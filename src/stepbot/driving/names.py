"""Names of the drive tests and of the engines that run them; imports nothing heavy, for the command line's help."""

from collections.abc import Mapping

TESTS: Mapping[str, str] = {
    "hold": "random poses are held",
    "step": "each motor steps to a new target",
    "sweep": "each motor visits both ends of its range",
    "torque": "random efforts up to the limits",
    "drop": "falls on the floor, or limp if the base is fixed",
    "grip": "holds a cube",
    "roll": "drives straight ahead and back",
    "strafe": "drives to the left and back",
    "stand": "stands, and is pushed",
}
"""All tests, in the order in which they run, and what the robot does."""
ENGINES: Mapping[str, str] = {"mujoco": "mjcf", "pybullet": "urdf"}
"""The engines that drive, and the format that each drives."""
