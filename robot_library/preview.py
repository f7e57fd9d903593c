"""Render the outdated pictures of robots, preview.png: ``python -m robot_library.preview FOLDER ...``.

The robot is built with finer meshes, posed as drawn, and rendered by :mod:`stepbot.pictures`, all robots in the same
light. A text chunk of the picture has the hash of its inputs, by which outdated pictures are found. A robot's view.py,
if there is one, has the direction: ``VIEW = View(azimuth=..., elevation=...)``.
"""

import argparse
import importlib.util
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from stepbot.pictures.camera import View
from stepbot.pictures.picture import Sheet, draw, png_bytes
from stepbot.pictures.scene import Subject

from . import fingerprints

WIDTH, HEIGHT, SAMPLES = 800, 600, 4
_CHUNK = "made-from"
_PNG = b"\x89PNG\r\n\x1a\n"
_MESH = "mesh: {tolerance: 0.05 %, angle: 5 deg}"

__all__ = ["View", "draw_preview", "load_view", "png_texts", "robot_subject_of", "sheet_of", "stale"]


def stale(folder: Path) -> bool:
    """Whether the picture is missing, or its inputs have changed."""
    picture = folder / "preview.png"
    return not picture.is_file() or png_texts(picture).get(_CHUNK) != fingerprints.picture(folder)


def png_texts(path: Path) -> dict[str, str]:
    """The text chunks of a PNG file (RFC 2083, 4.2.3), by keyword.

    Raises:
        ValueError: The file is not a PNG file.
    """
    content = path.read_bytes()
    if not content.startswith(_PNG):
        raise ValueError(f"{path}: no PNG file")
    found, place = {}, len(_PNG)
    while place < len(content):
        length = int.from_bytes(content[place : place + 4], "big")
        kind, body = content[place + 4 : place + 8], content[place + 8 : place + 8 + length]
        if kind == b"tEXt":
            keyword, _, text = body.partition(b"\0")
            found[keyword.decode("latin-1")] = text.decode("latin-1")
        place += length + 12
    return found


def draw_preview(folder: Path) -> None:
    """Write preview.png of the robot in a folder."""
    texts = {_CHUNK: fingerprints.picture(folder)}
    (folder / "preview.png").write_bytes(png_bytes(draw(robot_subject_of(folder), sheet_of(folder)).pixels, texts))


def sheet_of(folder: Path, width: int = WIDTH, height: int = HEIGHT) -> Sheet:
    """The form of a robot's picture; of another size for tests."""
    return Sheet(width, height, SAMPLES, load_view(folder))


def load_view(folder: Path) -> View:
    """The robot's own view, or the default."""
    path = folder / "view.py"
    if not path.is_file():
        return View()
    spec = importlib.util.spec_from_file_location(f"robot_library.{folder.name}.view", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    view: View = module.VIEW
    return view


def robot_subject_of(folder: Path) -> Subject:
    """The visual geometry of the robot in its drawn pose, with finer meshes than its sidecar sets."""
    from stepbot.diagnostics import Diagnostics
    from stepbot.pipeline.conversion import Options
    from stepbot.pipeline.picturing import robot_subject, robot_to_draw
    from stepbot.robot.posing import posed

    (sidecar,) = folder.glob("*.robot.yaml")
    (step,) = folder.glob("*.step")
    text = sidecar.read_text(encoding="utf-8")
    with TemporaryDirectory() as place:
        finer = Path(place) / sidecar.name
        finer.write_text(text if "\nmesh:" in text else f"{text}\n{_MESH}\n", encoding="utf-8")
        diagnostics = Diagnostics()
        robot = robot_to_draw(finer, Options(Path(place), step=step), diagnostics)
    if robot is None:
        raise SystemExit("\n".join(map(str, diagnostics)))
    return robot_subject(robot, posed(robot, {}))


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description="Draw preview.png of robots.")
    parser.add_argument("folders", nargs="+", type=Path, help="folders of robots")
    parser.add_argument("--force", action="store_true", help="draw also what is not stale")
    options = parser.parse_args()
    for folder in options.folders:
        if options.force or stale(folder):
            draw_preview(folder.resolve())
            print(f"{folder}: drawn", file=sys.stderr)


if __name__ == "__main__":
    main()
