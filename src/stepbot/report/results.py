"""Verification results as data: checks, one row per format and engine.

The records hold plain values, so that cached results can be displayed without loading numpy.
"""

from collections.abc import Mapping
from enum import StrEnum

from msgspec import Struct, field

from stepbot.robot.joint_table import JointRow
from stepbot.robot.motors import Motor


class Status(StrEnum):
    """The outcome of a check."""

    PASSED = "passed"
    FAILED = "failed"
    NOT_RUN = "not run"


class Check(Struct, frozen=True):
    """One quantity, compared in one file as reported by one engine."""

    file: str
    """File name; empty for a check of the robot itself."""
    format: str
    engine: str
    quantity: str
    status: Status
    deviation: float | None = None
    """The largest deviation; None if the quantity has no number or nothing was compared."""
    tolerance: float | None = None
    """The tolerance there."""
    unit: str = ""
    where: str = ""
    """Link, joint, configuration of the worst deviation."""
    why: str = ""
    """Why it failed, did not run, or covers less than its name."""
    against: str = "model"
    """What the file was compared with: the model, or another file and engine."""

    @property
    def ratio(self) -> float:
        """Deviation as a multiple of the tolerance; negative if there is no number."""
        if self.deviation is None or not self.tolerance:
            return -1.0
        return self.deviation / self.tolerance


class Row(Struct, frozen=True):
    """All checks of one file and engine, for one row of a table."""

    file: str
    format: str
    engine: str
    status: Status
    """Failed if one check failed, passed if at least one passed and none failed, else not run."""
    compared: tuple[str, ...]
    """Quantities that were compared, in the order of the report."""
    worst: Check | None
    """The check with the largest deviation relative to its tolerance."""
    why: str
    """What failed, or what did not run and why."""
    against: str


class Content(StrEnum):
    """What a written file is for."""

    ROBOT = "robot"
    """The robot in its format."""
    VARIANT = "variant"
    """A file for readers that need more than the format's main file, or another one."""
    SCENE = "scene"
    """The robot with floor and light, to be opened in a simulator."""


class WrittenFile(Struct, frozen=True):
    """A file of a robot, meshes and reports aside."""

    path: str
    """Relative to the output folder."""
    format: str
    content: Content


class SimplifiedVisuals(Struct, frozen=True):
    """Visual meshes that were simplified to meet a budget."""

    link: str
    """Empty for the budget of the robot."""
    before: int
    """Number of triangles, each mesh as often as it is drawn."""
    after: int
    deviation: float
    """The largest distance [m] between a mesh and its simplified form."""
    max_triangles: int | None = None
    """The budget, if it is one of triangles."""
    max_bytes: int | None = None
    """The budget, if it is one of the files."""


class LinkCollision(Struct, frozen=True):
    """The collision shapes of a link, and how well they match its solids."""

    link: str
    rule: str
    """``auto``, ``hull``, ``merged box``; ``given`` for a list in the sidecar."""
    shapes: Mapping[str, int]
    """Number of boxes, cylinders, spheres, capsules, hulls, meshes."""
    vertices: int
    """Of all hulls and meshes."""
    most_vertices: int
    """Of one hull or mesh."""
    iou: float | None
    """Volume of the intersection with the solids / volume of the union; None without closed solids."""
    overshoot: float | None
    """Largest distance [m] of a point of the shapes from the solids; None without closed solids."""


class Results(Struct, frozen=True):
    """The verification results, and what else a command prints about a conversion."""

    checks: tuple[Check, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)
    """Engines that ran, and their versions."""
    degrees_of_freedom: int | None = None
    """Residuals of loops and mimics in the drawn pose."""
    driven: tuple[str, ...] = ()
    """Independent joints, if there are loops."""
    collisions: tuple[tuple[str, str, float | None], ...] = ()
    """Pairs of links that overlap in the drawn pose, and the penetration depth [m]; None between two surfaces."""
    notes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Changes and additions that an engine needed to check a file, by file and engine."""
    files: tuple[WrittenFile, ...] = ()
    """The files that were written, in the order of their formats."""
    variant: str = ""
    """Variant of the sidecar; empty for none."""
    inputs: Mapping[str, str] = field(default_factory=dict)
    """SHA-256 of each STEP file that was read, by its path relative to the folder of the first one."""
    names: Mapping[str, str] = field(default_factory=dict)
    """Names in the files, and the original names in the STEP."""
    masses: Mapping[str, float] = field(default_factory=dict)
    """Mass [kg] of each link of a converted robot."""
    collision_shapes: tuple[LinkCollision, ...] = ()
    """Of each link that has any."""
    simplified_visuals: tuple[SimplifiedVisuals, ...] = ()
    """What was simplified to meet triangle budgets."""
    joint_table: tuple[JointRow, ...] = ()
    """The pose of each joint, for review; for compared files, of the first one."""
    own_parsers: tuple[str, ...] = ()
    """Names of stepbot's own parsers among the engines, which confirm only the text of a file."""
    motors: Mapping[str, Motor] = field(default_factory=dict)
    """The motor of each actuator that has one, by the actuator's name."""
    distributions: Mapping[str, str] = field(default_factory=dict)
    """The installed distribution that each engine that ran comes from: `pybullet-arm64`."""

    @property
    def failed(self) -> bool:
        """Whether any check failed."""
        return any(check.status is Status.FAILED for check in self.checks)

    @property
    def read_back(self) -> tuple[Check, ...]:
        """The checks that passed in stepbot's own parsers only, not in an engine."""
        return tuple(
            check for check in self.checks if check.status is Status.PASSED and check.engine in self.own_parsers
        )

    def rows(self) -> tuple[Row, ...]:
        """One row for each file and engine, in the order of the checks."""
        keys = dict.fromkeys((check.file, check.engine, check.against) for check in self.checks)
        return tuple(
            _row([check for check in self.checks if (check.file, check.engine, check.against) == key]) for key in keys
        )


def _row(checks: list[Check]) -> Row:
    by_status = {status: [check for check in checks if check.status is status] for status in Status}
    failed, passed, not_run = by_status[Status.FAILED], by_status[Status.PASSED], by_status[Status.NOT_RUN]
    status = Status.FAILED if failed else Status.PASSED if passed else Status.NOT_RUN
    first = checks[0]
    measured = [check for check in failed or passed if check.ratio >= 0.0]
    return Row(
        first.file,
        first.format,
        first.engine,
        status,
        tuple(check.quantity for check in checks if check.status is not Status.NOT_RUN),
        max(measured, key=lambda check: check.ratio, default=None),
        "; ".join(f"{check.quantity}: {check.why or check.where}" for check in failed) or _reasons(not_run),
        first.against,
    )


def _reasons(not_run: list[Check]) -> str:
    """Each reason once, with the quantities that it applies to."""
    grouped: dict[str, list[str]] = {}
    for check in not_run:
        grouped.setdefault(check.why, []).append(check.quantity)
    return "; ".join(f"{', '.join(quantities)} not run: {why}" for why, quantities in grouped.items())
