"""Joints that formats represent differently compare equal if they are equivalent, and different otherwise."""

from collections.abc import Callable
from importlib import import_module
from math import cos, sin
from pathlib import Path
from typing import Any

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.engines import engines
from stepbot.formats import FORMATS
from stepbot.report.robot import Status
from stepbot.verification.files import verify_files
from tests.mechanisms import MECHANISMS
from tests.simulators.conftest import Folder, skip_without, write

KINDS = ("ball", "universal", "cylindrical", "screw", "left_screw", "planar", "floating")
ENGINES = ("mujoco", "reader")
"""Engines that together read every default format; the others are omitted to save process starts."""

INERTIA = "0.01 0.02 0.025"


class InThisProcess:
    """Replaces the process of an engine; none of these files crashes one."""

    def __init__(self, function: str, **_limits: object) -> None:
        self._module, self._name = function.split(":")

    def __enter__(self) -> "InThisProcess":
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    def submit(self, *arguments: Any) -> "InThisProcess":
        """Store the request."""
        self._arguments = arguments
        return self

    def result(self, _timeout: float) -> Any:
        """The engine's observation."""
        return getattr(import_module(self._module), self._name)(*self._arguments)

    def close(self) -> None:
        """Do nothing."""


@pytest.fixture(autouse=True)
def _engines_in_this_process(brief: None, monkeypatch: pytest.MonkeyPatch) -> None:
    skip_without("mujoco")
    monkeypatch.setattr("stepbot.runtime.worker.Worker", InThisProcess)
    monkeypatch.setattr("stepbot.engines.workers.Worker", InThisProcess)
    for engine in engines():
        if engine.name not in ENGINES:
            monkeypatch.setattr(engine, "available", lambda: "left out")


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Folder]:
    """Files of a mechanism, written once."""
    folders: dict[str, Folder] = {}

    def of(kind: str) -> Folder:
        if kind not in folders:
            folders[kind] = write(MECHANISMS[kind](), tmp_path_factory.mktemp(kind))
        return folders[kind]

    return of


def differences(*files: Path) -> dict[str, list[str]]:
    """Differences between files, by quantity: the message and its notes."""
    diagnostics = Diagnostics()
    report = verify_files(files, diagnostics)
    across = [check for check in report.checks if check.against not in ("itself", *ENGINES)]
    assert {"links", "joints", "poses", "mass matrix", "gravity forces", "inverse dynamics"} <= {
        check.quantity for check in across if check.status is not Status.NOT_RUN
    }
    failed = {check.quantity for check in report.checks if check.status is Status.FAILED}
    reported = {one.message.split(": ")[1]: [one.message.split(": ", 2)[2], *one.notes] for one in diagnostics}
    assert set(reported) == failed
    return reported


def _changed(folder: Folder, written_in: str, *changes: tuple[str, str]) -> Path:
    """A copy of a file in its folder, with some text replaced."""
    right = folder.written[written_in].path
    text = right.read_text(encoding="utf-8")
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    wrong = right.with_name(f"changed{right.suffix}")
    wrong.write_text(text, encoding="utf-8")
    return wrong


def _joint(folder: Folder, name: str) -> str:
    """A joint's element in the URDF."""
    text = folder.written["urdf"].path.read_text(encoding="utf-8")
    start = text.index(f'<joint name="{name}"')
    return text[start : text.index("</joint>", start)]


def _changed_joint(folder: Folder, name: str, *changes: tuple[str, str]) -> Path:
    """The URDF with a text replaced in one joint."""
    right = _joint(folder, name)
    wrong = right
    for old, new in changes:
        assert old in wrong, old
        wrong = wrong.replace(old, new)
    return _changed(folder, "urdf", (right, wrong))


# The same


@pytest.mark.slow
@pytest.mark.mujoco
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("turned", [False, pytest.param(True, marks=pytest.mark.long)], ids=["first", "last"])
def test_every_kind_of_joint_is_the_same_in_all_formats(
    kind: str, turned: bool, written: Callable[[str], Folder]
) -> None:
    """A mechanism is the same in all formats that are written by default, in any order of files."""
    others = {name for name, one in FORMATS.items() if not one.default}  # they lack couplings, and report it
    paths = [one.path for name, one in written(kind).written.items() if name not in others]
    assert differences(*(reversed(paths) if turned else paths)) == {}


@pytest.mark.mujoco
def test_any_angles_make_a_ball_joint(written: Callable[[str], Folder]) -> None:
    """Three non-orthogonal axes that reach every rotation are equivalent to a ball joint."""
    folder = written("ball")
    leaning = _changed_joint(folder, "shoulder_roll", ('xyz="1 0 0"', 'xyz="1 0 0.75"'))
    assert differences(leaning, folder.written["mjcf"].path, folder.written["sdf"].path) == {}
    assert differences(folder.written["mjcf"].path, leaning) == {}


@pytest.mark.mujoco
def test_ball_joint_of_a_third_file(written: Callable[[str], Folder]) -> None:
    """Configurations are cleared of gimbal lock in a third file, too, where the first two have the same angles."""
    folder = written("ball")
    same = folder.written["urdf"].path.with_name("same.urdf")
    same.write_bytes(folder.written["urdf"].path.read_bytes())
    assert differences(folder.written["urdf"].path, same, folder.written["mjcf"].path) == {}


def _urdf(joints: str, links: str = "") -> str:
    inertia = '<inertia ixx="0.01" iyy="0.02" izz="0.025" ixy="0" ixz="0" iyz="0"/>'
    body = f'<inertial><origin xyz="0.1 0.2 -0.3"/><mass value="2"/>{inertia}</inertial>'
    return f"""<robot name="r"><link name="base"/>{links}<link name="body">{body}</link>{joints}</robot>"""


def _mjcf(joints: str, more: str = "") -> str:
    inertial = f'<inertial pos="0.1 0.2 -0.3" mass="2" diaginertia="{INERTIA}"/>'
    return f"""<mujoco model="r"><compiler angle="radian"/><worldbody>
        <body name="base"><body name="body" pos="0 0 0.5">{inertial}{joints}
        </body></body></worldbody>{more}</mujoco>"""


def _hinges(*limits: str) -> str:
    """Three hinges of a hip in one body of MJCF."""
    axes = {"hip_x": "1 0 0", "hip_z": "0 0 1", "hip_y": "0 1 0"}
    each = zip(axes.items(), limits, strict=True)
    return "".join(f'<joint name="{name}" axis="{axis}" {limit}/>' for (name, axis), limit in each)


LIMITS = ('range="-0.4 0.1"', 'range="-0.6 0.6"', 'range="-1.9 0.3"')


@pytest.fixture
def hip(tmp_path: Path) -> Path:
    """A hip of three joints in URDF, with massless links between them."""
    chain = ["base", "one", "two", "body"]
    joints = ""
    for number, (name, axis, lower, upper) in enumerate(
        [("hip_x", "1 0 0", -0.4, 0.1), ("hip_z", "0 0 1", -0.6, 0.6), ("hip_y", "0 1 0", -1.9, 0.3)]
    ):
        origin = "" if number else '<origin xyz="0 0 0.5"/>'
        joints += f"""<joint name="{name}" type="revolute">{origin}<parent link="{chain[number]}"/>
            <child link="{chain[number + 1]}"/><axis xyz="{axis}"/>
            <limit lower="{lower}" upper="{upper}" effort="1e9" velocity="1e9"/></joint>"""
    path = tmp_path / "hip.urdf"
    path.write_text(_urdf(joints, '<link name="one"/><link name="two"/>'), encoding="utf-8")
    return path


@pytest.mark.mujoco
def test_hinges_in_one_body_are_the_chain_of_a_urdf(hip: Path) -> None:
    """Three limited joints equal the hinges in one MJCF body; a changed limit is reported."""
    same = hip.with_name("same.xml")
    same.write_text(_mjcf(_hinges(*LIMITS)), encoding="utf-8")
    assert differences(hip, same) == {}
    wider = hip.with_name("wider.xml")
    wider.write_text(_mjcf(_hinges(LIMITS[0], 'range="-0.6 0.7"', LIMITS[2])), encoding="utf-8")
    assert differences(hip, wider) == {"limits": ["upper limit of joint 'hip_z': 0.1 rad off, 1.6e-09 allowed"]}


@pytest.mark.mujoco
def test_hinges_with_limits_are_no_ball_joint(hip: Path) -> None:
    """Three hinges with limits differ from a ball joint; the message names one of them."""
    ball = hip.with_name("ball.xml")
    ball.write_text(_mjcf('<joint name="hip" type="ball"/>'), encoding="utf-8")
    assert "(the limits of 'hip_x' are not those of a ball joint)" in differences(hip, ball)["joints"][0]


@pytest.mark.mujoco
def test_a_ball_joint_is_free_to_have_any_frame(tmp_path: Path) -> None:
    """A ball joint may have any frame: rotated in SDFormat, and on a rotated body in MJCF."""
    inertia = "<ixx>0.01</ixx><iyy>0.02</iyy><izz>0.025</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz>"
    none = "<inertial><mass>0</mass><inertia><ixx>0</ixx><iyy>0</iyy><izz>0</izz></inertia></inertial>"
    sdf = tmp_path / "ball.sdf"
    sdf.write_text(
        f"""<sdf version="1.9"><model name="r"><link name="base">{none}</link>
        <link name="body"><pose>0 0 0.5 0 0 0</pose>
        <inertial><pose>0.1 0.2 -0.3 0 0 0</pose><mass>2</mass><inertia>{inertia}</inertia></inertial></link>
        <joint name="fix" type="fixed"><parent>world</parent><child>base</child></joint>
        <joint name="hip" type="ball"><pose>0 0 0 0.4 -0.3 1.1</pose><parent>base</parent><child>body</child></joint>
        </model></sdf>""",
        encoding="utf-8",
    )
    for name, turned in (("straight.xml", ""), ("turned.xml", 'euler="0.5 0.6 0.7"')):
        mjcf = tmp_path / name
        text = _mjcf('<joint name="hip" type="ball"/>').replace('pos="0 0 0.5"', f'pos="0 0 0.5" {turned}')
        mjcf.write_text(text, encoding="utf-8")
        assert differences(sdf, mjcf) == {}
    aside = tmp_path / "aside.xml"
    aside.write_text(_mjcf('<joint name="hip" type="ball" pos="0 0 0.001"/>'), encoding="utf-8")
    assert differences(sdf, aside)["joints"] == ["joint 'hip': ball (the centres are 0.001 m apart), ball expected"]


@pytest.mark.mujoco
def test_initial_poses_of_a_ball_joint_and_of_its_angles(tmp_path: Path) -> None:
    """A keyframe with a quaternion equals one with the angles of the same rotation, and differs from others."""
    ball, angles = tmp_path / "ball.xml", tmp_path / "angles.xml"
    key = '<keyframe><key name="home" qpos="{}"/></keyframe>'
    quaternion = f"{cos(0.25)!r} 0 0 {sin(0.25)!r}"  # by 0.5 about z
    ball.write_text(_mjcf('<joint name="hip" type="ball"/>', key.format(quaternion)), encoding="utf-8")
    for turned, expected in (("0 0.5 0", set()), ("0.1 0.5 0", {"initial pose"})):
        angles.write_text(_mjcf(_hinges("", "", ""), key.format(turned)), encoding="utf-8")
        assert set(differences(ball, angles)) == expected


# Not the same


WRONG_BALLS: dict[str, tuple[str, tuple[tuple[str, str], ...], str, str]] = {
    "an axis turned": (
        "shoulder_pitch",
        (('xyz="0 1 0"', 'xyz="0.1 1 0"'),),
        "joints",
        "the axes of 'shoulder_pitch' and 'shoulder_roll' are 0.0997 rad from perpendicular",
    ),
    "an axis moved": (
        "shoulder_roll",
        (("<parent", '<origin xyz="0 0.001 0"/><parent'),),
        "joints",
        "the axes of 'shoulder_yaw', 'shoulder_pitch' and 'shoulder_roll' miss each other by",
    ),
    "a limit on one axis": (
        "shoulder_pitch",
        (("continuous", "revolute"), ("<limit", '<limit lower="-1.5" upper="1.5"')),
        "joints",
        "the limits of 'shoulder_pitch' are not those of a ball joint",
    ),
    "one joint slides": (
        "shoulder_yaw",
        (("continuous", "prismatic"), ("<limit", '<limit lower="-1e9" upper="1e9"')),
        "joints",
        "'shoulder_yaw', 'shoulder_pitch' and 'shoulder_roll' do not rotate as a ball joint does",
    ),
    "all moved": (
        "shoulder_yaw",
        (("0.02 0.1", "0.02 0.101"),),
        "joints",
        "joint 'shoulder': ball (the centres are 0.001 m apart)",
    ),
    "more damping": (
        "shoulder_roll",
        (('damping="0.02"', 'damping="0.03"'),),
        "dynamics",
        "damping of joint 'shoulder_roll': 0.01 SI off",
    ),
}


@pytest.mark.mujoco
@pytest.mark.parametrize("name", WRONG_BALLS)
def test_what_is_no_such_ball_joint_is_found(name: str, written: Callable[[str], Folder]) -> None:
    """Three joints that do not reach every rotation, intersect elsewhere, or resist differently are reported."""
    folder = written("ball")
    joint, changes, quantity, words = WRONG_BALLS[name]
    reported = differences(_changed_joint(folder, joint, *changes), folder.written["mjcf"].path)
    assert any(words in line for line in reported[quantity]), reported


@pytest.mark.mujoco
@pytest.mark.parametrize("kind", ["ball", "universal", "screw"])
def test_a_link_between_that_weighs_something_is_found(kind: str, written: Callable[[str], Folder]) -> None:
    """A link with mass between the joints makes them separate joints."""
    folder = written(kind)
    link, joint = {
        "ball": ("shoulder_pitch_link", "shoulder_roll"),
        "universal": ("cross_1_link", "cross_2"),
        "screw": ("spindle_slide_link", "spindle"),
    }[kind]
    text = folder.written["urdf"].path.read_text(encoding="utf-8")
    start = text.index(f'<link name="{link}"')
    right = text[start : text.index("</link>", start)]
    heavy = right.replace('<mass value="0"/>', '<mass value="0.01"/>').replace('xx="0"', 'xx="1e-6"')
    heavy = heavy.replace('yy="0"', 'yy="1e-6"').replace('zz="0"', 'zz="1e-6"')
    path = _changed(folder, "urdf", (right, heavy))
    for other in ("mjcf", "sdf"):
        reported = differences(path, folder.written[other].path)
        assert f"link '{link}' is missing" in reported["links"]
        assert any(f"'{joint}'" in line for line in reported["joints"])


WRONG: dict[str, tuple[str, str, tuple[tuple[str, str], ...], str, str]] = {
    "an axis of a universal joint turned": (
        "universal",
        "cross_2",
        (('xyz="0.8 0 -0.6"', 'xyz="0.8 0.01 -0.6"'),),
        "axes",
        "axis of joint 'cross_2': 0.01 rad off",
    ),
    "the axes of a universal joint apart": (
        "universal",
        "cross_2",
        (("<parent", '<origin xyz="0 0.001 0"/><parent'),),
        "joints",
        "the axes of 'cross_2' are 0.001 m apart",
    ),
    "a limit on one axis of a universal joint": (
        "universal",
        "cross_1",
        (("continuous", "revolute"), ("<limit", '<limit lower="-1.5" upper="1.5"')),
        "limits",
        "lower limit of joint 'cross_1'",
    ),
    "another lead of a screw": (
        "screw",
        "spindle_slide",
        (('multiplier="0.00031', 'multiplier="0.00032'),),
        "axes",
        "pitch of joint 'spindle': 1e-05 m/rad off",
    ),
    "a screw that is none": (
        "screw",
        "spindle_slide",
        (("<mimic", "<!-- "), ('7907"/>', "-->")),
        "joints",
        "'spindle_slide' and 'spindle' are of different kinds",
    ),
    "a screw whose slide is damped": (
        "screw",
        "spindle_slide",
        (("<mimic", '<dynamics damping="1000"/><mimic'),),
        "dynamics",
        "damping of joint 'spindle': 0.000101 SI off",
    ),
    "a screw whose slide is bounded": (
        "screw",
        "spindle_slide",
        (('upper="0.0095', 'upper="0.0085'),),
        "limits",
        "upper limit of joint 'spindle'",
    ),
    "a sleeve that turns about another axis": (
        "cylindrical",
        "sleeve_turn",
        (('xyz="0.6666666666666666', 'xyz="0.67'),),
        "axes",
        "axis of joint 'sleeve_turn'",
    ),
    "a table on another plane": (
        "planar",
        "table_x",
        (('<axis xyz="0.', '<axis xyz="0.1'),),
        "axes",
        "axis of joint 'table_x'",
    ),
}


@pytest.mark.mujoco
@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_such_joint_is_found(name: str, written: Callable[[str], Folder]) -> None:
    """A joint that differs is reported by the number, under the joint's name."""
    kind, joint, changes, quantity, words = WRONG[name]
    folder = written(kind)
    reported = differences(_changed_joint(folder, joint, *changes), folder.written["mjcf"].path)
    assert any(words in line for line in reported[quantity]), reported


@pytest.mark.mujoco
def test_a_ball_joint_that_is_held_in_a_cone(tmp_path: Path) -> None:
    """A MuJoCo ball joint with a limit cone differs from three joints without limits."""
    free, held = tmp_path / "free.xml", tmp_path / "held.xml"
    free.write_text(_mjcf(_hinges("", "", "")), encoding="utf-8")
    held.write_text(_mjcf('<joint name="hip" type="ball" range="0 1"/>'), encoding="utf-8")
    assert "(the limits of 'hip' are not those of a ball joint)" in differences(free, held)["joints"][0]
