"""The interface of a simulation that is driven: an engine with a robot's file, and what a test adds around the robot.

The file is loaded as it is. A floor, a cube and a weld that holds a floating base belong to the scene of a test.
Positions are in [rad] or [m] by coordinate, as in :mod:`stepbot.robot.kinematics`.
"""

from collections.abc import Mapping
from typing import Any, Protocol

from msgspec import Struct

from stepbot.geometry.spatial import Array, Pose
from stepbot.robot import dynamics
from stepbot.robot.model import ActuatorKind, Limit, Mimic, Robot

DOWN = (0.0, 0.0, -1.0)
"""Direction of gravity."""
GRAVITY = -dynamics.GRAVITY[2]
"""Acceleration [m/s^2] downwards in every test."""
FRICTION = 1.0
"""Friction coefficient between the robot and the scene of a test: MuJoCo's default for two geoms."""
SHAPES = ("cube", "cylinder", "sphere")
"""What can be gripped."""
HEIGHT = 1.0
"""Height [m] of the root link of a robot that is held in the air."""


class Motor(Struct, frozen=True):
    """An actuator, with the limits that apply at its joint."""

    name: str
    joint: str
    kind: ActuatorKind
    kp: float
    kv: float
    gear: float
    limit: Limit
    """Narrower of the limits of joint and actuator."""
    angular: bool
    computed: bool = False
    """Whether its gains are computed, for a bandwidth that is not below the default."""
    braked: bool = False
    """Whether its effort limit needs more damping than its gains would have."""


class Mechanism(Struct, frozen=True, eq=False):
    """A robot as its simulations need it."""

    robot: Robot
    """Without shapes."""
    motors: tuple[Motor, ...]
    home: Mapping[str, float]
    """Initial position of every coordinate; closes the loops."""
    balls: Mapping[str, tuple[str, str, str]]
    """Names of the coordinates of each ball joint."""
    mimics: Mapping[str, Mimic]
    constraints: tuple[Mapping[str, Any], ...]
    """The list ``robot.pybullet`` of ``report.json``."""
    stiff: frozenset[str] = frozenset()
    """Joints whose damping diverges in an engine that integrates it explicitly and has no armature."""


class Cube(Struct, frozen=True):
    """A cube to grip, or the sphere or upright cylinder inside of it."""

    edge: float
    """[m]"""
    mass: float
    """[kg]"""
    shape: str = "cube"
    """One of :data:`SHAPES`; the axis of a cylinder is the cube's z axis, which points away from the hand."""

    def __str__(self) -> str:
        return f"{self.shape} of {1e3 * self.edge:.0f} mm"


class Setup(Struct, frozen=True):
    """What surrounds the robot."""

    floor: bool = False
    """A horizontal plane at z = 0."""
    held: bool = False
    """Whether a floating base is held in the air."""
    fine: bool = False
    """Whether energy is measured: an engine whose step is not the file's takes a short one."""
    cube: Cube | None = None
    """Without weight until :meth:`Simulation.let_go`."""


class Simulation(Protocol):
    """A robot in an engine, in the scene of one test."""

    timestep: float
    """[s]"""
    seconds: float
    """Time [s] spent in the engine's steps, by the clock."""
    steps: int

    def reset(self, q: Mapping[str, float], X_WR: Pose | None = None) -> None:
        """Place the robot at rest, motors off.

        Args:
            q: Positions of all coordinates.
            X_WR: Pose of the root link if its base floats; None for its pose in the file.
        """

    def command(self, targets: Mapping[str, float]) -> None:
        """Switch the motors on, each with its target: position [rad], [m] or speed [rad/s], [m/s], at the joint."""

    def release(self) -> None:
        """Switch all motors off."""

    def apply(self, efforts: Mapping[str, float]) -> None:
        """Apply efforts [N m] or [N] to joints until the next call, motors off; none beyond the limit of speed."""

    def push(self, force_W: Array) -> None:
        """Push the root link's centre of mass with a force (3,) [N] until the next call."""

    def step(self) -> None:
        """Simulate one step."""

    def positions(self) -> dict[str, float]:
        """Position of every coordinate with one degree of freedom."""

    def speeds(self) -> dict[str, float]:
        """Speed of the same coordinates."""

    def effort(self, joint: str) -> float:
        """Effort [N m] or [N] of the motor of a joint in the last step."""

    def pose(self, link: str) -> Pose:
        """Pose of a link in the world."""

    def lowest(self) -> float:
        """Height [m] of the lowest point of the collision shapes."""

    def energy(self) -> tuple[float, float]:
        """Potential and kinetic energy [J]."""

    def penetration(self) -> float:
        """Largest depth [m] of a contact; 0 without contact."""

    def standing(self) -> Mapping[str, Array]:
        """The links that touch the floor, each with the middle (3,) [m] of the places where it does."""

    def place_cube(self, X_WC: Pose) -> None:
        """Place the cube at rest, without weight."""

    def fix_cube(self, link: str) -> None:
        """Fix the cube to a link where it is, until :meth:`free_cube`."""

    def free_cube(self) -> None:
        """Let the cube move."""

    def let_go(self, down: Array) -> None:
        """Give the cube its weight, in a direction (3,) in the world."""

    def cube(self) -> Pose:
        """Pose of the cube in the world."""

    def finite(self) -> bool:
        """Whether all positions and speeds are finite, and the engine reports no divergence."""

    def close(self) -> None:
        """End the simulation."""
