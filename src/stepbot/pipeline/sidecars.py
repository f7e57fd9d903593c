"""Loads and checks a sidecar on its own; its STEP file and read options."""

import shlex
from pathlib import Path

from msgspec.structs import replace

from stepbot.assemble.masses import read_options
from stepbot.diagnostics import Diagnostics, Ignore, Span, did_you_mean
from stepbot.robot.step_names import is_step_name
from stepbot.runtime.file import exists, is_folder
from stepbot.runtime.robot_library import LIBRARY, export_hint
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.ignored import ignores
from stepbot.sidecar.load import load_sidecar, parse_sidecar
from stepbot.sidecar.located import NO_MOTORS, OwnMotors, Sidecar
from stepbot.sidecar.tree import Tree
from stepbot.step.assembly import ReadOptions

from .conversion import Options

SIDECAR_SUFFIXES = (".yaml", ".yml")


def load(
    path: Path,
    options: Options,
    diagnostics: Diagnostics,
    text: str | None = None,
    module: Tree | None = None,
    motors: OwnMotors = NO_MOTORS,
) -> Sidecar:
    """Load and check a sidecar, and suppress the diagnostics that it and the options ignore.

    Args:
        options: Codes to ignore, and the variant.
        text: Text to take in place of the file's, before it is written; with line feeds at line ends.
        module: The module of another file that selects the variant and changes values.
        motors: The motors of that file.

    Raises:
        StepbotError: There are errors.
    """
    diagnostics.ignore(Ignore(code, Span("stepbot")) for code in options.ignore)
    if text is None:
        sidecar = load_sidecar(path, diagnostics, options.variant, module, motors)
    else:
        sidecar = parse_sidecar(text, path, diagnostics, options.variant, module, motors)
    if sidecar is not None:
        check_sidecar(sidecar, diagnostics)
        diagnostics.ignore(ignores(sidecar.root))
    diagnostics.raise_if_errors()
    assert sidecar is not None
    return sidecar


def named_step(sidecar: Sidecar, diagnostics: Diagnostics) -> Path:
    """The STEP of the sidecar; a missing file is reported at its name in the sidecar.

    Raises:
        StepbotError: It does not exist.
    """
    if not sidecar.document.step:
        files = dict.fromkeys(module.file or "" for module in sidecar.document.modules.values())
        help = [
            f"`stepbot library export {file.removeprefix(LIBRARY)}` writes the STEP of '{file}'"
            for file in files
            if file.startswith(LIBRARY)
        ]
        paths = [sidecar.path.parent / file for file in files if not file.startswith(LIBRARY)]
        with_step = [one for one in paths if is_step_name(one.name) or one.suffix.lower() in SIDECAR_SUFFIXES]
        help += [f"`{shlex.join(['stepbot', 'inspect', one.as_posix()])}`" for one in with_step]
        whole = shlex.join(["stepbot", "check", "--step", sidecar.path.as_posix()])
        help = [*help[:_SHOWN], f"`{whole}` lists the joints of the whole"]
        message = "modules: the robot is composed of them alone, without a STEP of its own"
        diagnostics.add("SB150", message, sidecar.key_span("modules"), help=help)
        diagnostics.raise_if_errors()
    path = sidecar.step_path
    if not exists(path):
        folder = path.parent
        beside = sorted(file.name for file in folder.iterdir()) if is_folder(folder) else []
        remedies = (
            *did_you_mean(path.name, beside),
            "`step` is relative to the sidecar; `--step FILE` selects another file",
        )
        diagnostics.add("SB001", f"step: file '{sidecar.document.step}' not found", sidecar.span("step"), help=remedies)
        diagnostics.raise_if_errors()
    return path


def what_to_read(sidecar: Sidecar | None, options: Options) -> ReadOptions:
    """Read options of a STEP file, with or without a sidecar."""
    what = ReadOptions() if sidecar is None else read_options(sidecar.document)
    return replace(what, encoding=options.encoding) if options.encoding else what


_SUFFIXES = (*SIDECAR_SUFFIXES, ".urdf", ".sdf", ".xml", ".xacro", ".usda", ".usd", ".usdc", ".proto")
_SHOWN = 5


def report_missing(target: Path, diagnostics: Diagnostics) -> None:
    """Report SB001 with the files beside it that may be meant: similar names, else all that a command takes."""
    try:
        beside = sorted(
            one.name for one in target.parent.iterdir() if is_step_name(one.name) or one.suffix.lower() in _SUFFIXES
        )
    except OSError:
        help = [f"there is no folder '{target.parent.as_posix()}'"]
    else:
        begun = [name for name in beside if name.startswith(f"{target.name}.")]
        named = " or ".join(f"'{name}'" for name in begun[:_SHOWN])
        near = (f"did you mean {named}?",) if begun else did_you_mean(target.name, beside)
        listed = ", ".join(f"'{name}'" for name in beside[:_SHOWN]) + (", ..." if beside[_SHOWN:] else "")
        help = list(export_hint(target.as_posix()) or near) or (
            [f"files in '{target.parent.as_posix()}': {listed}"] if beside else []
        )
    diagnostics.add("SB001", "file not found", Span(target.as_posix()), help=help)
