"""The robot of a sidecar with modules: each file that it names, directly or through others, is read once."""

from collections.abc import Mapping as MappingType
from fnmatch import fnmatchcase
from pathlib import Path

from msgspec import Struct
from msgspec.structs import replace

from stepbot.assemble.devices import place_of
from stepbot.compose.changing import changed, with_names
from stepbot.compose.interfaces import report_interfaces
from stepbot.compose.joining import composed
from stepbot.compose.parts import joints_above
from stepbot.diagnostics import Diagnostic, Diagnostics, Span, StepbotError, cut, did_you_mean
from stepbot.report.robot import Check
from stepbot.revisions import lock_path
from stepbot.robot.joint_table import JointRow
from stepbot.robot.loop_followers import loop_followers
from stepbot.robot.model import Cylinder, MeshRef, Robot
from stepbot.robot.step_names import is_step_name
from stepbot.robot.validity import check_robot
from stepbot.runtime.cache import file_digest, files_digest
from stepbot.runtime.file import is_file, is_folder, resolved
from stepbot.runtime.robot_library import LIBRARY, library_robots, library_sidecar
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.load import parse_sidecar
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.modules import ModuleSection
from stepbot.sidecar.own_part import own_part, with_defaults_of
from stepbot.sidecar.shapes import is_for_mjx
from stepbot.sidecar.starter import one_link_starter
from stepbot.sidecar.tree import Mapping, child, way
from stepbot.sidecar.variants import merged
from stepbot.verification.joint_rows import joint_rows_of
from stepbot.verification.judging import MOST_NOTES, Subject, check_of
from stepbot.verification.modules import ModuleAlone, in_initial_pose, in_model

from .building import built_of, places
from .conversion import Options, is_description
from .expectations import check_expected
from .sidecars import SIDECAR_SUFFIXES, load, named_step

DEEPEST = 8
"""Most modules within modules."""
MOST = 256
"""Most modules of one robot, those of modules included."""
_OPEN_BASE = "SB874:base"
"""A description does not say whether its base is fixed; what it is attached to decides."""
_NO_DENSITY = "SB522"
_UNPORTABLE = "SB129"
_INTERSECT = "stepbot.geometry.solids.overlapping:overlaps_of"
_GAINS = "SB874:gains"
"""Computed gains of a description's actuators, which the whole robot computes again."""


class ComposedRobot(Struct, frozen=True, eq=False):
    """A composed robot, and the files that it was made from."""

    robot: Robot
    files: tuple[Path, ...]
    """The sidecar first, then every other file, in the order of reading."""
    sought: tuple[Path, ...]
    """The same, and the lock files that do not exist."""
    content: str
    """Hash of all of them; empty if one changed while it was read."""
    modules: tuple[ModuleAlone, ...]
    """Its modules, each with its robot alone."""
    checks: tuple[Check, ...]
    """The comparison of each module with the module alone."""

    @property
    def joint_table(self) -> tuple[JointRow, ...]:
        """Where each joint is, with all joints at 0."""
        return joint_rows_of(self.robot)


def compose(sidecar: Sidecar, options: Options, diagnostics: Diagnostics) -> ComposedRobot:
    """Read all modules of a sidecar and compose its robot.

    Args:
        sidecar: A sidecar with modules, without errors of its own.
        diagnostics: Receives the diagnostics; those of a module once, at their own places.

    Raises:
        StepbotError: There are errors.
    """
    files = _Files(options)
    robot = files.composed(sidecar, (sidecar.path,), diagnostics)
    _report_gains(sidecar, robot, diagnostics)
    if not diagnostics.has_errors:
        check_expected(sidecar, robot, lambda path: _components(robot, path), diagnostics)
    read = tuple(path for path, digest in files.read.items() if digest is not None)
    is_unchanged = all(file_digest(path) == digest for path, digest in files.read.items())
    content = files_digest(files.read) if is_unchanged else ""
    return ComposedRobot(robot, read, tuple(files.read), content, tuple(files.alone), tuple(files.checks))


def _report_gains(sidecar: Sidecar, robot: Robot, diagnostics: Diagnostics) -> None:
    """Report the gains that the whole robot computes for actuators without any in their description."""
    for actuator in (one for one in robot.actuators if one.tuning is not None and one.tuning.assumed):
        from .translating import computed_gains

        diagnostics.add(_GAINS, computed_gains(actuator), place_of(actuator, robot, sidecar))


def _places(sidecar: Sidecar, robot: Robot) -> dict[str, Span]:
    """The places of the robot's elements in the composing file; those of a module are where that is named."""
    of_link = {link: module.name for module in reversed(robot.modules) for link in module.links}
    spans = {name: sidecar.key_span("modules", name) for name in sidecar.document.modules}
    of_modules = {f"link '{link}'": spans[name] for link, name in of_link.items()}
    of_modules |= {
        f"joint '{joint.name}'": spans[of_link[joint.child]] for joint in robot.joints if joint.child in of_link
    }
    return of_modules | places(sidecar)


def _components(robot: Robot, path: str) -> list[str]:
    """Paths of the components that match a glob, in any module."""
    return [one.component for link in robot.links for one in link.masses if fnmatchcase(one.component, path)]


class _Files:
    """Makes the robot of each file once."""

    def __init__(self, options: Options) -> None:
        self._options = options
        self._robots: dict[tuple[Path, str, str], Robot | None] = {}
        self._modules = 0
        self.read: dict[Path, str | None] = {}
        """Hash of each file before it was read."""
        self.alone: list[ModuleAlone] = []
        self.checks: list[Check] = []

    def _note(self, *paths: Path) -> None:
        for path in paths:
            self.read.setdefault(path, file_digest(path))

    def composed(self, sidecar: Sidecar, chain: tuple[Path, ...], diagnostics: Diagnostics) -> Robot:
        """The composed robot of a sidecar; ``chain`` are the files that lead to it, itself last."""
        self._note(sidecar.path, lock_path(sidecar.path))
        robots = {}
        for name, section in sidecar.document.modules.items():
            self._modules += 1
            self._check_count(sidecar, name, chain, diagnostics)
            if section.file is not None:
                robot = self._module(sidecar, name, section, chain, diagnostics)
                if robot is not None:
                    robots[name] = robot
        diagnostics.raise_if_errors()
        own = self._own(sidecar, self._options.step if len(chain) == 1 else None, diagnostics)
        robot = composed(sidecar, own, robots, diagnostics)
        diagnostics.raise_if_errors()
        assert robot is not None  # a missing robot always has an error
        report_interfaces(sidecar, robot, lambda search: self._options.workers.call(_INTERSECT, search), diagnostics)
        self.alone = _modules_alone(sidecar, robot, robots)
        self.checks = _compared(sidecar, robot, self.alone, diagnostics)  # last those of the file that composes all
        check_robot(robot, diagnostics, sidecar.span(), massless_between=True, places=lambda: _places(sidecar, robot))
        diagnostics.raise_if_errors()
        return robot

    def _check_count(self, sidecar: Sidecar, name: str, chain: tuple[Path, ...], diagnostics: Diagnostics) -> None:
        what = f"more than {MOST} modules" if self._modules > MOST else ""
        if len(chain) > DEEPEST:
            what = f"more than {DEEPEST} modules within modules"
        if what:
            diagnostics.add("SB150", f"module '{name}': {what}", sidecar.key_span("modules", name))
            diagnostics.raise_if_errors()

    def _own(self, sidecar: Sidecar, step: Path | None, diagnostics: Diagnostics) -> Robot | None:
        """The robot of the links that the sidecar describes itself, with their STEP if it is not the one it names."""
        if not sidecar.document.links:
            return None
        own = own_part(sidecar)
        if not own.document.step:
            return self._without_step(own, diagnostics)
        return self._from_step(own, step or named_step(own, diagnostics), diagnostics)

    def _without_step(self, own: Sidecar, diagnostics: Diagnostics) -> Robot | None:
        """Own links without an assembly: their mass properties and poses are given."""
        from stepbot.assemble import build_robot
        from stepbot.step.assembly import ROOT_PATH, Assembly, Component

        nothing = Assembly("", "", "", "m", 1.0, (Component(0, -1, "", ROOT_PATH, "", "", 0),), ())
        built = build_robot(nothing, own, lambda: (), diagnostics, self._options.cache)
        diagnostics.raise_if_errors()
        return None if built is None else built.robot

    def _from_step(self, sidecar: Sidecar, step: Path, diagnostics: Diagnostics) -> Robot:
        self._note(step)
        built, assembly = built_of(sidecar, step, self._options, diagnostics)
        self._note(*(step.parent / name for name in assembly.external_files))
        return built.robot

    def _module(
        self, sidecar: Sidecar, name: str, section: ModuleSection, chain: tuple[Path, ...], diagnostics: Diagnostics
    ) -> Robot | None:
        file, span = section.file or "", sidecar.span("modules", name, "file")
        path = library_sidecar(file) if file.startswith(LIBRARY) else sidecar.path.parent / file
        what, help = _unreadable(path, file)
        if path is None or what:
            diagnostics.add("SB150", f"module '{name}': {what}", span, help=help)
            return None
        if resolved(path) in [resolved(one) for one in chain]:
            ring = " -> ".join(one.name for one in (*chain, path))
            message = f"module '{name}': '{file}' contains itself: {ring}"
            diagnostics.add("SB150", message, span, help=["remove one of the modules"])
            return None
        document = sidecar.document
        changes = section.rename, section.set, sidecar.own_motors, is_for_mjx(document.defaults.collision)
        key = (resolved(path), section.variant or "", repr(changes))
        if key not in self._robots:
            local = Diagnostics()
            is_placed = bool(section.at or joints_above(document, name)) or "base" in document.model_fields_set
            try:
                self._robots[key] = self._robot(path, _Changes(sidecar, name), chain, local)
            except StepbotError as error:
                if error.diagnostics is not local:
                    local.extend(error.diagnostics)
                self._robots[key] = None
            note = f"module '{name}' of {span}"
            density = "write the density of its material: `set: {defaults: {density: 2700 kg/m^3}}`"
            folder = path.parent.as_posix() if file.startswith(LIBRARY) else ""
            new_names = [former for names in section.rename.values() for former in names]
            for one in local:
                is_settled = one.code == _GAINS or (
                    one.code == _UNPORTABLE
                    and (one.message.startswith("robot ") or any(f"'{name}'" in one.message for name in new_names))
                )
                if not is_settled and (one.code != _OPEN_BASE or not is_placed):
                    place, help = one.span, one.help
                    if one.code == _OPEN_BASE:
                        help = (f"`base: fixed` or `base: floating` in {sidecar.path.name}",)
                    if folder and place.file.startswith(folder):  # the same text on every machine
                        place = place._replace(file=LIBRARY + place.file.removeprefix(folder).removeprefix("/"))
                    if one.code == _NO_DENSITY and is_step_name(path.name):  # there is no sidecar to write it into
                        place, help = span, (density,)
                    diagnostics.add(one.code, one.message, place, help=help, notes=(*one.notes, note))
            diagnostics.add_ignored(local.ignored)
        return self._robots[key]

    def _robot(self, path: Path, changes: "_Changes", chain: tuple[Path, ...], diagnostics: Diagnostics) -> Robot:
        self._note(path)
        changes.reject_unfit(path, diagnostics)
        if is_step_name(path.name):
            return self._from_step(changes.inherited(changes.of_step(path, diagnostics)), path, diagnostics)
        if is_description(path):
            from .translating import robot_of_file

            robot, files = robot_of_file(path, self._options, diagnostics, changes.links_with_inertia)
            self._note(*files)
            return changes.of_description(robot, path, self._options, diagnostics)
        self._note(lock_path(path, changes.variant))
        options = self._options._replace(ignore=(), step=None, variant=changes.variant)
        sidecar = changes.inherited(load(path, options, diagnostics, module=changes.section, motors=changes.motors))
        if sidecar.document.modules:
            return self.composed(sidecar, (*chain, path), diagnostics)
        return self._from_step(sidecar, named_step(sidecar, diagnostics), diagnostics)


def _modules_alone(sidecar: Sidecar, robot: Robot, alone: MappingType[str, Robot]) -> list[ModuleAlone]:
    """The modules of a composed robot, each with its robot alone."""
    sections = sidecar.document.modules
    followers = loop_followers(robot) if sidecar.document.closures else ()
    led = {follower.joint for follower in followers}
    modules = []
    for module in robot.modules:  # a module of a module was compared where that was composed
        if module.name in sections:
            section = sections[module.name]
            original = alone[section.mirror_of or module.name]
            flips = _flips(original, section, sections)
            inside = frozenset(joint.name for joint in original.joints if module.prefix + joint.name in led)
            modules.append(ModuleAlone(module, in_initial_pose(original, robot, module.prefix, flips), flips, inside))
    return modules


def _compared(sidecar: Sidecar, robot: Robot, modules: list[ModuleAlone], diagnostics: Diagnostics) -> list[Check]:
    """Compare each module with its robot alone; report SB803 if they differ."""
    checks: list[Check] = []
    wrong: dict[str, list[str]] = {}
    for one, compared in in_model(robot, modules):
        checks.append(check_of(Subject("", "", "stepbot", one.against), compared))
        faults = [f"{compared.quantity.value}: {fault}" for fault in compared.deviations.failures]
        if faults:
            wrong.setdefault(one.module.name, []).extend(faults)
    for module in (one.module for one in modules if one.module.name in wrong):
        first, *others = wrong[module.name]
        message = f"module '{module.name}': differs from '{module.file}' alone: {first}"
        place = sidecar.key_span("modules", module.name)
        wrong_module = Diagnostic("SB803", "error", message, place, notes=tuple(cut(others, MOST_NOTES)))
        diagnostics.extend([wrong_module.after("convert")])
    return checks


def _flips(alone: Robot, section: ModuleSection, sections: MappingType[str, ModuleSection]) -> frozenset[str]:
    """Joints whose positive direction a module reverses: the image of a flipped joint is flipped, or back again."""
    original = sections[section.mirror_of].flip if section.mirror_of else ()

    def matching(patterns: tuple[str, ...]) -> set[str]:
        names = (joint.name for joint in alone.joints)
        return {name for name in names if any(fnmatchcase(name, pattern) for pattern in patterns)}

    return frozenset(matching(section.flip) ^ matching(original))


def _unreadable(path: Path | None, file: str) -> tuple[str, tuple[str, ...]]:
    """Why the file of a module cannot be one, with help; empty if it can."""
    if path is None:
        named = file.removeprefix(LIBRARY)
        near = did_you_mean(
            named.strip(), [name for robot in library_robots() for name in (robot.short_name, robot.name)]
        )
        return f"no robot '{named}' in the library", (*near, "`stepbot library list` names them")
    if is_folder(path):
        return f"file '{file}' is a folder", ("name the sidecar, URDF, SDFormat, MJCF or STEP in it",)
    if not is_file(path):
        if file.casefold().startswith(LIBRARY):
            return f"file '{file}' not found", (f"of a robot of the library, write '{LIBRARY}' in small letters",)
        if file.startswith("library/"):
            return f"file '{file}' not found", (f"of a robot of the library, write '{LIBRARY}{path.name}'",)
        if "\\" in file and is_file(path.parent / file.replace("\\", "/")):
            return f"file '{file}' not found", (f"write `/`: {file.replace(chr(92), '/')}",)
        beside = sorted(one.name for one in path.parent.iterdir()) if is_folder(path.parent) else []
        return f"file '{file}' not found", (*did_you_mean(path.name, beside), "`file` is relative to this sidecar")
    if not (path.suffix.lower() in SIDECAR_SUFFIXES or is_description(path) or is_step_name(path.name)):
        types = "a sidecar (.yaml), URDF (.urdf), SDFormat (.sdf), MJCF (.xml) or STEP (.step)"
        return f"file '{file}': unsupported type of file", (f"a module is {types}",)
    return "", ()


class _Changes:
    """What a composing file changes in the file of a module, by `variant` and `set`.

    Args:
        sidecar: The composing file.
        module: The module.
    """

    def __init__(self, sidecar: Sidecar, module: str) -> None:
        self._sidecar, self._module, self.motors = sidecar, module, sidecar.own_motors
        self.variant = sidecar.document.modules[module].variant or ""
        self.section = way(sidecar.root, ("modules", module))[-1]
        """The module, with the places of its values."""
        self.tree = child(self.section, "set") if sidecar.document.modules[module].set else None
        """The values to change."""

    @property
    def links_with_inertia(self) -> list[str]:
        """Links that get a mass and an inertia, by their names in the file."""
        section = self._sidecar.document.modules[self._module]
        former = {new: old for old, new in section.rename.get("links", {}).items()}
        links = section.set.get("links")
        given = {name: one for name, one in links.items() if isinstance(one, dict)} if isinstance(links, dict) else {}
        whole = [name for name, one in given.items() if "inertia" in (one.get("inertial") or ())]
        return [former.get(name, name) for name in whole]

    def inherited(self, module: Sidecar) -> Sidecar:
        """The module's sidecar with the defaults that hold for modules."""
        return with_defaults_of(self._sidecar.document, module)

    def of_step(self, step: Path, diagnostics: Diagnostics) -> Sidecar:
        """The sidecar of a STEP file without one: all of its parts are one link."""
        made = parse_sidecar(one_link_starter(step), step, diagnostics, module=self.section, motors=self.motors)
        if made is not None:
            check_sidecar(made, diagnostics)
        diagnostics.raise_if_errors()
        assert made is not None
        nothing = Mapping(Span(step.as_posix()), {}, 1, 1)
        return replace(made, root=nothing if self.tree is None else merged(nothing, self.tree))

    def of_description(self, robot: Robot, path: Path, options: Options, diagnostics: Diagnostics) -> Robot:
        """The robot of a URDF, SDFormat or MJCF with its new names and changed values."""
        section = self._sidecar.document.modules[self._module]
        robot = with_names(robot, section.rename, self._module, self._sidecar, diagnostics)
        kinds = {type(collision.geometry) for link in robot.links for collision in link.collisions}
        if kinds & {Cylinder, MeshRef} and is_for_mjx(self._sidecar.document.defaults.collision):
            message = f"`for: mjx` has no effect on module '{self._module}': '{path.name}' has shapes for other engines"
            diagnostics.add("SB608", message, self._sidecar.span("defaults", "collision"))
        if self.tree is None:
            return robot
        place = self._sidecar.key_span("modules", self._module, "set")
        limits = (options.memory_limit, options.timeout)
        return changed(robot, self.tree, path, place, limits=limits, diagnostics=diagnostics, motors=self.motors)

    def reject_unfit(self, path: Path, diagnostics: Diagnostics) -> None:
        """Report changes that a file of its kind cannot have."""
        module = self._sidecar.document.modules[self._module]
        if module.rename and not is_description(path):
            message = f"module '{self._module}': rename: '{path.name}' is not a URDF, SDFormat or MJCF"
            place = self._sidecar.key_span("modules", self._module, "rename")
            diagnostics.add("SB160", message, place, help=["rename its elements in its sidecar"])
            diagnostics.raise_if_errors()
        if self.variant and (is_description(path) or is_step_name(path.name)):
            message = f"module '{self._module}': variant: '{path.name}' is not a sidecar and has no variants"
            diagnostics.add("SB160", message, self._sidecar.span("modules", self._module, "variant"))
            diagnostics.raise_if_errors()
