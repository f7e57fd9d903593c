"""Hashes of inputs, by which outdated results are detected without drawing or converting."""

import hashlib
from collections.abc import Iterable
from pathlib import Path

_HERE = Path(__file__).parent
_DRAWING = ("drawing.py", "description.py", "moments.py", "shapes.py", "step_file.py", "step_text.py")
_OF_MACHINES = ("legs", "limb_parts", "machine", "machine_parts")
"""Modules that only some robots are drawn with."""
_PICTURE = ("preview.py", "raytrace.py")
_DIGITS = 16


def drawing(folder: Path) -> str:
    """Of the inputs of a robot's STEP: its scripts, its expected.json, and shared modules."""
    scripts = sorted(path for path in folder.glob("*.py") if path.name != "view.py")
    text = "\n".join(path.read_text(encoding="utf-8") for path in scripts)
    used = [f"{name}.py" for name in _OF_MACHINES if f"from ..{name} import" in text]
    return _hash((*scripts, folder / "expected.json", *(_HERE / name for name in (*_DRAWING, *used))))


def robot(folder: Path) -> str:
    """Of the inputs of a robot's conversion: its STEP and its sidecar."""
    return _hash((*sorted(folder.glob("*.step")), *sorted(folder.glob("*.robot.yaml"))))


def picture(folder: Path) -> str:
    """Of the inputs of a picture: the robot, the view, and the renderer."""
    return _hash(
        (
            *sorted(folder.glob("*.step")),
            *sorted(folder.glob("*.robot.yaml")),
            folder / "view.py",
            *(_HERE / name for name in _PICTURE),
        )
    )


def _hash(paths: Iterable[Path]) -> str:
    digest = hashlib.sha256()
    for path in paths:
        # A checkout may have other line ends.
        content = path.read_bytes().replace(b"\r\n", b"\n") if path.is_file() else b""
        digest.update(f"{path.name} {len(content)}\n".encode())
        digest.update(content)
    return digest.hexdigest()[:_DIGITS]
