"""How closely position motors follow, stop and hold in MuJoCo: files of an earlier conversion against new ones.

Each motor with computed gains is moved alone, from the initial pose, without contacts: a sine of 0.5 Hz and 0.3 rad (30
mm), within the range of its joint, and a step of 0.5 rad (0.1 m), or of half the range. A floating base has no gravity.

What effort limits cost is in two further tables: the motors that could not brake that step otherwise, with the least
damping for which it overshoots by 5 % either way, by halving; and the overshoot of steps from random postures, in which
a joint may be heavier.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from stepbot.formats import format_named
from stepbot.geometry.spatial import Array

SINE, STEP, SLIDE = 0.3, 0.5, 0.1
"""Amplitude and step [rad]; of a sliding joint, both times this [m/rad] or [m]."""
_FREQUENCY = 0.5
_SETTLE, _STEPPED = 0.5, 1.5
"""Time [s] before each motion, and after a step."""
POSTURES, SINGLE = 10, 2
"""Postures per robot; the first of MuJoCo's types of joints with one degree of freedom."""
_OVERSHOOT, _HALVINGS = 0.05, 9
"""Overshoot that drive tests allow; halvings of the interval in which the least damping is sought."""


class Response(NamedTuple):
    """The worst of a robot's motors."""

    lag: float
    """Amplitude of the error of the sine, relative to its own."""
    overshoot: float
    """Relative to the step."""
    error: float
    """At rest after the step [rad] or [m]."""
    speed: float
    """Largest speed after the step, relative to the limit."""


class _Robot:
    """The MJCF of an output folder, in MuJoCo."""

    def __init__(self, folder: Path) -> None:
        import mujoco

        document = json.loads((folder / "report.json").read_text(encoding="utf-8"))["robot"]
        self._engine = mujoco
        file = folder / f"{format_named('mjcf').stem(document['name'])}{format_named('mjcf').suffix}"
        self.model: Any = mujoco.MjModel.from_xml_path(str(file))
        self.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        if self.model.njnt and self.model.jnt_type[0] == mujoco.mjtJoint.mjJNT_FREE:
            self.model.opt.gravity[:] = 0.0
        self.data = mujoco.MjData(self.model)
        self._posture: dict[int, float] = {}
        """Positions, by place in ``qpos``, in place of those at home."""
        limits = {joint["name"]: joint["limits"]["velocity"] for joint in document["joints"]}
        self.motors = [
            (self.model.actuator(one["name"]).id, limits[one["joint"]])
            for one in document["actuators"]
            if one["kind"] == "position" and one["computed"] is not None
        ]

    def response(self, actuator: int, limit: float | None) -> Response:
        """The response of one motor."""
        slides, low, high, home = self._choose(actuator)
        amplitude = min(SINE * (SLIDE if slides else 1.0), 0.45 * (high - low))
        middle = min(max(home, low + amplitude), high - amplitude)
        lag = self._lag(middle, amplitude)
        end = self._ends(slides, low, high, home)[0]
        positions, fastest = self._stepped(end)
        beyond = max(0.0, _overshoot(positions, home, end))
        return Response(lag, beyond, abs(float(positions[-1]) - end), fastest / limit if limit else 0.0)

    def _choose(self, actuator: int) -> tuple[bool, float, float, float]:
        """Move this motor from now on: whether its joint slides, the range of the joint, and where it rests."""
        model = self.model
        joint = int(model.actuator_trnid[actuator][0])
        self._q, self._v = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        self._actuator, self._gear = actuator, float(model.actuator_gear[actuator][0])
        slides = bool(model.jnt_type[joint] == self._engine.mjtJoint.mjJNT_SLIDE)
        low, high = model.jnt_range[joint].tolist() if model.jnt_limited[joint] else (-np.inf, np.inf)
        self._rest()
        return slides, low, high, float(self.data.qpos[self._q])

    @staticmethod
    def _ends(slides: bool, low: float, high: float, home: float) -> list[float]:
        """Where steps from a position end within the range."""
        size = min(SLIDE if slides else STEP, 0.5 * (high - low))
        return [end for end in (home + size, home - size) if low <= end <= high]

    def overshoots_elsewhere(self, random: np.random.Generator) -> Iterator[tuple[str, float]]:
        """Each motor that a step from a posture drawn at random is within the range of, and its overshoot."""
        model = self.model
        single = [joint for joint in range(model.njnt) if model.jnt_limited[joint] and model.jnt_type[joint] >= SINGLE]
        self._posture = {int(model.jnt_qposadr[one]): float(random.uniform(*model.jnt_range[one])) for one in single}
        for actuator, _ in self.motors:
            name = model.joint(int(model.actuator_trnid[actuator][0])).name
            slides, low, high, home = self._choose(actuator)
            for end in self._ends(slides, low, high, home):
                yield name, max(0.0, _overshoot(self._stepped(end)[0], home, end))

    def least_damping(self, actuator: int) -> tuple[float, float]:
        """The damping / kp [s] of a motor, and the least one for which a step either way overshoots by 5 % at most."""
        model = self.model
        slides, low, high, home = self._choose(actuator)
        ends = self._ends(slides, low, high, home)
        kp, kv = -float(model.actuator_biasprm[actuator][1]), -float(model.actuator_biasprm[actuator][2])
        others = float(model.actuator_damping[actuator]) + float(model.dof_damping[self._v]) / self._gear**2

        def overshoots(kv: float) -> bool:
            model.actuator_biasprm[actuator][2] = -kv
            return any(_overshoot(self._stepped(end)[0], home, end) > _OVERSHOOT for end in ends)

        least, most = 0.0, kv
        if not overshoots(0.0):
            most = 0.0
        for _ in range(_HALVINGS if most else 0):
            middle = 0.5 * (least + most)
            least, most = (middle, most) if overshoots(middle) else (least, middle)
        model.actuator_biasprm[actuator][2] = -kv
        return (kv + others) / kp, (most + others) / kp

    def _rest(self) -> None:
        """Everything at home."""
        model, data = self.model, self.data
        self._engine.mj_resetData(model, data)
        if model.nkey:
            self._engine.mj_resetDataKeyframe(model, data, 0)
        for place, position in self._posture.items():
            data.qpos[place] = position
        for one in range(model.nu):
            place = int(model.jnt_qposadr[int(model.actuator_trnid[one][0])])
            held = model.actuator_biasprm[one][1] != 0.0
            data.ctrl[one] = data.qpos[place] * model.actuator_gear[one][0] if held else 0.0

    def _run(self, seconds: float) -> Iterator[float]:
        dt = float(self.model.opt.timestep)
        for n in range(1, round(seconds / dt) + 1):
            yield n * dt
            self._engine.mj_step(self.model, self.data)

    def _lag(self, middle: float, amplitude: float) -> float:
        w, times, errors = 2.0 * np.pi * _FREQUENCY, [], []
        self.data.ctrl[self._actuator] = self._gear * middle
        for _ in self._run(2.0 * _SETTLE):
            pass
        target = middle
        for time in self._run(2.0 / _FREQUENCY):
            if time > 1.0 / _FREQUENCY:
                times.append(time)
                errors.append(float(self.data.qpos[self._q]) - target)
            target = middle + amplitude * float(np.sin(w * time))
            self.data.ctrl[self._actuator] = self._gear * target
        phase, error = w * np.array(times), np.array(errors)
        return 2.0 * float(np.hypot(np.mean(error * np.cos(phase)), np.mean(error * np.sin(phase)))) / amplitude

    def _stepped(self, end: float) -> tuple[Array, float]:
        self._rest()
        for _ in self._run(_SETTLE):
            pass
        self.data.ctrl[self._actuator] = self._gear * end
        positions, fastest = [], 0.0
        for _ in self._run(_STEPPED):
            positions.append(float(self.data.qpos[self._q]))
            fastest = max(fastest, abs(float(self.data.qvel[self._v])))
        return np.array(positions), fastest


def _overshoot(positions: Array, home: float, end: float) -> float:
    """The largest position beyond the last one, as a share of the step."""
    return float(((positions - positions[-1]) / (end - home)).max())


def worst(folder: Path) -> Response | None:
    """The worst of each over the motors of a robot with computed gains; None without any."""
    robot = _Robot(folder)
    found = [robot.response(actuator, limit) for actuator, limit in robot.motors]
    return Response(*(max(column) for column in zip(*found, strict=True))) if found else None


def following_table(before: Path, after: Path) -> list[str]:
    """Lines of a Markdown table: each robot that both folders have a subfolder of."""
    lines = ["| robot | lag | overshoot | error | speed of limit |", "| --- | --- | --- | --- | --- |"]
    for folder in sorted(after.iterdir()):
        if not (folder / "report.json").is_file() or not (before / folder.name / "report.json").is_file():
            continue
        old, new = worst(before / folder.name), worst(folder)
        if old is not None and new is not None:
            cells = [
                f"{100 * old.lag:.1f} → {100 * new.lag:.1f} %",
                f"{100 * old.overshoot:.1f} → {100 * new.overshoot:.1f} %",
                f"{1e3 * old.error:.1f} → {1e3 * new.error:.1f} mrad",
                f"{100 * old.speed:.0f} → {100 * new.speed:.0f} %",
            ]
            lines.append(f"| {' | '.join((folder.name, *cells))} |")
    return lines


def limits_tables(folder: Path) -> list[str]:
    """Lines of two Markdown tables about the output folders in a folder: damping and overshoot with limited effort."""
    folders = [one for one in sorted(folder.iterdir()) if (one / "report.json").is_file()]
    return [*_braking_table(folders), "", *_posture_table(folders)]


def _braking_table(folders: list[Path]) -> list[str]:
    """Each motor whose damping is above its ratio."""
    lines = ["| robot | joint | effort | inertia | lag | least |", "| --- | --- | --- | --- | --- | --- |"]
    for one in folders:
        document = json.loads((one / "report.json").read_text(encoding="utf-8"))["robot"]
        efforts = {joint["name"]: joint["limits"]["effort"] for joint in document["joints"]}
        braked = [motor for motor in document["actuators"] if motor["computed"] and motor["computed"]["braked"]]
        robot = _Robot(one) if braked else None
        for motor in braked if robot else ():
            lags = [
                2.0 * np.pi * _FREQUENCY * time for time in robot.least_damping(robot.model.actuator(motor["name"]).id)
            ]
            effort = min(filter(None, (efforts[motor["joint"]], motor["limits"]["effort"])))
            cells = (
                f"{effort:.3g} N m",
                f"{motor['computed']['inertia']:.3g} kg m²",
                *(f"{100 * lag:.1f} %" for lag in lags),
            )
            lines.append(f"| {' | '.join((one.name, motor['joint'], *cells))} |")
    return lines


def _posture_table(folders: list[Path]) -> list[str]:
    """The motor of each robot without loops that overshoots most from random postures, and the median of all."""
    lines = ["| robot | joint | largest overshoot | median |", "| --- | --- | --- | --- |"]
    for one in folders:
        robot, random = _Robot(one), np.random.Generator(np.random.PCG64(1))
        if not robot.motors or json.loads((one / "report.json").read_text(encoding="utf-8"))["robot"]["closures"]:
            continue
        found = [pair for _ in range(POSTURES) for pair in robot.overshoots_elsewhere(random)]
        joint, most = max(found, key=lambda pair: pair[1])
        middle = float(np.median([beyond for _, beyond in found]))
        lines.append(f"| {one.name} | {joint} | {100 * most:.1f} % | {100 * middle:.1f} % |")
    return lines
