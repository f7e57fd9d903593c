"""The environment that all tasks share: model, actions, observations, episodes, pictures."""

import os
import sys
from abc import ABC, abstractmethod
from collections.abc import Mapping
from os import PathLike
from typing import Any

import gymnasium
import mujoco
import numpy as np
from msgspec import Struct

from stepbot.engines.mujoco.model import collected_warnings
from stepbot.geometry.spatial import Array

from .configurations import Configurations, diverged
from .controls import Controls, home_control
from .model import Model, index, own_copy
from .observations import LARGEST, UNKNOWN, Observations

MODES = ("rgb_array", "human")
_OVERVIEW = "overview"


class Marker(Struct, frozen=True, eq=False):
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


Info = dict[str, Any]


class RobotEnv(gymnasium.Env, ABC):  # type: ignore[misc]
    """A robot in MuJoCo, moved by its actuators. A task defines the reward, :meth:`_judge`.

    Attributes:
        action_names: Name of each action: ``<actuator>/<what it sets>``.
        action_units: Unit of each action without ``normalise``.
        observation_names: Name of each observed number.
        observation_units: Its unit; empty for pure numbers, and where it is unknown.
        model: The compiled model.
        data: Its state.
        dt: Time [s] between two actions.
    """

    metadata: dict[str, Any] = {"render_modes": list(MODES), "render_fps": 25}  # noqa: RUF012
    period = 0.04
    """Time [s] between two actions, unless ``frame_skip`` is given."""
    mode = "target"
    """Mode of actions, unless ``action`` is given."""
    extra: tuple[tuple[str, str], ...] = ()
    """Names and units of what a task adds to the observation."""

    def __init__(
        self,
        model: str | PathLike[str] | Model,
        *,
        frame_skip: int | None = None,
        action: str | None = None,
        normalise: bool = True,
        max_speed: float | None = None,
        observe: str = "all",
        home: Mapping[str, float] | None = None,
        keyframe: str = "home",
        reset_noise: float = 0.02,
        render_mode: str | None = None,
        width: int = 480,
        height: int = 480,
        camera: str | None = None,
    ) -> None:
        """Make the environment.

        Args:
            model: MJCF file, whose ``.scene.xml`` is used if it is beside it, or a model of :func:`stepbot.gym.load`.
            frame_skip: Number of time steps between two actions; None for the task's period.
            action: ``target`` or ``rate``, see :class:`.controls.Controls`; None for the task's.
            normalise: Whether actions are between -1 and 1; otherwise they have their units.
            max_speed: Speed [rad/s or m/s] of the action 1 in the mode ``rate``; None for the file's velocity limits.
            observe: ``all``, ``state`` or ``sensors``, see :class:`.observations.Observations`.
            home: Positions [rad or m] of joints that differ from the keyframe, by name.
            keyframe: Name of the keyframe that is home; without one of this name, home is the model's reference pose.
            reset_noise: Share of each joint's range by which episodes start beside home.
            render_mode: ``rgb_array``, ``human`` or None.
            width: Width [pixels] of pictures.
            height: Height [pixels] of pictures.
            camera: Camera of pictures; None for ``overview`` of the scene if it is there.

        Raises:
            ValueError: The file cannot be compiled or has no actuators, or an argument does not fit it.
        """
        self.model = own_copy(model)
        step = float(self.model.opt.timestep)
        self.frame_skip = max(1, round(self.period / step)) if frame_skip is None else frame_skip
        if self.frame_skip < 1:
            raise ValueError(f"frame_skip must be at least 1, not {self.frame_skip}")
        self.dt = step * self.frame_skip
        self.metadata = {**self.metadata, "render_fps": max(1, round(1.0 / self.dt))}
        if observe == "state":
            self.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_SENSOR)
        self.data: Any = mujoco.MjData(self.model)
        self._configurations = Configurations(self.model, keyframe, home or {})
        self._controls = self._controlled(action or self.mode, normalise=normalise, max_speed=max_speed)
        self._observations = Observations(self.model, observe)
        self._noise = reset_noise
        self._pictures = Pictures(self.model, self.data, render_mode, (height, width), camera)
        self.render_mode = render_mode
        self.action_names, self.action_units = self._controls.names, self._controls.units
        values = self._observations.values
        self.observation_names = (*(v.name for v in values), *self._controls.targets, *(name for name, _ in self.extra))
        self.observation_units = (
            *(v.unit for v in values),
            *self._controls.target_units,
            *(unit for _, unit in self.extra),
        )
        self.action_space, self.observation_space = self._spaces()
        self._last: Array = np.zeros(len(self.observation_names))
        with collected_warnings():
            self._configurations.go_home(self.data)

    def _controlled(self, mode: str, *, normalise: bool, max_speed: float | None) -> Controls:
        place = self._configurations
        home = home_control(self.model, place.keyframe, place.q, place.changed)
        return Controls(self.model, home, mode=mode, normalise=normalise, max_speed=max_speed, period=self.dt)

    def _spaces(self) -> tuple[Any, Any]:
        low, high = (bound.astype(np.float32) for bound in self._controls.bounds)
        most = np.array([LARGEST.get(unit, UNKNOWN) for unit in self.observation_units])
        values = self._observations.values
        most[: len(values)] = np.minimum(most[: len(values)], [value.most for value in values])
        return gymnasium.spaces.Box(low, high, dtype=np.float32), gymnasium.spaces.Box(-most, most, dtype=np.float64)

    def reset(self, *, seed: int | None = None, options: Mapping[str, Any] | None = None) -> tuple[Array, Info]:
        """Begin an episode beside home; the same seed gives the same episode."""
        super().reset(seed=seed)
        with collected_warnings():
            self._begin(options or {})
            control = self._starting_control()
            self._controls.reset(control)
            self.data.ctrl[:] = self._controls.apply(np.zeros(self.model.nu)) if not self._controls.targets else control
            mujoco.mj_forward(self.model, self.data)
        self._pictures.show(self._markers())
        return self._observe(), self._state_info()

    def _starting_control(self) -> Array:
        """Position actuators whose targets move start by holding the joints where they are."""
        if not self._controls.targets:
            return self._controls.home
        changed = dict.fromkeys(range(self.model.njnt), 0.0)
        return home_control(self.model, self._configurations.keyframe, self.data.qpos, changed)

    def step(self, action: Array) -> tuple[Array, float, bool, bool, Info]:
        """Apply an action for ``dt``; actions outside of the space are clipped.

        Raises:
            ValueError: The action has another shape, or is not finite.
        """
        given = np.asarray(action, dtype=np.float64)
        if given.shape != self.action_space.shape or not np.isfinite(given).all():
            raise ValueError(f"an action must be {self.action_space.shape[0]} finite numbers, not {action!r}")
        given = np.clip(given, self.action_space.low, self.action_space.high)
        with collected_warnings() as warnings:
            self.data.ctrl[:] = self._controls.apply(given)
            mujoco.mj_step(self.model, self.data, self.frame_skip)
            if diverged(self.data):
                lost = {"diverged": True, "warnings": tuple(warnings), "is_success": False}
                return self._last.copy(), -1.0, True, False, lost
            mujoco.mj_kinematics(self.model, self.data)  # a step leaves the poses of its start
        self._pictures.show(self._markers())
        reward, terminated, info = self._judge(given)
        return self._observe(), reward, terminated, False, info

    def render(self) -> Any:
        """A picture (height, width, 3) with ``rgb_array``, else nothing.

        Raises:
            gymnasium.error.DependencyNotInstalled: There is no OpenGL to draw with.
        """
        return self._pictures.draw(self._markers())

    def close(self) -> None:
        """Close the window."""
        self._pictures.close()

    def _observe(self) -> Array:
        parts = (self._observations.read(self.data), self._controls.read(), self._extra())
        space = self.observation_space
        self._last = np.clip(np.concatenate(parts), space.low, space.high)
        return self._last.copy()

    def _range(self) -> tuple[Array, Array, Array]:
        low, high = self._controls.range
        return low, self._controls.home, high

    def _begin(self, options: Mapping[str, Any]) -> None:  # noqa: ARG002
        """Set the state in which an episode begins."""
        self._configurations.draw(self.data, self.np_random, self._noise, self._range(), lift=True)

    def _extra(self) -> Array:
        """What a task adds to the observation."""
        return np.zeros(0)

    def _state_info(self) -> Info:
        """Further values about a state, for ``info``."""
        return {}

    @abstractmethod
    def _judge(self, action: Array) -> tuple[float, bool, Info]:
        """Reward of the state after an action, whether it ends the episode, and what it consists of."""

    def _markers(self) -> tuple[Marker, ...]:
        """What pictures show beside the robot."""
        return ()
