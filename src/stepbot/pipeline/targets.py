"""Files and folders that a command is asked for and that do not exist."""

from pathlib import Path

from stepbot.diagnostics import Diagnostics, Span, did_you_mean
from stepbot.robot.step_names import is_step_name

from .sidecars import SIDECAR_SUFFIXES

_SUFFIXES = (*SIDECAR_SUFFIXES, ".urdf", ".sdf", ".xml", ".xacro", ".usda", ".usd", ".usdc", ".proto")
_SHOWN = 5


def report_missing(target: Path, found: Diagnostics) -> None:
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
        help = list(near) or ([f"files in '{target.parent.as_posix()}': {listed}"] if beside else [])
    found.add("SB001", "file not found", Span(target.as_posix()), help=help)
