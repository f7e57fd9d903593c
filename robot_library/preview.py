"""Render the outdated pictures of robots, preview.png: ``python -m robot_library.preview FOLDER ...``.

The robot is converted with finer meshes, posed as drawn, and rendered by :mod:`robot_library.raytrace`, all robots in
the same light. A text chunk of the picture has the hash of its inputs, by which outdated pictures are found. A robot's
view.py, if there is one, has the direction: ``VIEW = View(azimuth=..., elevation=...)``.
"""

import argparse
import importlib.util
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from . import fingerprints
from .raytrace import Array, Camera, Scene, linear, render

WIDTH, HEIGHT, SAMPLES = 800, 600, 4
TANGENT = 0.16
"""Tangent of half the vertical field of view: a long lens, as in catalogues."""
_CHUNK = "made-from"
_PNG = b"\x89PNG\r\n\x1a\n"
_MESH = "mesh: {tolerance: 0.05 %, angle: 5 deg}"


@dataclass(frozen=True)
class View:
    """The camera's direction, and the framing."""

    azimuth: float = 35.0
    """Degrees from the robot's front, +x, to the camera, clockwise seen from above."""
    elevation: float = 20.0
    """Degrees above the horizon."""
    zoom: float = 1.0
    """Magnification of the robot."""
    floor: bool = True
    """Whether there is a floor at its lowest point."""


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
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    scene, view = load_scene(folder), load_view(folder)
    picture = render(scene, camera_of(scene, view), WIDTH, HEIGHT, SAMPLES)
    told = PngInfo()
    told.add_text(_CHUNK, fingerprints.picture(folder))
    Image.fromarray(picture).save(folder / "preview.png", pnginfo=told, optimize=True)


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


def camera_of(scene: Scene, view: View) -> Camera:
    """A camera that sees the whole scene, with a margin."""
    azimuth, elevation = np.radians(view.azimuth), np.radians(view.elevation)
    toward = np.array((np.cos(azimuth) * np.cos(elevation), -np.sin(azimuth) * np.cos(elevation), np.sin(elevation)))
    right = np.array((np.sin(azimuth), np.cos(azimuth), 0.0))
    up = np.cross(toward, right)
    across, along = scene.vertices @ right, scene.vertices @ up
    depth = scene.vertices @ toward
    middle = (across.max() + across.min()) / 2, (along.max() + along.min()) / 2
    target = middle[0] * right + middle[1] * up + depth.mean() * toward
    half = np.maximum(np.abs(across - middle[0]) * HEIGHT / WIDTH, np.abs(along - middle[1]))
    distance = float(np.max(1.12 / view.zoom * half / TANGENT + depth - depth.mean()))
    return Camera(target + distance * toward, target, TANGENT)


def load_scene(folder: Path) -> Scene:
    """The visual geometry of the robot in its drawn pose, in the world frame."""
    import mujoco

    with TemporaryDirectory() as place:
        model = mujoco.MjModel.from_xml_path(str(_converted(folder, Path(place))))
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    vertices, triangles, colors, count = [], [], [], 0
    for i in range(model.ngeom):
        if model.geom_type[i] != mujoco.mjtGeom.mjGEOM_MESH or model.geom_contype[i] or model.geom_conaffinity[i]:
            continue  # collision geometry
        mesh = model.geom_dataid[i]
        start, number = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        points = model.mesh_vert[start : start + number].astype(np.float64)
        first, faces = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
        R = data.geom_xmat[i].reshape(3, 3)
        vertices.append(points @ R.T + data.geom_xpos[i])
        triangles.append(model.mesh_face[first : first + faces] + count)
        material = model.geom_matid[i]
        rgba: Array = model.mat_rgba[material] if material >= 0 else model.geom_rgba[i]
        colors.append(np.tile(linear(rgba[:3].astype(np.float64)), (faces, 1)))
        count += number
    points = np.concatenate(vertices)
    floor = float(points[:, 2].min()) if load_view(folder).floor else -np.inf
    return Scene(points, np.concatenate(triangles).astype(np.int32), np.concatenate(colors), floor)


def _converted(folder: Path, place: Path) -> Path:
    """The robot as MJCF, with finer meshes than its sidecar sets."""
    from stepbot.pipeline.stages import Options, convert

    (sidecar,) = folder.glob("*.robot.yaml")
    (step,) = folder.glob("*.step")
    text = sidecar.read_text(encoding="utf-8")
    finer = place / sidecar.name
    finer.write_text(text if "\nmesh:" in text else f"{text}\n{_MESH}\n", encoding="utf-8")
    conversion = convert(finer, Options(place / "out", formats=("mjcf",), step=step, verify=False))
    if conversion.diagnostics.has_errors:
        raise SystemExit("\n".join(map(str, conversion.diagnostics)))
    (path,) = (place / "out").glob("*.xml")
    return path


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
