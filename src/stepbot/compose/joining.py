"""The parts of a composed robot as one robot, with the joints, closures and devices between them."""

from collections.abc import Iterable, Mapping
from typing import TypeVar

import numpy as np
from msgspec.structs import replace

from stepbot.assemble.devices import (
    build_actuators,
    build_mesh_formats,
    build_metadata,
    build_simulation,
    build_versions,
    sensor_view,
    tune_actuators,
)
from stepbot.diagnostics import Diagnostics
from stepbot.geometry.spatial import IDENTITY, Pose, tidy
from stepbot.robot.kinematics import initial_configuration, link_poses
from stepbot.robot.mesh_files import share_meshes
from stepbot.robot.mesh_names import UniqueNames
from stepbot.robot.model import (
    Actuator,
    Base,
    Collision,
    Frame,
    Geometry,
    Joint,
    Link,
    LoopClosure,
    MeshAsset,
    MeshRef,
    Module,
    Robot,
    Visual,
)
from stepbot.robot.sensors import SEEING, Sensor, View
from stepbot.robot.simulation_settings import SHORT_TIMESTEP
from stepbot.robot.tuning import Simulation
from stepbot.sidecar.document import ClosureSection
from stepbot.sidecar.joint_settings import ONE_FREEDOM
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.own_part import TIE
from stepbot.sidecar.tree import ELEMENTS

from .parts import Part, Parts, coinciding, module_record
from .placing import Mount, Places
from .ports import Port, Ports, offset_of
from .pruning import elements

_Shape = TypeVar("_Shape", Visual, Collision)


def composed(
    sidecar: Sidecar, own: Robot | None, robots: Mapping[str, Robot], diagnostics: Diagnostics
) -> Robot | None:
    """The robot of a sidecar with modules; None after errors.

    Args:
        own: The robot of :func:`stepbot.sidecar.own_part.own_part`; None if it has no links.
        robots: The robot of each module that names a file, as it is alone.
        diagnostics: Receives SB135, SB152, SB154, SB158, SB160 and SB168.
    """
    parts = Parts(sidecar, robots, diagnostics).all()
    _report_equal_names(sidecar, parts, diagnostics)
    if diagnostics.has_errors:
        return None
    ports = Ports(sidecar, own, parts, diagnostics)
    places = Places(sidecar, own, parts, ports, diagnostics)
    root = places.find()
    if root is None:
        return None
    ports.attach(mount.joint for mount in places.mounts.values())
    robot = _Joining(sidecar, own, parts, ports, diagnostics).robot(root, places)
    return tune_actuators(robot, sidecar, diagnostics)


class _Joining:
    def __init__(
        self, sidecar: Sidecar, own: Robot | None, parts: Mapping[str, Part], ports: Ports, diagnostics: Diagnostics
    ) -> None:
        self._sidecar, self._own, self._parts, self._ports, self._diagnostics = sidecar, own, parts, ports, diagnostics
        self._document = sidecar.document
        self._robots = ([own] if own is not None else []) + [part.robot for part in parts.values()]

    def robot(self, root: str, places: Places) -> Robot:
        mounts = places.mounts
        joints = [joint for robot in self._robots for joint in robot.joints if not joint.name.startswith(TIE)]
        own = 0 if self._own is None else sum(1 for joint in joints if joint.name in self._own.joint_by_name)
        joints[own:own] = [mount.joint for mount in mounts.values()]
        links = {link.name: link for robot in self._robots for link in robot.links}
        ordered = in_tree_order(root, joints)
        if places.world:
            links[root] = Link(root)
        owner = next((part.robot for part in self._parts.values() if part.robot.root.name == root), self._own)
        whole = Robot(
            self._document.robot,
            tuple(links[name] for name in (root, *(joint.child for joint in ordered))),
            ordered,
            tuple(closure for robot in self._robots for closure in robot.closures),
            tuple(frame for robot in self._robots for frame in robot.frames),
            tuple(actuator for robot in self._robots for actuator in robot.actuators),
            (),
            Base.FIXED if places.world or owner is None else self._base(owner),
            self._source(),
            tuple(sensor for robot in self._robots for sensor in robot.sensors),
            excluded_contacts=self._excluded(),
            metadata=build_metadata(self._document),
            versions=build_versions(self._document),
            mesh_formats=build_mesh_formats(self._document),
            modules=tuple(record for name in self._parts for record in self._record(name, mounts)),
        )
        whole = self._with_own_devices(_with_meshes(whole, self._robots))
        for link, mount in mounts.items():
            whole = rebased(whole, link, mount.X_RC)
        whole = self._with_closed_loops(whole)
        return share_meshes(replace(whole, simulation=self._simulation(whole)))

    def _record(self, name: str, mounts: Mapping[str, Mount]) -> tuple[Module, ...]:
        part = self._parts[name]
        mount = mounts.get(part.robot.root.name)
        return module_record(name, part, "" if mount is None else mount.joint.parent)

    def _base(self, owner: Robot) -> Base:
        stated = "base" in self._document.model_fields_set or owner is self._own
        return self._document.base if stated else owner.base

    def _source(self) -> str:
        return self._own.source if self._own is not None else self._sidecar.path.name

    def _excluded(self) -> tuple[tuple[str, str], ...]:
        pairs = {pair for robot in self._robots for pair in robot.excluded_contacts}
        for index, stated in enumerate(self._document.excluded_contacts):
            ends = [self._ports.port(link, ("excluded_contacts", index, side)) for side, link in enumerate(stated)]
            if all(end is not None for end in ends):
                a, b = sorted(end.link for end in ends if end is not None)
                pairs.add((a, b))
        return tuple(sorted(pairs))

    def _simulation(self, robot: Robot) -> Simulation:
        """The settings of this file, else those that every module can be simulated with."""
        own = build_simulation(self._document)
        stated = {name: part.robot.simulation for name, part in self._parts.items()}
        integrators = {one.integrator: name for name, one in stated.items() if one.integrator is not None}
        if own.integrator is None and len(integrators) > 1:
            uses = ", ".join(f"{integrator} ('{name}')" for integrator, name in integrators.items())
            help = [f"choose one: `simulation: {{integrator: {next(iter(integrators))}}}`"]
            message = f"modules: different integrators: {uses}"
            self._diagnostics.add("SB154", message, self._sidecar.key_span("modules"), help=help)
        steps = [one.timestep for one in stated.values() if one.timestep is not None]
        constrained = bool(robot.closures) or any(joint.mimic is not None for joint in robot.joints)
        if steps and constrained and any(one.timestep is None for one in stated.values()):
            steps.append(SHORT_TIMESTEP)
        stiffnesses = [one.closure_stiffness for one in stated.values() if one.closure_stiffness is not None]
        return Simulation(
            own.timestep or min(steps, default=None),
            own.integrator or next(iter(integrators), None),
            own.closure_stiffness or min(stiffnesses, default=None),
        )

    def _with_own_devices(self, robot: Robot) -> Robot:
        """The robot with the closures, frames, actuators and sensors of this file that are on modules."""
        document = self._document
        there = elements(self._own) if self._own is not None else {}
        known = {section: {member.name for member in members} for section, members in there.items()}

        def new(section: str) -> list[str]:
            return [name for name in getattr(document, section) if name not in known.get(section, ())]

        closures = [self._closure(name, document.closures[name]) for name in new("closures")]
        frames = [self._frame(name) for name in new("frames")]
        actuators = [
            self._actuator(actuator, robot)
            for actuator in build_actuators(self._sidecar)
            if actuator.name in new("actuators")
        ]
        sensors = [self._sensor(name, robot) for name in new("sensors")]
        return replace(
            robot,
            closures=(*robot.closures, *_present(closures)),
            frames=(*robot.frames, *_present(frames)),
            actuators=(*robot.actuators, *_present(actuators)),
            sensors=(*robot.sensors, *_present(sensors)),
        )

    def _with_closed_loops(self, robot: Robot) -> Robot:
        """The robot with both frames of each closure between modules at one place, if the closure lets them turn."""
        own = self._own.closures if self._own is not None else ()
        new = set(self._document.closures) - {one.name for one in own}
        if not new:
            return robot
        X = link_poses(robot, initial_configuration(robot))
        closures = (
            coinciding(closure, X[closure.link_a].inverse() @ X[closure.link_b]) if closure.name in new else closure
            for closure in robot.closures
        )
        return replace(robot, closures=tuple(closures))

    def _closure(self, name: str, section: ClosureSection) -> LoopClosure | None:
        a, b = (self._ports.port(getattr(section, side), ("closures", name, side)) for side in ("link_a", "link_b"))
        if a is None or b is None:
            return None
        offset = offset_of(section.origin)
        if offset is None:
            message = f"closure '{name}': origin: its links are not in one assembly"
            help = ["leave out `origin`: the ports coincide; `frames` can add a port"]
            self._diagnostics.add("SB154", message, self._sidecar.span("closures", name, "origin"), help=help)
            offset = IDENTITY
        X_AF, X_BF = tidy(a.X_LP @ offset), tidy(b.X_LP @ offset)
        return LoopClosure(name, section.type, a.link, X_AF, b.link, X_BF, section.axis)

    def _frame(self, name: str) -> Frame | None:
        port = self._ports.port(name, ("frames", name))
        return None if port is None else Frame(name, port.link, tidy(port.X_LP))

    def _actuator(self, actuator: Actuator, robot: Robot) -> Actuator | None:
        keys = ("actuators", actuator.name)
        joint = self._ports.joint(actuator.joint, (*keys, "joint"))
        if joint is None:
            return None
        driven, who = robot.joint_by_name[joint], f"actuator '{actuator.name}': joint '{actuator.joint}'"
        span = self._sidecar.span(*keys, "joint")
        if driven.kind not in ONE_FREEDOM:
            help = [f"types that can be actuated: {', '.join(ONE_FREEDOM)}"]
            self._diagnostics.add("SB459", f"{who} of type {driven.kind} cannot be actuated", span, help=help)
        elif driven.mimic is not None:
            leader = self._ports.path(driven.mimic.joint)
            message = f"{who} mimics joint '{leader}' and cannot be actuated"
            self._diagnostics.add("SB459", message, span, help=[f"use joint '{leader}' instead"])
        for first in robot.actuators:
            if (first.joint, first.kind) == (joint, actuator.kind):
                message = f"{who}: duplicate {actuator.kind} actuator (the module's own is '{first.name}')"
                help = [f"remove it, or leave the other out: `without: [{first.name}]`, by its name in its own file"]
                self._diagnostics.add("SB459", message, span, help=help)
        return replace(actuator, joint=joint)

    def _sensor(self, name: str, robot: Robot) -> Sensor | None:
        section, keys = self._document.sensors[name], ("sensors", name)
        joint, port = "", Port("")
        if section.joint is not None:
            written = self._ports.joint(section.joint, (*keys, "joint"))
            if written is None:
                return None
            joint, port = written, Port(robot.joint_by_name[written].child)
        elif section.link is not None:
            placed = self._ports.placed(section.link, section.origin, keys)
            if placed is None:
                return None
            port = placed
        view = sensor_view(section) if section.type in SEEING else View()
        return Sensor(name, section.type, port.link, tidy(port.X_LP), joint, section.rate, view)


_Item = TypeVar("_Item")


def _present(items: Iterable[_Item | None]) -> list[_Item]:
    return [item for item in items if item is not None]


def in_tree_order(root: str, joints: Iterable[Joint]) -> tuple[Joint, ...]:
    """The joints with each parent before its children, otherwise in the given order."""
    placed, ordered, waiting = {root}, [], list(joints)
    while waiting:
        left = []
        for joint in waiting:
            if joint.parent in placed:
                placed.add(joint.child)
                ordered.append(joint)
            else:
                left.append(joint)
        if len(left) == len(waiting):
            raise ValueError(f"joint '{left[0].name}' is not below '{root}'")
        waiting = left
    return tuple(ordered)


def rebased(robot: Robot, link: str, X_LN: Pose) -> Robot:
    """The same robot with another frame of one link; its joint above is not moved, since it is about the new frame.

    Args:
        X_LN: The new frame in the old one.
    """
    if X_LN.is_identity:
        return robot
    X_NL = X_LN.inverse()

    def moved(pose: Pose) -> Pose:
        return tidy(X_NL @ pose)

    links = tuple(
        replace(
            one,
            mass_properties=one.mass_properties.moved(X_NL),
            visuals=tuple(replace(shape, X_LG=moved(shape.X_LG)) for shape in one.visuals),
            collisions=tuple(replace(shape, X_LG=moved(shape.X_LG)) for shape in one.collisions),
        )
        if one.name == link
        else one
        for one in robot.links
    )
    return replace(
        robot,
        links=links,
        joints=tuple(
            replace(joint, X_PC=moved(joint.X_PC)) if joint.parent == link else joint for joint in robot.joints
        ),
        closures=tuple(
            replace(
                closure,
                X_AF=moved(closure.X_AF) if closure.link_a == link else closure.X_AF,
                X_BF=moved(closure.X_BF) if closure.link_b == link else closure.X_BF,
            )
            for closure in robot.closures
        ),
        frames=tuple(replace(frame, X_LF=moved(frame.X_LF)) if frame.link == link else frame for frame in robot.frames),
        sensors=tuple(
            replace(sensor, X_LS=moved(sensor.X_LS)) if sensor.link == link and not sensor.joint else sensor
            for sensor in robot.sensors
        ),
    )


def _with_meshes(whole: Robot, robots: Iterable[Robot]) -> Robot:
    """The robot with the meshes of its parts; those of one name with different content are numbered."""
    names, by_name, made = UniqueNames(), dict[str, list[MeshAsset]](), list[MeshAsset]()
    new: dict[str, dict[Geometry, Geometry]] = {}
    for robot in robots:
        renamed: dict[Geometry, Geometry] = {}
        for asset in robot.meshes:
            same = next((one for one in by_name.get(asset.name, []) if _equal(one, asset)), None)
            if same is None:
                same = replace(asset, name=names.unique(asset.name))
                by_name.setdefault(asset.name, []).append(same)
                made.append(same)
            if same.name != asset.name:
                renamed[MeshRef(asset.name)] = MeshRef(same.name)
        new |= {link.name: renamed for link in robot.links if renamed}

    def shapes(link: str, ones: tuple[_Shape, ...]) -> tuple[_Shape, ...]:
        return tuple(replace(shape, geometry=new[link].get(shape.geometry, shape.geometry)) for shape in ones)

    links = tuple(
        replace(one, visuals=shapes(one.name, one.visuals), collisions=shapes(one.name, one.collisions))
        if one.name in new
        else one
        for one in whole.links
    )
    return replace(whole, links=links, meshes=tuple(sorted(made, key=lambda asset: asset.name)))


def _equal(a: MeshAsset, b: MeshAsset) -> bool:
    same = a.mesh is b.mesh or np.array_equal(a.mesh.vertices, b.mesh.vertices)
    return same and np.array_equal(a.mesh.faces, b.mesh.faces)


def _report_equal_names(sidecar: Sidecar, parts: Mapping[str, Part], diagnostics: Diagnostics) -> None:
    """Report SB135: two elements with one name in the composed robot."""
    document = sidecar.document
    first: dict[tuple[str, str], tuple[str, str]] = {}
    for section in ELEMENTS:
        for name in getattr(document, section):
            first.setdefault((_group(section), name), (section.removesuffix("s"), ""))
    for module, part in parts.items():
        equal = []
        for section, members in elements(part.robot).items():
            for element in members:
                kind = section.removesuffix("s")
                other_kind, other = first.setdefault((_group(section), element.name), (kind, module))
                if other != module:
                    equal.append((f"{kind} '{element.name}'", other_kind, other, element.name))
        if equal:
            what, other_kind, other, name = equal[0]
            whose = f"of module '{other}'" if other else "here"
            more = f" and {len(equal) - 1} more names" if len(equal) > 1 else ""
            message = f"module '{module}': {what}: duplicate name (also a {other_kind} {whose}){more}"
            keys = ("modules", other, "prefix") if other else (f"{other_kind}s", name)
            notes = [f"the other at {sidecar.key_span(*keys)}"]
            help = ["remove `prefix`, or choose another one" if part.prefix == "" else "choose another `prefix`"]
            diagnostics.add("SB135", message, sidecar.span("modules", module, "prefix"), help=help, notes=notes)


def _group(section: str) -> str:
    """Frames become links in URDF, and closures become joints in SDFormat."""
    return {"frames": "links", "closures": "joints"}.get(section, section)
