"""PyBullet's numbers of a URDF or of the tree of an SDFormat file, read in a separate process."""

import os
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np


def _matrix(position: Sequence[float], xyzw: Sequence[float]) -> np.ndarray:
    import pybullet

    X = np.eye(4)
    X[:3, :3] = np.reshape(pybullet.getMatrixFromQuaternion(xyzw), (3, 3))
    X[:3, 3] = position
    return X


def _body_numbers(body: int, link: int) -> tuple[float, list[float], list[list[float]]]:
    """Mass, centre of mass and inertia about it, in the link's frame."""
    import pybullet

    dynamics = pybullet.getDynamicsInfo(body, link)
    X_LI = _matrix(dynamics[3], dynamics[4])
    inertia = X_LI[:3, :3] @ np.diag(dynamics[2]) @ X_LI[:3, :3].T
    return dynamics[0], X_LI[:3, 3].tolist(), inertia.tolist()


def _poses(body: int, names: Sequence[str]) -> dict[str, list[list[float]]]:
    """Pose of every link in the root link."""
    import pybullet

    X_WI = _matrix(*pybullet.getBasePositionAndOrientation(body))
    dynamics = pybullet.getDynamicsInfo(body, -1)
    X_WB = X_WI @ np.linalg.inv(_matrix(dynamics[3], dynamics[4]))
    poses = {names[0]: np.eye(4)}
    for index, name in enumerate(names[1:]):
        state = pybullet.getLinkState(body, index, computeForwardKinematics=True)
        poses[name] = np.linalg.inv(X_WB) @ _matrix(state[4], state[5])
    return {name: X.tolist() for name, X in poses.items()}


def read(file: str, configurations: Sequence[Mapping[str, float]]) -> dict[str, Any]:
    """Numbers of every link, poses at the configurations, and PyBullet's complaints."""
    import pybullet

    pybullet.connect(pybullet.DIRECT)
    pybullet.setPhysicsEngineParameter(enableFileCaching=0)
    with tempfile.TemporaryFile() as printed:
        kept = os.dup(1), os.dup(2)
        os.dup2(printed.fileno(), 1)
        os.dup2(printed.fileno(), 2)
        if Path(file).suffix == ".urdf":
            body = pybullet.loadURDF(file, flags=pybullet.URDF_USE_INERTIA_FROM_FILE)
        else:
            (body,) = pybullet.loadSDF(file)
        sys.stdout.flush()
        os.dup2(kept[0], 1)
        os.dup2(kept[1], 2)
        printed.seek(0)
        lines = printed.read().decode("utf-8", "replace").splitlines()
    joints = [pybullet.getJointInfo(body, i) for i in range(pybullet.getNumJoints(body))]
    names = [pybullet.getBodyInfo(body)[0].decode(), *(joint[12].decode() for joint in joints)]
    at = {joint[1].decode(): index for index, joint in enumerate(joints)}
    poses = []
    for q in configurations:
        for name, value in q.items():
            pybullet.resetJointState(body, at[name], value)
        poses.append(_poses(body, names))
    numbers = {name: _body_numbers(body, index - 1) for index, name in enumerate(names)}
    kinds = {joint[1].decode(): (joint[2], joint[8], joint[9], joint[10], joint[11]) for joint in joints}
    return {"links": numbers, "poses": poses, "joints": kinds, "complaints": [line for line in lines if line.strip()]}


def read_tree(file: str, configurations: Sequence[Mapping[str, float]]) -> dict[str, Any]:
    """The result of :func:`read` for a copy of an SDFormat file that contains only a tree."""
    from stepbot.engines.sdformat_reader.tree import tree_copy

    with tree_copy(Path(file)) as (copy, _):
        return read(str(copy), configurations)
