"""Reads an existing robot description of any format as data; to be called in a worker process."""

from pathlib import Path

from .description import Description
from .description.sdf import describe_sdf
from .description.urdf import describe_urdf
from .mujoco.described import describe_mjcf
from .observation import EngineCannotRead
from .yourdfpy.observer import prepare as prepare_urdf

_READERS = {"urdf": describe_urdf, "sdf": describe_sdf, "mjcf": describe_mjcf}


def describe(file: str, written_in: str, packages: tuple[Path, ...] = ()) -> Description:
    """Read a description.

    Args:
        file: Absolute path.
        written_in: ``urdf``, ``sdf`` or ``mjcf``.
        packages: Folders of the packages and models that meshes are named in.

    Raises:
        EngineRefused: It contradicts its format.
        EngineCannotRead: It uses what its reader does not support.
    """
    if written_in not in _READERS:
        raise EngineCannotRead(f"only {', '.join(_READERS)} can be converted and shown, not {written_in}")
    if written_in == "urdf":
        prepare_urdf()
    return _READERS[written_in](file, packages)
