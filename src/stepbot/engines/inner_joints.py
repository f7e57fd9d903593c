"""Joints of a URDF that engines do not move alike: planar ones, and floating ones within the robot."""

from collections.abc import Collection
from pathlib import Path

from stepbot.runtime.file import is_file

from .xml_root import xml_root


def inner_joints(file: Path, kinds: Collection[str] = ("planar", "floating")) -> str:
    """Names and kinds of such joints, for messages; empty if there are none.

    A floating joint below a root link ``world`` is the base of a floating robot, which engines read alike.

    Args:
        file: The URDF.
        kinds: The kinds that the engine does not read.

    Raises:
        EngineRefused: The file is not XML.
    """
    found = []
    for joint in xml_root(file).iterfind("joint") if is_file(file) else ():  # engines reject what is not there
        kind, parent = joint.get("type"), joint.find("parent")
        on_world = kind == "floating" and parent is not None and parent.get("link") == "world"
        if kind in kinds and not on_world:
            found.append(f"'{joint.get('name')}' ({kind})")
    return ", ".join(found)
