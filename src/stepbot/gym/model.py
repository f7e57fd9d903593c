"""A compiled model, from a file and the scene beside it."""

import copy
from codecs import BOM_UTF8
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import Any

import mujoco

from stepbot.engines.mujoco.model import collected_warnings
from stepbot.robot.bounding_boxes import is_jaw
from stepbot.robot.mesh_names import SCOPE
from stepbot.runtime.file import is_file, open_regular

SCENE = ".scene.xml"
"""End of the name of the scene that stepbot writes beside a robot's file: floor, light and camera."""

Model = Any
"""``mujoco.MjModel``."""


def load(path: str | PathLike[str], *, scene: bool = True) -> Model:
    """Compile an MJCF file, or the scene beside it.

    To make many environments of one robot, pass them the model that this function returns: each copies it, which
    takes a fraction of the time of compiling it.

    Args:
        path: The robot's file, or any scene.
        scene: Whether to compile ``<robot>.scene.xml`` instead if it is beside ``<robot>.xml``.

    Raises:
        ValueError: The file is missing, is no XML, as a sidecar, or MuJoCo does not compile it.
    """
    file = Path(path)
    beside = file.with_suffix(SCENE)
    if scene and not file.name.endswith(SCENE) and is_file(beside):
        file = beside
    if not is_file(file):
        raise ValueError(f"no file {file}; `stepbot convert <robot>.robot.yaml -f mjcf` writes one")
    if file.suffix.lower() != ".xml" and not _is_xml(file):
        sidecar = file.name if file.suffix.lower() in (".yaml", ".yml") else "<robot>.robot.yaml"
        raise ValueError(f"{file} is no MJCF; `stepbot convert {sidecar} -f mjcf` writes one")
    with collected_warnings():
        try:
            return mujoco.MjModel.from_xml_path(str(file))
        except ValueError as error:
            raise ValueError(f"MuJoCo does not compile {file}: {error}") from error


def _is_xml(file: Path) -> bool:
    """Whether a file begins as XML does: MuJoCo loads a robot under any suffix, and reports other files by a number."""
    with open_regular(file) as stream:
        return stream.read(64).removeprefix(BOM_UTF8).lstrip().startswith(b"<")


def own_copy(model: "str | PathLike[str] | Model") -> Model:
    """A model of one environment, compiled from a file or copied.

    Raises:
        ValueError: It has no actuators, or :func:`load` raises it.
    """
    mine = copy.copy(model) if isinstance(model, mujoco.MjModel) else load(model)
    if mine.nu == 0:
        raise ValueError(
            "the model has no actuators, hence no actions; add `actuators` to the sidecar, or <actuator> to the MJCF"
        )
    # A diverged state is to be seen, not replaced by qpos0 in the middle of an episode.
    mine.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    return mine


def name(model: Model, kind: str, index: int) -> str:
    """Name of an element, or its kind and index if it has none; ``kind`` as in ``mjOBJ_<kind>``."""
    text = mujoco.mj_id2name(model, getattr(mujoco.mjtObj, f"mjOBJ_{kind}"), index)
    return text or f"{kind.lower()}_{index}"


def index(model: Model, kind: str, name: str) -> int:
    """Index of an element; -1 if there is none of this name."""
    return int(mujoco.mj_name2id(model, getattr(mujoco.mjtObj, f"mjOBJ_{kind}"), name))


def joint_kind(model: Model, joint: int) -> str:
    """``free``, ``ball``, ``slide`` or ``hinge``."""
    return str(mujoco.mjtJoint(int(model.jnt_type[joint])).name).removeprefix("mjJNT_").lower()


def joint_name(model: Model, joint: int) -> str:
    """Name of a joint; a free joint has that of its body, which moves with it."""
    if joint_kind(model, joint) == "free":
        return name(model, "BODY", int(model.jnt_bodyid[joint]))
    return name(model, "JOINT", joint)


def floating_base(model: Model) -> int | None:
    """The first free joint, which carries a floating robot."""
    free = [joint for joint in range(model.njnt) if joint_kind(model, joint) == "free"]
    return free[0] if free else None


def has_loops(model: Model) -> bool:
    """Whether constraints close loops, so that not every configuration inside the limits is possible."""
    kinds = {mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtEq.mjEQ_WELD}
    return any(mujoco.mjtEq(int(kind)) in kinds for kind in model.eq_type)


def path(model: Model, body: int) -> list[int]:
    """The bodies from the world's child to this one."""
    joints: list[int] = []
    while body:
        joints.append(body)
        body = int(model.body_parentid[body])
    return joints[::-1]


def joints_of(model: Model, body: int) -> Iterator[int]:
    """The joints between a body and its parent."""
    start = int(model.body_jntadr[body])
    yield from range(start, start + int(model.body_jntnum[body]))


def tip_body(model: Model) -> int:
    """The last link of the chain with most joints; of several such chains, the last link that they share: a hand.

    Free joints do not count. A single jaw is not the last link, but the one before.

    Raises:
        ValueError: The chains share no more than half of their joints, as those of two arms: a link has to be named.
    """
    parents = {int(parent) for parent in model.body_parentid[1:]}
    ends = [body for body in range(1, model.nbody) if body not in parents]
    joints = {end: _moving_joints(model, end) for end in ends}
    most = max(joints.values(), default=0)
    paths = [path(model, end) for end in ends if joints[end] == most]
    shared = [column[0] for column in zip(*paths, strict=False) if len(set(column)) == 1]
    if not shared or 2 * _moving_joints(model, shared[-1]) <= most:
        choice = (*frame_names(model), *(name(model, "BODY", end) for end in ends))
        raise ValueError(f"which link is to reach the target? Pass tip=..., one of {', '.join(choice)}")
    return _before_jaw(model, int(shared[-1]))


def _before_jaw(model: Model, body: int) -> int:
    """The link that carries a link if it is a single jaw, or fixed on one; else the link itself."""
    jaw = next((one for one in reversed(path(model, body)) if model.body_jntnum[one]), body)
    joints = list(joints_of(model, jaw))
    hand = int(model.body_parentid[jaw])
    below = [one for one in range(jaw + 1, model.nbody) if jaw in path(model, one)]
    ends = not any(model.body_jntnum[one] for one in below)
    if not (ends and len(joints) == 1 and model.jnt_limited[joints[0]] and _moving_joints(model, hand)):
        return body
    names = (name(model, "JOINT", joints[0]), name(model, "BODY", jaw))
    lower, upper = (float(end) for end in model.jnt_range[joints[0]])
    return hand if joint_kind(model, joints[0]) in ("hinge", "slide") and is_jaw(names, lower, upper) else body


def tip_frame(model: Model, body: int) -> int | None:
    """The one named frame of a link, else of the last link before it that has one; None if there is none or a choice.

    Links with at most half of the joints before ``body`` do not count: their frames are mounts, not tools.
    """
    for link in reversed(path(model, body)):
        if 2 * _moving_joints(model, link) <= _moving_joints(model, body):
            return None
        frames = frames_of(model, link)
        if frames:
            return frames[0] if len(frames) == 1 else None
    return None


def _moving_joints(model: Model, body: int) -> int:
    return sum(joint_kind(model, j) != "free" for one in path(model, body) for j in joints_of(model, one))


def frames_of(model: Model, body: int) -> list[int]:
    """The sites of a body that are named frames: names with ``::`` belong to sensors and closures."""
    return [
        site
        for site in range(model.nsite)
        if model.site_bodyid[site] == body and SCOPE not in name(model, "SITE", site)
    ]


def frame_names(model: Model) -> list[str]:
    """Names of the sites that are named frames."""
    return [one for one in (name(model, "SITE", site) for site in range(model.nsite)) if SCOPE not in one]
