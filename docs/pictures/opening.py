"""Draws opening.gif, the README's picture: the parts of a STEP file become a robot that moves.

``python docs/pictures/opening.py``; needs ``stepbot[render]``.
"""

from math import cos, pi, radians
from pathlib import Path

import numpy as np
from msgspec.structs import replace
from PIL import Image, ImageDraw, ImageFont

from stepbot.diagnostics import Diagnostics
from stepbot.pictures.camera import VIEWS, camera_of
from stepbot.pictures.raytrace import Renderer, Scene
from stepbot.pictures.scene import Subject, scene_of
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.picturing import assembly_subject, part_labels, robot_subject, robot_to_draw
from stepbot.pipeline.stages import inspect
from stepbot.robot.posing import posed

ROBOT = Path(__file__).parents[2] / "robot_library" / "stepbot_delta"
SIZE = (560, 400)
SHOULDERS = ("shoulder_1", "shoulder_2", "shoulder_3")
SWING = radians(24.0)
PARTS, TURNS = 10, 30
"""Number of frames in which the parts come together, and of those in which the robot moves."""
STILL, STEP = 1200, 70
"""Time of the first frame and of the others [ms]."""
COLORS = 96


def parts(apart: float) -> Subject:
    """The STEP file, with its parts some way from each other."""
    assembly = inspect(ROBOT / "delta.step", Options(Path())).assembly
    assert assembly is not None
    return assembly_subject(assembly, part_labels(assembly, assembly.children[0], folded=False), apart)


def poses() -> list[Subject]:
    """The robot in a cycle that begins and ends as drawn; its loops stay closed."""
    robot = robot_to_draw(ROBOT / "delta.robot.yaml", Options(Path()), Diagnostics())
    assert robot is not None
    subjects = []
    for turn in range(TURNS):
        t, rise = 2 * pi * turn / TURNS, 0.5 - 0.5 * cos(2 * pi * turn / TURNS)
        q = {name: SWING * rise * cos(2 * t + 2 * pi * n / 3) for n, name in enumerate(SHOULDERS)}
        subjects.append(robot_subject(robot, posed(robot, q)))
    return subjects


def middle(scene: Scene) -> np.ndarray:
    """The middle of the box around a scene [m]."""
    return (scene.vertices.min(axis=0) + scene.vertices.max(axis=0)) / 2


def captioned(pixels: np.ndarray, text: str) -> Image.Image:
    """A frame with a line of text below the robot."""
    image = Image.fromarray(pixels)
    draw = ImageDraw.Draw(image)
    draw.text((SIZE[0] / 2, SIZE[1] - 18), text, fill=(60, 66, 74), anchor="mm", font=ImageFont.load_default(15))
    return image


def main() -> None:
    """Draw all frames with one camera and write the picture."""
    view = VIEWS["corner"]
    subjects = [parts(0.45 * (1.0 - n / (PARTS - 1)) ** 2) for n in range(PARTS)] + poses()
    captions = ["delta.step: parts, no joints"] * PARTS + ["+ delta.robot.yaml: 15 joints, 5 loops, 3 motors"] * TURNS
    scenes = [scene.scene for subject in subjects if (scene := scene_of(subject, view)) is not None]
    moved = middle(scenes[PARTS]) - middle(scenes[PARTS - 1])  # the robot's frame is its base's, not the STEP's
    scenes[:PARTS] = [
        replace(scene, vertices=scene.vertices + moved, floor=scene.floor + moved[2]) for scene in scenes[:PARTS]
    ]
    camera = camera_of(np.concatenate([scene.vertices for scene in scenes[2:]]), view, *SIZE)
    frames = [
        captioned(Renderer(scene, camera).picture(2), caption) for scene, caption in zip(scenes, captions, strict=True)
    ]
    palette = frames[PARTS].quantize(COLORS)
    small = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    small[0].save(
        Path(__file__).with_suffix(".gif"),
        save_all=True,
        append_images=small[1:],
        duration=[STILL, *[STEP] * (len(small) - 1)],
        loop=0,
        optimize=True,
    )


if __name__ == "__main__":
    main()
