"""The robot of a sidecar with modules: each file that it names, directly or through others, is read once."""

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from stepbot.compose.joining import composed
from stepbot.diagnostics import Diagnostics, Span, StepbotError, did_you_mean
from stepbot.engines.observation import Request
from stepbot.engines.reference import observe_robot
from stepbot.revisions.lock_path import lock_path
from stepbot.robot.joint_table import JointRow
from stepbot.robot.model import Robot
from stepbot.robot.step_names import is_step_name, step_stem
from stepbot.robot.validity import check_robot
from stepbot.runtime.cache import file_digest, files_digest
from stepbot.runtime.file import is_file, is_folder, resolved
from stepbot.sidecar.document import Defaults, Document, LinkSection
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.own_part import own_part
from stepbot.sidecar.starter import robot_name
from stepbot.sidecar.tree import Mapping
from stepbot.verification.joint_rows import joint_rows

from .building import build, places
from .conversion import Options
from .loading import Loading
from .sidecars import load, named_step, what_to_read
from .source_names import is_description

DEEPEST = 8
"""Most modules within modules."""
MOST = 256
"""Most modules of one robot, those of modules included."""
_OPEN_BASE = "SB868"
"""A description does not say whether its base is fixed; what it is attached to decides."""


@dataclass(frozen=True, eq=False)
class Composed:
    """A composed robot, and the files that it was made from."""

    robot: Robot
    files: tuple[Path, ...]
    """The sidecar first, then every other file, in the order of reading."""
    sought: tuple[Path, ...]
    """The same, and the lock files that do not exist."""
    content: str
    """Hash of all of them; empty if one changed while it was read."""

    @property
    def joint_table(self) -> tuple[JointRow, ...]:
        """Where each joint is, with all joints at 0."""
        return joint_rows(observe_robot(self.robot, Request("", "", configurations=({},))))


def compose(sidecar: Sidecar, options: Options, found: Diagnostics) -> Composed:
    """Read all modules of a sidecar and compose its robot.

    Args:
        sidecar: A sidecar with modules, without errors of its own.
        options: Cache and limits.
        found: Receives the diagnostics; those of a module once, at their own places.

    Raises:
        StepbotError: There are errors.
    """
    files = _Files(options)
    robot = files.composed(sidecar, (sidecar.path,), found)
    read = tuple(path for path, digest in files.read.items() if digest is not None)
    is_unchanged = all(file_digest(path) == digest for path, digest in files.read.items())
    return Composed(robot, read, tuple(files.read), files_digest(files.read) if is_unchanged else "")


class _Files:
    """Makes the robot of each file once."""

    def __init__(self, options: Options) -> None:
        self._options = options
        self._robots: dict[Path, Robot | None] = {}
        self._modules = 0
        self.read: dict[Path, str | None] = {}
        """Hash of each file before it was read."""

    def _note(self, *paths: Path) -> None:
        for path in paths:
            self.read.setdefault(path, file_digest(path))

    def composed(self, sidecar: Sidecar, chain: tuple[Path, ...], found: Diagnostics) -> Robot:
        """The composed robot of a sidecar; ``chain`` are the files that lead to it, itself last."""
        self._note(sidecar.path, lock_path(sidecar.path))
        robots = {}
        for name, section in sidecar.document.modules.items():
            self._modules += 1
            self._check_count(sidecar, name, chain, found)
            if section.file is not None:
                robot = self._module(sidecar, name, section.file, chain, found)
                if robot is not None:
                    robots[name] = robot
            elif section.mirror_of is None:
                message = f"module '{name}': neither `file` nor `mirror_of` is set"
                found.add("SB150", message, sidecar.key_span("modules", name))
        for name, section in sidecar.document.modules.items():
            self._check_mirror(sidecar, name, section.mirror_of, section.file, found)
        found.raise_if_errors()
        own = self._own(sidecar, found)
        robot = composed(sidecar, own, robots, found)
        found.raise_if_errors()
        assert robot is not None  # a missing robot always has an error
        check_robot(robot, found, sidecar.span(), massless_between=True, places=lambda: places(sidecar))
        found.raise_if_errors()
        return robot

    def _check_count(self, sidecar: Sidecar, name: str, chain: tuple[Path, ...], found: Diagnostics) -> None:
        what = f"more than {MOST} modules" if self._modules > MOST else ""
        if len(chain) > DEEPEST:
            what = f"more than {DEEPEST} modules within modules"
        if what:
            found.add("SB150", f"module '{name}': {what}", sidecar.key_span("modules", name))
            found.raise_if_errors()

    def _check_mirror(self, sidecar: Sidecar, name: str, of: str | None, file: str | None, found: Diagnostics) -> None:
        if of is None:
            return
        modules, span = sidecar.document.modules, sidecar.span("modules", name, "mirror_of")
        if file is not None:
            help = ["remove `file`: it is the file of the other module", "`mirror: y` mirrors a file"]
            found.add("SB150", f"module '{name}': both `file` and `mirror_of` are set", span, help=help)
        elif of not in modules:
            found.add("SB152", f"module '{name}': mirror_of: no module '{of}'", span, help=did_you_mean(of, modules))
        elif modules[of].mirror_of is not None:
            help = [f"mirror_of: {modules[of].mirror_of}"]
            found.add("SB152", f"module '{name}': mirror_of: '{of}' is itself a mirror image", span, help=help)

    def _own(self, sidecar: Sidecar, found: Diagnostics) -> Robot | None:
        """The robot of the links that the sidecar describes itself."""
        if not sidecar.document.links:
            return None
        own = own_part(sidecar)
        if not own.document.step:
            return self._without_step(own, found)
        step = self._options.step or named_step(own, found)
        return self._from_step(own, step, found)

    def _without_step(self, own: Sidecar, found: Diagnostics) -> Robot | None:
        """Own links without an assembly: their mass properties and poses are given."""
        from stepbot.assemble import build_robot
        from stepbot.step.assembly import ROOT_PATH, Assembly, Component

        nothing = Assembly("", "", "", "m", 1.0, (Component(0, -1, "", ROOT_PATH, "", "", 0),), ())
        built = build_robot(nothing, own, lambda: (), found, self._options.cache)
        found.raise_if_errors()
        return None if built is None else built.robot

    def _from_step(self, sidecar: Sidecar, step: Path, found: Diagnostics) -> Robot:
        self._note(step)
        with closing(Loading(step, what_to_read(sidecar, self._options), self._options, found)) as loading:
            assembly = loading.assembly(found)
            built = build(sidecar, assembly, loading, self._options, found)
            found.raise_if_errors()
            assert built is not None  # a missing robot always has an error
            built.double_counting.report(self._options.timeout)
        self._note(*(step.parent / name for name in assembly.external_files))
        return built.robot

    def _module(
        self, sidecar: Sidecar, name: str, file: str, chain: tuple[Path, ...], found: Diagnostics
    ) -> Robot | None:
        path = sidecar.path.parent / file
        span = sidecar.span("modules", name, "file")
        if not is_file(path):
            beside = sorted(one.name for one in path.parent.iterdir()) if is_folder(path.parent) else []
            help = (*did_you_mean(path.name, beside), "`file` is relative to this sidecar")
            found.add("SB150", f"module '{name}': file '{file}' not found", span, help=help)
            return None
        key = resolved(path)
        if key in [resolved(one) for one in chain]:
            ring = " -> ".join(one.name for one in (*chain, path))
            message = f"module '{name}': '{file}' contains itself: {ring}"
            found.add("SB151", message, span, help=["remove one of the modules"])
            return None
        if key not in self._robots:
            local, document = Diagnostics(), sidecar.document
            is_placed = bool(document.modules[name].at) or "base" in document.model_fields_set
            is_placed |= any(joint.child.partition("/")[0] == name for joint in document.joints.values())
            try:
                self._robots[key] = self._robot(path, chain, local)
            except StepbotError as error:
                if error.diagnostics is not local:
                    local.extend(error.diagnostics)
                self._robots[key] = None
            note = f"module '{name}' of {span}"
            for one in local:
                if one.code != _OPEN_BASE or not is_placed:
                    found.add(one.code, one.message, one.span, help=one.help, notes=(*one.notes, note))
            found.add_ignored(local.ignored)
        return self._robots[key]

    def _robot(self, path: Path, chain: tuple[Path, ...], found: Diagnostics) -> Robot:
        self._note(path)
        if is_step_name(path.name):
            return self._from_step(_of_one_link(path), path, found)
        if is_description(path):
            from .translating import robot_of_file

            robot, files = robot_of_file(path, self._options, found)
            self._note(*files)
            return robot
        self._note(lock_path(path))
        sidecar = load(path, self._options._replace(ignore=()), found)
        if sidecar.document.modules:
            return self.composed(sidecar, (*chain, path), found)
        return self._from_step(sidecar, named_step(sidecar, found), found)


def _of_one_link(step: Path) -> Sidecar:
    """The sidecar of a STEP file without one: all of its parts are one link."""
    document = Document(
        version=1,
        robot=robot_name(step_stem(step.name)),
        step=step.name,
        defaults=Defaults(density="todo"),
        links={"body": LinkSection(rest=True)},
    )
    return Sidecar(document, step, "", Mapping(Span(step.as_posix()), {}, 1, 1))
