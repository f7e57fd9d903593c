"""Pictures of an environment: an offscreen renderer, or MuJoCo's viewer."""

import os
import sys
from dataclasses import dataclass
from typing import Any

import gymnasium
import mujoco
import numpy as np

from stepbot.geometry.spatial import Array

from .model import Model, index

MODES = ("rgb_array", "human")
_OVERVIEW = "overview"


@dataclass(frozen=True, eq=False)
class Marker:
    """A ball that no physics sees."""

    position: Array
    """In the world [m]."""
    radius: float
    rgba: tuple[float, float, float, float] = (0.95, 0.3, 0.2, 0.8)


class Pictures:
    """Draws one model; opens a window or a graphics context on first use."""

    def __init__(self, model: Model, data: Any, mode: str | None, size: tuple[int, int], camera: str | None) -> None:
        """Prepare to draw.

        Args:
            model: The compiled model.
            data: Its state.
            mode: ``rgb_array``, ``human`` or None.
            size: Height and width [pixels].
            camera: Name of a camera; None for ``overview``, or for a free camera.

        Raises:
            ValueError: The mode or the camera is unknown.
        """
        if mode is not None and mode not in MODES:
            raise ValueError(f"unknown render_mode '{mode}'; there are {', '.join(MODES)}")
        self._camera = index(model, "CAMERA", _OVERVIEW if camera is None else camera)
        if camera is not None and self._camera < 0:
            raise ValueError(f"the model has no camera '{camera}'")
        self._model, self._data, self._mode, self._size = model, data, mode, size
        self._renderer: Any = None
        self._viewer: Any = None

    def draw(self, markers: tuple[Marker, ...]) -> Any:
        """The picture (height, width, 3), if pictures are wanted.

        Raises:
            gymnasium.error.DependencyNotInstalled: There is no OpenGL to draw with.
        """
        if self._mode != "rgb_array":
            return None
        if self._renderer is None:
            self._renderer = _renderer(self._model, self._size)
        self._renderer.update_scene(self._data, camera=self._camera)
        _add(self._renderer.scene, markers)
        return self._renderer.render()

    def show(self, markers: tuple[Marker, ...]) -> None:
        """Show the state in the window, if one is wanted."""
        if self._mode != "human":
            return
        if self._viewer is None:
            self._viewer = _viewer(self._model, self._data)
        if self._viewer.is_running():
            self._viewer.user_scn.ngeom = 0
            _add(self._viewer.user_scn, markers)
            self._viewer.sync()

    def close(self) -> None:
        """Close window and graphics context."""
        for one in (self._renderer, self._viewer):
            if one is not None:
                one.close()
        self._renderer = self._viewer = None


def _renderer(model: Model, size: tuple[int, int]) -> Any:
    try:
        model.vis.global_.offheight = max(model.vis.global_.offheight, size[0])
        model.vis.global_.offwidth = max(model.vis.global_.offwidth, size[1])
        return mujoco.Renderer(model, *size)
    except Exception as error:  # each kind of OpenGL fails with exceptions of its own
        raise gymnasium.error.DependencyNotInstalled(
            f"render_mode='rgb_array' needs OpenGL ({error}); without a screen install EGL or OSMesa, on Debian and "
            "Ubuntu libegl1 or libosmesa6, and set MUJOCO_GL=egl or MUJOCO_GL=osmesa before Python starts"
        ) from error


def _viewer(model: Model, data: Any) -> Any:
    if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise gymnasium.error.DependencyNotInstalled(  # the viewer would end the process
            "render_mode='human' needs a screen: DISPLAY and WAYLAND_DISPLAY are not set; use render_mode='rgb_array'"
        )
    import mujoco.viewer

    return mujoco.viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False)


def _add(scene: Any, markers: tuple[Marker, ...]) -> None:
    for marker in markers:
        if scene.ngeom < scene.maxgeom:
            geom = scene.geoms[scene.ngeom]
            size, color = np.full(3, marker.radius), np.array(marker.rgba, dtype=np.float32)
            mujoco.mjv_initGeom(geom, mujoco.mjtGeom.mjGEOM_SPHERE, size, marker.position, np.eye(3).ravel(), color)
            scene.ngeom += 1
