"""``convert --for menagerie``: the folder that a robot has in MuJoCo Menagerie, ready for its checks.

The README has the provenance of the robot's numbers. It has no result of a verification, which depends on the engines
that are installed, so that the same input gives the same README.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from math import isfinite
from urllib.parse import quote

from msgspec.structs import asdict

from stepbot.formats.learning import MENAGERIE
from stepbot.formats.mjcf.menagerie import menagerie_files
from stepbot.pictures.picture import Sheet, draw, png_bytes
from stepbot.pictures.scene import robot_subject
from stepbot.report.results import Results
from stepbot.report.words import evidence_words, mass_words
from stepbot.robot.joint_table import Basis
from stepbot.robot.kinematics import initial_configuration
from stepbot.robot.model import ActuatorKind, JointKind, Link, Robot
from stepbot.robot.simulation_settings import settings_of
from stepbot.version import __version__

_SHEET = Sheet(640, 480, samples=2)
_FROM_CAD = (
    "Computed masses, centres of mass and inertias from the solids and the densities below.",
    "Placed each joint where the table below states: on the axis of the faces that meet there, or as given.",
)


def menagerie_folder(robot: Robot, written: Mapping[str, bytes], results: Results) -> dict[str, bytes]:
    """All files, by path relative to the output folder.

    Args:
        robot: The robot as MJCF expresses it.
        written: The files of MJCF, by path relative to the output folder, the main one first.
        results: The joint table, and the hashes of what was read.
    """
    files = menagerie_files(robot, written)
    files["README.md"] = _readme(robot, results).encode()
    if _has_visuals(robot):
        picture = draw(robot_subject(robot, initial_configuration(robot)), _SHEET)
        files[f"{robot.name}.png"] = png_bytes(picture.pixels)
    return {f"{MENAGERIE}/{robot.name}/{path}": content for path, content in files.items()}


def _readme(robot: Robot, results: Results) -> str:
    metadata, settings = robot.metadata, settings_of(robot)
    from_file = all(row.evidence.basis is Basis.FILE for row in results.joint_table)
    stated = "the source" if from_file else "the sidecar"
    about = f": {metadata.description}" if metadata.description else ""
    shown = f'<p float="left">\n  <img src="{quote(f"{robot.name}.png")}" width="400">\n</p>\n'
    steps = [
        f"Converted {f'`{robot.source}`' if robot.source else 'its modules'} with stepbot {__version__}, which read:\n"
        + "\n".join(f"   - `{path}`, SHA-256 `{digest}`" for path, digest in results.inputs.items()),
        *([] if from_file else _FROM_CAD),
        "Added the collision geometries, and excluded contacts of links that a joint connects or that always overlap.",
        f"Set the time step to {settings.timestep:g} s, and the integrator to `{settings.integrator.value}`.",
        "Added `scene.xml`, which includes the robot, with a floor, light, sky and a camera.",
    ]
    masses = ((link.name, mass_words(link.mass_properties.mass), _origin(link) or stated) for link in robot.links)
    lines = [
        f"# {robot.name} Description (MJCF)\n",
        f"Requires MuJoCo {robot.versions.mjcf} or later.\n",
        "## Overview\n",
        f"This package contains a robot description (MJCF) of {robot.name}{about}.\n",
        *([shown] if _has_visuals(robot) else []),
        f"## {'Source' if from_file else 'CAD'} → MJCF derivation steps\n",
        *(f"{number}. {step}" for number, step in enumerate(steps, 1)),
        "\n## Provenance of the numbers\n",
        *_table(("link", "mass", "from"), masses),
        *_table(("joint", "type", "origin and axis from", f"limits, from {stated}"), _joints(robot, results, stated)),
        *_table(("actuator", "number", "from"), _actuators(robot, stated)),
        f"Other numbers of joints, contacts and sensors are from {stated}, or else defaults of stepbot.\n",
    ]
    if metadata.license:
        lines += ["## License\n", f"This model is released under the [{metadata.license}](LICENSE) license.\n"]
    return "\n".join(lines)


def _has_visuals(robot: Robot) -> bool:
    return any(link.visuals for link in robot.links)


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> list[str]:
    """A table in Markdown; nothing without rows."""
    body = [f"| {' | '.join(' '.join(cell.split()).replace('|', '&#124;') for cell in row)} |" for row in rows]
    return [f"| {' | '.join(head)} |", f"| {' | '.join('---' for _ in head)} |", *body, ""] if body else []


def _origin(link: Link) -> str:
    """What the mass of a link is from, each source once; empty if it was not computed from parts."""
    counts: Counter[str] = Counter()
    for one in link.masses:
        words = "given" if one.density is None else f"{one.density:g} kg/m³"
        surface = "" if one.method == "given" else f", {one.method.partition(':')[0]} volume"
        counts[f"{words} ({one.origin}){surface}"] += 1
    return "; ".join(f"{n} x {words}" if n > 1 else words for words, n in counts.items())


def _joints(robot: Robot, results: Results, stated: str) -> Iterator[tuple[str, ...]]:
    rows = {row.name: row for row in results.joint_table}
    for joint in robot.joints:
        if joint.kind is not JointKind.FIXED:
            words = evidence_words(rows[joint.name].evidence) if joint.name in rows else ""
            limits = (f"{name} {value:.6g}" for name, value in asdict(joint.limit).items() if isfinite(value))
            yield joint.name, joint.kind.value, words or stated, ", ".join(limits)
    for row in results.joint_table:
        if row.is_closure:
            yield row.name, f"{row.kind}, closes a loop", evidence_words(row.evidence) or stated, ""


def _actuators(robot: Robot, stated: str) -> Iterator[tuple[str, ...]]:
    for actuator in robot.actuators:
        tuning = actuator.tuning
        if actuator.kind is not ActuatorKind.MOTOR:
            unit = "kg" if robot.joint_by_name[actuator.joint].kind.slides else "kg m²"
            inertia = "" if tuning is None else f"{tuning.bandwidth:g} Hz with {tuning.inertia:.4g} {unit}"
            gains = (
                f"kp {actuator.kp:g}, kv {actuator.kv:g}"
                if actuator.kind is ActuatorKind.POSITION
                else f"kv {actuator.kv:g}"
            )
            yield actuator.name, gains, f"computed: {inertia} at the joint" if inertia else stated
        for figure in () if actuator.motor is None else actuator.motor.figures:
            motor = f"{actuator.motor.name}: {figure.source}" if actuator.motor is not None else ""
            yield actuator.name, f"{figure.quantity} {figure.value:.6g} {figure.unit}", motor
