"""A sidecar, loaded and checked on its own; the STEP that it names, and how that is to be read."""

from dataclasses import replace
from pathlib import Path

from stepbot.assemble.reading import read_options
from stepbot.diagnostics import Diagnostics, Ignore, Span, did_you_mean
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.ignored import ignores
from stepbot.sidecar.load import load_sidecar
from stepbot.sidecar.located import Sidecar
from stepbot.step.assembly import ReadOptions

from .conversion import Options


def load(path: Path, options: Options, found: Diagnostics) -> Sidecar:
    """Load a sidecar and check it, and ignore the findings that it and the options ask to ignore.

    Raises:
        StepbotError: There are errors.
    """
    found.ignore(Ignore(code, Span("stepbot")) for code in options.ignore)
    sidecar = load_sidecar(path, found)
    if sidecar is not None:
        check_sidecar(sidecar, found)
        found.ignore(ignores(sidecar.root))
    found.raise_if_errors()
    assert sidecar is not None
    return sidecar


def named_step(sidecar: Sidecar, found: Diagnostics) -> Path:
    """The STEP that the sidecar names; where there is none, the error stands at its name in the sidecar.

    Raises:
        StepbotError: There is none.
    """
    path = sidecar.step_path
    if not path.exists():
        folder = path.parent
        beside = sorted(file.name for file in folder.iterdir()) if folder.is_dir() else []
        remedies = (
            *did_you_mean(path.name, beside),
            "`step` is relative to the sidecar; `--step FILE` selects another file",
        )
        found.add("SB001", f"step: file '{sidecar.document.step}' not found", sidecar.span("step"), help=remedies)
        found.raise_if_errors()
    return path


def what_to_read(sidecar: Sidecar | None, options: Options) -> ReadOptions:
    """What to read of a STEP file, which may come without a sidecar."""
    what = ReadOptions() if sidecar is None else read_options(sidecar.document)
    return replace(what, encoding=options.encoding) if options.encoding else what
