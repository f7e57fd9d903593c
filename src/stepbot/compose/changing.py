"""The robot of a description with what a sidecar changes in it: names, and the values of its links, joints and devices.

A description is read as the sidecar that would give the same robot (:func:`.values_of`). The changes are merged into
this sidecar, which is checked like any other. Only what they set is taken from it; all else stays as the file has it.
"""

import json
from collections.abc import Collection, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from msgspec.structs import fields, replace

from stepbot.assemble.assets import MeshAssets
from stepbot.assemble.binder import Binder
from stepbot.assemble.claims import Claims
from stepbot.assemble.collisions import Collisions, PlacedComponent, without_contacts_of
from stepbot.assemble.devices import build_actuators, build_frames, build_sensors, tune_actuators
from stepbot.assemble.fitted_collisions import FittedCollisions, wait_for
from stepbot.assemble.frames import Frames
from stepbot.assemble.joints import build_joints, tree_order
from stepbot.assemble.links import is_complete, overruled
from stepbot.assemble.material_assignment import MaterialAssignment
from stepbot.assemble.measured_bodies import measured_bodies
from stepbot.diagnostics import Diagnostics, Span, did_you_mean
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.mesh_worker import MESH_WORKER
from stepbot.geometry.predicates import is_watertight
from stepbot.pictures.scene import mesh_of
from stepbot.robot.mesh_names import UniqueNames, free_name
from stepbot.robot.model import Collision, Geometry, Joint, JointDynamics, Limit, Link, MeshAsset, MeshRef, Robot
from stepbot.robot.renaming import renamed
from stepbot.runtime.worker import Worker
from stepbot.sidecar import tree
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.contact import surface_of
from stepbot.sidecar.load import parse_sidecar
from stepbot.sidecar.located import NO_MOTORS, OwnMotors, Sidecar
from stepbot.sidecar.robot_values import dynamics_values, limit_values, values_of
from stepbot.sidecar.tree import Tree, key_span, plain_data
from stepbot.step.assembly import ROOT_PATH, Assembly, Body, BodyKind, Component

from .pruning import elements

CHANGEABLE: Mapping[str, tuple[str, ...]] = {
    "links": ("inertial", "collision", "contact", "visual"),
    "joints": ("type", "axis", "axis2", "limits", "dynamics", "mimic", "zero", "pitch"),
    **dict.fromkeys(("joint_defaults", "frames", "actuators", "sensors", "motors", "excluded_contacts"), ()),
}
"""What a sidecar can change in a description: sections, and the keys of their elements; all keys without a list."""
_ADDED = ("frames", "actuators", "sensors")
"""Sections that can get new elements."""
_Numbers = TypeVar("_Numbers", Limit, JointDynamics)


def with_names(
    robot: Robot, names: Mapping[Any, Mapping[str, str]], module: str, sidecar: Sidecar, diagnostics: Diagnostics
) -> Robot:
    """The robot with the new names that a module gives, by section and former name; errors are reported."""
    by_section = elements(robot)
    for section, new in names.items():
        known = [one.name for one in by_section[section]]
        kind = section.removesuffix("s")
        for former, name in new.items():
            place = sidecar.key_span("modules", module, "rename", section, former)
            if former not in known:
                message = f"module '{module}': rename: no {kind} '{former}'"
                diagnostics.add("SB160", message, place, help=_near(former, known))
            elif (name in known and name not in new) or list(new.values()).count(name) > 1:
                message = f"module '{module}': rename: {kind} '{former}': duplicate name '{name}'"
                diagnostics.add("SB135", message, place, help=["choose another name"])
    diagnostics.raise_if_errors()

    def name_in(section: str) -> Any:
        return lambda name: names.get(section, {}).get(name, name)

    def of_shape(name: str) -> str:
        former = next((one for one in names.get("links", {}) if name.startswith(one)), "")
        return names["links"][former] + name.removeprefix(former) if former else name

    others = {section.removesuffix("s"): name_in(section) for section in by_section}
    return renamed(robot, **others, visual=of_shape, collision=of_shape)


def changed(
    robot: Robot,
    changes: Tree,
    path: Path,
    place: Span,
    *,
    limits: tuple[int | None, float],
    diagnostics: Diagnostics,
    motors: OwnMotors = NO_MOTORS,
) -> Robot:
    """The robot with changed values; errors are reported.

    Args:
        robot: The robot of a description.
        changes: The values, under the keys of a sidecar.
        limits: Memory [bytes] and time [s] of the process that fits collision shapes.
        diagnostics: Receives SB160 and whatever a sidecar with these values has.
        motors: The motors of the file that states the changes.
    """
    given = plain_data(changes)
    _reject(given, changes, diagnostics)
    diagnostics.raise_if_errors()
    local = Diagnostics()
    sidecar = sidecar_of(robot, changes, path, local, motors)
    if sidecar is not None:
        check_sidecar(sidecar, local)
    _report_new(robot, path, place, local, diagnostics)
    diagnostics.raise_if_errors()
    assert sidecar is not None  # otherwise there is an error
    return _Changing(robot, sidecar, given, diagnostics).robot(*limits)


def _reject(given: Any, changes: Tree, diagnostics: Diagnostics) -> None:
    """Report what a description cannot change."""

    def reject(keys: tuple[str, ...], of: str, known: Collection[str]) -> None:
        message = f"set: {of} a description, `set` can change {', '.join(f'`{one}`' for one in known)}"
        diagnostics.add("SB160", message, key_span(changes, keys), help=_near(keys[-1], known))

    for section, members in given.items():
        if section not in CHANGEABLE:
            reject((section,), "of", CHANGEABLE)
            continue
        for name, values in members.items() if CHANGEABLE[section] and isinstance(members, dict) else ():
            for key in values if isinstance(values, dict) else ():
                if key not in CHANGEABLE[section]:
                    reject((section, name, key), f"of a {section.removesuffix('s')} of", CHANGEABLE[section])


def _near(name: str, known: Collection[str]) -> tuple[str, ...]:
    listed = ", ".join(list(known)[:6])
    return did_you_mean(name, known) or ((f"known: {listed}",) if known else ())


def sidecar_of(
    robot: Robot, changes: Tree | None, path: Path, diagnostics: Diagnostics, motors: OwnMotors = NO_MOTORS
) -> Sidecar | None:
    """The sidecar of a robot of a description, with some changes; None after errors."""
    given = plain_data(changes) if changes is not None else {}

    def members(section: str) -> dict[str, Any]:
        named = given.get(section)
        return named if isinstance(named, dict) else {}

    kinds = {name: one["type"] for name, one in members("joints").items() if isinstance(one, dict) and "type" in one}
    values = values_of(robot, path.name, kinds)
    for section in _ADDED:
        values[section] |= {name: {} for name in members(section) if name not in values[section]}
    module = None if changes is None else tree.Mapping(changes.span, {"set": tree.Entry(changes.span, changes)}, 1, 1)
    return parse_sidecar(json.dumps(values), path, diagnostics, module=module, motors=motors)


def _report_new(robot: Robot, path: Path, place: Span, local: Diagnostics, diagnostics: Diagnostics) -> None:
    """Report what the changes cause; what the description alone has was reported when it was read."""
    old: set[tuple[str, str]] = set()
    if any(one.span.file == path.as_posix() for one in local):
        before = sidecar_of(robot, None, path, alone := Diagnostics())
        if before is not None:
            check_sidecar(before, alone)
        old = {(one.code, one.message) for one in alone}
    for one in local:
        if (one.code, one.message) not in old:
            diagnostics.extend([one._replace(span=place) if one.span.file == path.as_posix() else one])


class _Changing:
    """Builds what the changes set, and puts it into the robot."""

    def __init__(self, robot: Robot, sidecar: Sidecar, given: dict[str, Any], diagnostics: Diagnostics) -> None:
        self._robot, self._sidecar, self._given, self._diagnostics = robot, sidecar, given, diagnostics
        self._parts: dict[str, list[PlacedComponent]] = {}
        self._assembly = self._with_parts()
        owners = {part.index: link for link, parts in self._parts.items() for part in parts}
        self._claims = Claims(
            tuple(owners.get(component.index, "") for component in self._assembly.components), frozenset(), {}
        )

    def robot(self, memory_limit: int | None, timeout: float) -> Robot:
        """The changed robot."""
        binder = Binder(self._assembly, self._sidecar, self._diagnostics)
        root, order = tree_order(self._sidecar.document)
        frames = Frames(binder, self._claims, root)
        joints, named = build_joints(binder, frames, order), build_frames(binder, frames)
        sensors = build_sensors(binder, frames)
        self._diagnostics.raise_if_errors()
        assert joints is not None  # otherwise there is an error, as without the others
        assert named is not None
        assert sensors is not None
        built = {joint.name: joint for joint in joints}
        robot = replace(
            self._robot,
            joints=tuple(self._joint(joint, built[joint.name]) for joint in self._robot.joints),
            frames=_with_changed(self._robot.frames, named, self._of("frames")),
            actuators=_with_changed(self._robot.actuators, build_actuators(self._sidecar), self._of("actuators")),
            sensors=_with_changed(self._robot.sensors, sensors, self._of("sensors")),
        )
        robot = self._with_links(robot, binder, memory_limit, timeout)
        pairs = without_contacts_of(robot, self._sidecar, self._diagnostics).excluded_contacts
        robot = replace(robot, excluded_contacts=tuple(sorted({*self._robot.excluded_contacts, *pairs})))
        return tune_actuators(robot, self._sidecar, self._diagnostics) if self._of("actuators") else robot

    def _of(self, section: str) -> dict[str, Any]:
        named: dict[str, Any] = self._given.get(section) or {}
        return named

    def _joint(self, of_file: Joint, built: Joint) -> Joint:
        """A joint with what is set for it, by itself, by defaults or by its motor."""
        given = self._of("joints").get(of_file.name, {})
        is_same = built.kind is of_file.kind
        limit, dynamics = built.limit, built.dynamics
        if is_same:  # what a sidecar cannot express is not in what was built
            limit = _restored(of_file.limit, limit, limit_values(of_file.limit), given.get("limits"))
            dynamics = _restored(of_file.dynamics, dynamics, dynamics_values(of_file.dynamics), given.get("dynamics"))
        return replace(
            built,
            X_PC=of_file.X_PC,
            axis=built.axis if "axis" in given or not is_same else of_file.axis,
            axis2=built.axis2 if "axis2" in given or not is_same else of_file.axis2,
            limit=limit,
            dynamics=dynamics,
            mimic=built.mimic if "mimic" in given or not is_same else of_file.mimic,
            pitch=built.pitch if "pitch" in given or not is_same else of_file.pitch,
            drawn_position=built.drawn_position if "zero" in given or not is_same else of_file.drawn_position,
        )

    def _with_parts(self) -> Assembly:
        """The visuals of links that get other collision shapes, or else their collisions, as parts of an assembly."""
        components, bodies = [Component(0, -1, "", ROOT_PATH, "", "", 0)], list[Body]()
        for name, values in self._of("links").items():
            link = self._robot.link_by_name[name]
            self._parts[name] = []
            for shape in (link.visuals or link.collisions) if "collision" in values else ():
                mesh, number = mesh_of(shape.geometry, self._robot), len(components)
                plain = np.zeros(len(mesh.faces), np.int32)
                bodies.append(Body(BodyKind.TESSELLATED, mesh, plain, (), is_watertight(mesh.faces)))
                path = f"{name}_{number}"
                components.append(Component(number, 0, path, path, path, "", number, shape.X_LG, number - 1))
                self._parts[name].append(PlacedComponent(number, MaterialAssignment(), shape.X_LG))
        return Assembly(self._robot.source, "", "", "m", 1.0, tuple(components), tuple(bodies))

    def _with_links(self, robot: Robot, binder: Binder, memory_limit: int | None, timeout: float) -> Robot:
        if not self._of("links"):
            return robot
        bodies, assignments = self._assembly.bodies, [MaterialAssignment()] * len(self._assembly.components)
        with ExitStack() as running:
            process = running.enter_context(Worker(MESH_WORKER, memory_limit=memory_limit)) if bodies else None
            measures: Sequence[Any] = ()
            if process is not None:
                measures = process.submit("measures", tuple(body.mesh for body in bodies), more=True).result(timeout)
            measured = measured_bodies(self._assembly, measures, self._sidecar.document.mass)
            fitted = FittedCollisions(binder, self._claims, assignments, measured, None, process)
            wait_for(fitted, binder, timeout)
        self._diagnostics.raise_if_errors()
        assets = MeshAssets(self._assembly)
        collisions = Collisions(binder, assets, fitted)
        made = {name: collisions.of(name, self._parts[name]) for name in self._of("links")}
        collisions.report_flat()
        names = UniqueNames(asset.name for asset in robot.meshes)
        new = {asset.name: replace(asset, name=names.unique(asset.name)) for asset in assets.all()}
        taken = {shape.name for link in robot.links if link.name not in made for shape in link.collisions}
        links = tuple(
            self._link(link, made[link.name], new, taken) if link.name in made else link for link in robot.links
        )
        used = {shape.geometry for link in links for shape in link.shapes}
        meshes = (one for one in (*robot.meshes, *new.values()) if MeshRef(one.name) in used)
        return replace(robot, links=links, meshes=tuple(sorted(meshes, key=lambda mesh: mesh.name)))

    def _link(self, link: Link, made: Sequence[Collision], new: Mapping[str, MeshAsset], taken: set[str]) -> Link:
        given, section = self._of("links")[link.name], self._sidecar.document.links[link.name]
        collisions: Sequence[Collision] = link.collisions
        if "collision" in given:
            collisions = [replace(collision, geometry=_named(collision.geometry, new)) for collision in made]
        elif section.contact is not None:
            collisions = [replace(collision, surface=surface_of(section.contact)) for collision in collisions]
        return replace(
            link,
            mass_properties=self._mass(link, given),
            visuals=() if section.visual is False else link.visuals,
            collisions=tuple(
                replace(collision, name=free_name(collision.name, f"_{link.name}", taken)) for collision in collisions
            ),
        )

    def _mass(self, link: Link, given: Mapping[str, Any]) -> MassProperties:
        """Mass properties; a mass without an inertia scales that of the file."""
        inertial, of_file = self._sidecar.document.links[link.name].inertial, link.mass_properties
        if inertial is None or "inertial" not in given:
            return of_file
        if not is_complete(inertial):
            message = f"link '{link.name}': inertial: the description has no inertia that this mass could scale"
            place = self._sidecar.key_span("links", link.name, "inertial")
            self._diagnostics.add("SB503", message, place, help=("give `com` and `inertia` with `mass`",))
            return of_file
        if "inertia" in given["inertial"]:
            return overruled(of_file, inertial)
        scaled = of_file.scaled(inertial.mass / of_file.mass)
        return replace(scaled, mass=inertial.mass, com=inertial.com or of_file.com)


def _named(geometry: Geometry, new: Mapping[str, MeshAsset]) -> Geometry:
    return MeshRef(new[geometry.name].name) if isinstance(geometry, MeshRef) else geometry


def _with_changed(of_file: Sequence[Any], built: Sequence[Any], given: Collection[str]) -> tuple[Any, ...]:
    """The devices of a file, with those that are given in their place or, new ones, behind them."""
    made = {one.name: one for one in built if one.name in given}
    kept = [made.pop(one.name, one) for one in of_file]
    return (*kept, *made.values())


def _restored(of_file: _Numbers, built: _Numbers, stated: Mapping[str, float], given: object) -> _Numbers:
    """Numbers as built, but those of the file that a sidecar cannot state and that nothing sets."""
    if not (given is None or isinstance(given, dict)):
        return built
    unset = {field.name: field.default for field in fields(built)}
    lost = {
        name: getattr(of_file, name)
        for name, none in unset.items()
        if name not in stated and name not in (given or {}) and getattr(built, name) == none
    }
    return replace(built, **lost)
