r"""The whole program on one page: sidecar and STEP in, three files and a proof out.

    sidecar -> Document \
                         build -> Robot -> passes -> Robot -> writers -> files -> simulators -> observations -> verify
    STEP    -> Assembly /

Nothing here prints or decides an exit code: the result carries its diagnostics, the command line shows them.
"""

from collections.abc import Callable, Mapping
from contextlib import ExitStack, closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from .build import build_robot, link_components
from .build.reading import read_options
from .cad.assembly import Assembly, ReadOptions, VolumeProperties
from .cad.reader import DEFAULT_TIMEOUT, Reading, start_reading
from .diagnostics import Diagnostics, StepbotError, did_you_mean
from .lowering import lower
from .measure import measured, prepare
from .model import Robot
from .output import failed_output, write_atomically
from .passes import run_passes
from .provenance import emitted_names, measured_bodies
from .report import Report, report_bytes
from .rules import check_robot
from .sidecar.check import check_sidecar
from .sidecar.load import Sidecar, load_sidecar
from .simulators.workers import check_required
from .verify import Provers, Written, verify
from .writers import files_of, main_file, writer_of

REPORT = "report.json"
SIDECAR_SUFFIXES = (".yaml", ".yml")


@dataclass(frozen=True)
class Options:
    """How to convert one sidecar."""

    output: Path
    """Folder that receives the files; made where it is missing."""
    formats: tuple[str, ...] = ("urdf", "sdf", "mjcf")
    step: Path | None = None
    """STEP file to read in place of the one that the sidecar names."""
    encoding: str = ""
    """Code page of the names in the STEP, in place of the one that the sidecar declares; empty for that one."""
    verify: bool = True
    strict: bool = False
    """Whether warnings, and so every loss, are errors."""
    require: tuple[str, ...] = ()
    """Engines whose absence is an error."""
    timeout: float = DEFAULT_TIMEOUT
    """Seconds that the kernel or an engine may take."""
    memory_limit: int | None = None
    """Address space [bytes] of the kernel's process; None for no limit."""


@dataclass(frozen=True)
class Conversion:
    """What came of one sidecar."""

    diagnostics: Diagnostics
    robot: Robot | None = None
    """None where errors ended the conversion before there was one."""
    files: Mapping[str, bytes] = field(default_factory=dict)
    """What was written, relative to the output folder."""
    report: Report | None = None


@dataclass(frozen=True)
class Inspection:
    """What a STEP file holds."""

    diagnostics: Diagnostics
    assembly: Assembly | None
    measures: tuple[VolumeProperties | None, ...] = ()
    """For each body of the assembly what trimesh measures on its mesh; None where it encloses no volume."""
    links: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    """For each link of the sidecar the indices of its components; empty where a STEP was inspected on its own."""


def convert(sidecar: Path, options: Options, progress: Callable[[str], None] = lambda stage: None) -> Conversion:
    """Convert one sidecar and the STEP that it names, write the files, and prove them."""
    found = Diagnostics()
    try:
        return _convert(sidecar, options, found, progress)
    except StepbotError as error:
        found.extend(error.diagnostics)
        return Conversion(found)


def _convert(path: Path, options: Options, found: Diagnostics, progress: Callable[[str], None]) -> Conversion:
    def stage_ends() -> None:
        if options.strict:
            found.make_strict()
        found.raise_if_errors()

    progress("read")
    writers = [writer_of(name) for name in dict.fromkeys(options.formats)]
    if options.verify:
        check_required(options.require, found)
    sidecar = _load(path, found)
    with ExitStack() as running:
        step = options.step or _named_step(sidecar, found)
        reading = running.enter_context(closing(_start(step, _what(sidecar, options), options, found)))
        # The engines import while the kernel works.
        formats = [writer.NAME for writer in writers] if options.verify else []
        provers = running.enter_context(Provers(formats, memory_limit=options.memory_limit))
        assembly, measures = _finish(reading, options, found)

        progress("build")
        robot = build_robot(assembly, sidecar, measures, found)
        stage_ends()
        assert robot is not None  # no robot without an error
        robot = run_passes(robot, found)
        check_robot(robot, found, sidecar.span(), assembly.unit)
        stage_ends()

        progress("write")
        lowered = {writer.NAME: lower(robot, writer, found) for writer in writers}
        stage_ends()
        files = {path: content for w in writers for path, content in files_of(lowered[w.NAME], w).items()}

        progress("verify")
        report = _prove(robot, lowered, files, provers, found, options)
    bodies = measured_bodies(assembly, measures, sidecar.document.mass)
    report = replace(report, names=emitted_names(robot), bodies=bodies)
    if options.strict:
        found.make_strict()
    files[REPORT] = report_bytes(report, found)
    # What failed is kept for whoever wants to know why, but not where a build would pick it up.
    write_atomically(files, failed_output(options.output) if found.has_errors else options.output)
    return Conversion(found, robot, files, report)


def _prove(
    robot: Robot,
    lowered: Mapping[str, Robot],
    files: Mapping[str, bytes],
    provers: Provers,
    found: Diagnostics,
    options: Options,
) -> Report:
    """Let the engines read the files, in a folder of their own, before anything is changed where they will go."""
    if not options.verify:
        return Report(robot=robot)
    with TemporaryDirectory(prefix="stepbot-") as folder:
        write_atomically(files, Path(folder))
        written = {name: Written(Path(folder) / main_file(one, writer_of(name)), one) for name, one in lowered.items()}
        return verify(robot, written, provers, found, require=options.require, timeout=options.timeout)


def check(sidecar: Path, options: Options, found: Diagnostics, *, open_step: bool = False) -> None:
    """Check a sidecar on its own or, with ``open_step``, against the STEP file; writes nothing."""
    try:
        loaded = _load(sidecar, found)
        if open_step:
            source = options.step or _named_step(loaded, found)
            assembly, measures = _read(source, _what(loaded, options), options, found)
            robot = build_robot(assembly, loaded, measures, found)
            if robot is not None:
                check_robot(run_passes(robot, found), found, loaded.span(), assembly.unit)
    except StepbotError as error:
        found.extend(error.diagnostics)


def inspect(path: Path, options: Options) -> Inspection:
    """Read a STEP file and measure what is in it; of a sidecar, the STEP that it names, and its links' components."""
    found = Diagnostics()
    try:
        sidecar = _load(path, found) if path.suffix.lower() in SIDECAR_SUFFIXES else None
        step = path if sidecar is None else options.step or _named_step(sidecar, found)
        assembly, measures = _read(step, _what(sidecar, options), options, found)
    except StepbotError as error:
        found.extend(error.diagnostics)
        return Inspection(found, None)
    return Inspection(found, assembly, measures, {} if sidecar is None else link_components(assembly, sidecar, found))


def _what(sidecar: Sidecar | None, options: Options) -> ReadOptions:
    """What to read of a STEP file, which may come without a sidecar."""
    what = ReadOptions() if sidecar is None else read_options(sidecar.document)
    return replace(what, encoding=options.encoding) if options.encoding else what


def _load(path: Path, found: Diagnostics) -> Sidecar:
    sidecar = load_sidecar(path, found)
    if sidecar is not None:
        check_sidecar(sidecar, found)
    found.raise_if_errors()
    assert sidecar is not None
    return sidecar


def _named_step(sidecar: Sidecar, found: Diagnostics) -> Path:
    """The STEP that the sidecar names; where there is none, the error stands at its name in the sidecar."""
    path = sidecar.step_path
    if not path.exists():
        folder = path.parent
        beside = sorted(file.name for file in folder.iterdir()) if folder.is_dir() else []
        remedies = (*did_you_mean(path.name, beside), "`step` is relative to the sidecar; `--step FILE` names another")
        found.add("SB001", f"step: no file '{sidecar.document.step}'", sidecar.span("step"), help=remedies)
        found.raise_if_errors()
    return path


def _read(
    step: Path, what: ReadOptions, options: Options, found: Diagnostics
) -> tuple[Assembly, tuple[VolumeProperties | None, ...]]:
    with closing(_start(step, what, options, found)) as reading:
        return _finish(reading, options, found)


def _start(step: Path, what: ReadOptions, options: Options, found: Diagnostics) -> Reading:
    """Begin to read; a file that is refused at once ends the conversion before anything slow is loaded."""
    reading = start_reading(step, what, memory_limit=options.memory_limit)
    if reading.pid is None:
        reading.finish(found)
        found.raise_if_errors()
    return reading


def _finish(
    reading: Reading, options: Options, found: Diagnostics
) -> tuple[Assembly, tuple[VolumeProperties | None, ...]]:
    """The assembly, and trimesh's measure of each body, whose import passes while the kernel works."""
    prepare()
    assembly = reading.finish(found, timeout=options.timeout)
    found.raise_if_errors()
    assert assembly is not None  # no assembly without an error
    return assembly, tuple(measured(body.mesh) for body in assembly.bodies)
