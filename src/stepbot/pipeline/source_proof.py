"""Comparison of converted files with the file that they came from, as engines read both.

The written files are compared with the model elsewhere; this finds what was misread on the way into the model.
"""

from collections.abc import Iterable, Set
from pathlib import Path
from tempfile import TemporaryDirectory

from msgspec.structs import replace

from stepbot.described.finding import LOST
from stepbot.described.robot import DescribedRobot
from stepbot.diagnostics import Diagnostics, Span
from stepbot.engines.description import Description
from stepbot.engines.description.mjcf_vocabulary import LED
from stepbot.engines.file_references import openable
from stepbot.engines.observation import Quantity
from stepbot.engines.source_copy import ChainNames
from stepbot.formats.mjcf import FORMAT as MJCF
from stepbot.formats.rendering import joined
from stepbot.report.robot import Report
from stepbot.robot.kinematics import MOVING
from stepbot.robot.model import Joint, JointKind, Robot
from stepbot.robot.multi_dof import ball_coordinates, steps_by_child, unfolded, universal_coordinates
from stepbot.robot.renaming import NewNames
from stepbot.runtime.output import write_atomically
from stepbot.runtime.temporary import run_folder
from stepbot.verification.source import NOT_CONFIRMED, Converted, verify_against_source

from .conversion import Options
from .writing import Rendered

_CHANGED = {
    "SB760:actuator-input": (Quantity.ACTUATORS,),
    "SB760:far-limit": (Quantity.JOINTS, Quantity.LIMITS),
    "SB760:flat-collision": (Quantity.MESHES, Quantity.SHAPES),
    "SB760:mixed-mimic": (Quantity.MIMIC,),
    "SB760:passive-limit": (Quantity.LIMITS,),
    "SB760:second-actuator": (Quantity.ACTUATORS,),
    "SB761:loop-zero": (
        Quantity.LIMITS,
        Quantity.DYNAMICS,
        Quantity.POSES,
        Quantity.MASS_MATRIX,
        Quantity.GRAVITY,
        Quantity.INVERSE_DYNAMICS,
        Quantity.MIMIC,
        Quantity.INITIAL,
    ),
    "SB761:mixed-surface": (Quantity.SHAPES,),
    "SB761:massless": (Quantity.MASS_MATRIX, Quantity.GRAVITY, Quantity.INVERSE_DYNAMICS),
    **{
        f"SB760:{kind}": (Quantity.SENSORS,)
        for kind in ("camera", "contact", "force-torque", "imu", "joint-sensor", "lidar")
    },
}
"""Quantities in which files differ from the source by what their format lacks: bounds of actuators, masses of
links that have none, contact properties of each shape, mimics between angles and distances, sensors, far stops, limits
without a motor, and positions of loops whose zero is moved."""
_COPIED = "stepbot.engines.source_copy:source_copy"


def compared_with_source(
    path: Path,
    description: Description,
    described: DescribedRobot,
    rendered: Rendered,
    report: Report,
    options: Options,
    diagnostics: Diagnostics,
) -> Report:
    """The report with the comparison of each written file with the description that it came from.

    Args:
        diagnostics: Receives SB8xx and SB9xx.
    """
    with TemporaryDirectory(dir=run_folder()) as folder:
        place = Path(folder) / (options.package or options.gazebo)  # where meshes are found by the name of the folder
        write_atomically(joined(rendered.by_format), place)
        files = {
            place / (file := next(iter(rendered.by_format[name]))): Converted(
                file, _given_names(rendered.robot, one), _lost_by(rendered.losses[name])
            )
            for name, one in rendered.lowered.items()
        }
        source, chains = path, _chains(description, described)
        if description.expanded:
            source = Path(folder) / "expanded.urdf"
            source.write_bytes(description.expanded)
        one_sided = any(len(limit.missing) == 1 for limit in description.open_limits)
        if (
            chains or one_sided or (options.package_path and description.observation.format != MJCF.name)
        ):  # which has no packages
            read, source = source, Path(folder) / f"source{source.suffix}"
            options.workers.call(_COPIED, str(openable(read)), str(source), options.package_path, chains)
        if chains:
            kinds = {joint.name: joint.kind for joint in description.observation.joints}
            joints = ", ".join(f"'{name}' ({kinds[name]})" for name, (several, _) in chains.items() if several[1:])
            text = f"joints {joints}: engines read the file with several single joints in place of each"
            if joints:
                diagnostics.add(NOT_CONFIRMED, text, Span(path.as_posix()))
        checks = verify_against_source(
            source,
            Span(path.as_posix()),
            files,
            _lost(described, description),
            described.names,
            described.pieces,
            described.of_robot,
            diagnostics,
            options.workers,
            options.package_path,
        )
    return replace(report, checks=(*report.checks, *checks))


def _given_names(robot: Robot, lowered: Robot) -> NewNames:
    """The model's names of the joints that a format needs other names for, and of their coordinates."""
    whole = {joint.child: (joint,) for joint in robot.joints}
    known = whole, steps_by_child(robot), _chains_in(unfolded(robot), robot.joints)
    changed = {}
    for child, chain in _chains_in(lowered, robot.joints).items():
        same = next((names[child] for names in known if len(names[child]) == len(chain)), None)
        if same is not None:
            changed.update({new.name: old.name for new, old in zip(chain, same, strict=True)})
    for coordinates in (ball_coordinates, universal_coordinates):
        given, needed = coordinates(robot), coordinates(lowered)
        for new in needed.keys() & changed.keys():
            changed.update(zip(needed[new], given[changed[new]], strict=True))
    return NewNames(joints={new: old for new, old in changed.items() if new != old})


def _chains_in(robot: Robot, joints: Iterable[Joint]) -> dict[str, tuple[Joint, ...]]:
    """For each link below one of the joints, those of a robot between the same two links, from the parent on."""
    above = {one.child: one for one in robot.joints}
    chains = {}
    for joint in joints:
        chain = [above[joint.child]]
        while chain[0].parent != joint.parent:
            chain.insert(0, above[chain[0].parent])
        chains[joint.child] = tuple(chain)
    return chains


def _chains(description: Description, described: DescribedRobot) -> dict[str, ChainNames]:
    """The joints of a URDF that engines do not read alike, and the names of the single joints that they become."""
    if description.observation.format != "urdf":
        return {}
    several = [joint for joint in described.robot.joints if joint.kind in (JointKind.PLANAR, JointKind.FLOATING)]
    steps = _chains_in(unfolded(described.robot), several)
    chains = {joint.name: steps[joint.child] for joint in several}
    old = {new: name for name, new in described.names.joints.items()}
    locked = {joint.name for joint in description.observation.joints if joint.kind in MOVING} & {
        old.get(joint.name, joint.name) for joint in described.robot.joints if joint.kind is JointKind.FIXED
    }
    return {name: ((name,), ()) for name in sorted(locked)} | {
        old.get(name, name): (tuple(one.name for one in chain), tuple(one.child for one in chain[:-1]))
        for name, chain in chains.items()
    }


def _lost_by(declared: Set[str]) -> dict[Quantity, str]:
    """Quantities that a format changes, by the codes of what it declares."""
    codes = sorted(declared & set(_CHANGED))
    return {quantity: f"a loss is declared ({code})" for code in codes for quantity in _CHANGED[code]}


def _lost(described: DescribedRobot, description: Description) -> dict[Quantity, str]:
    """Quantities that a declared loss changes."""
    seen = description.observation
    lost = {
        quantity: f"a loss is declared ({finding.code})"
        for finding in described.findings
        for quantity in finding.differs
    }
    if any(one.what.endswith(" in <geometry>") for one in description.lost):
        lost |= dict.fromkeys((Quantity.SHAPES, Quantity.MESHES), f"a loss is declared ({LOST})")
    if any(one.what == LED for one in description.lost):
        lost[Quantity.CLOSURES] = f"a loss is declared ({LOST})"
    if seen.gravity or any(link.gravity_compensation for link in seen.links):
        lost[Quantity.GRAVITY_SETTINGS] = f"a loss is declared ({LOST})"
    return lost
