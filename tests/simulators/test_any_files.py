"""``verify_files`` on any files: engines against each other, and files against each other."""

import re
import sys
from pathlib import Path

import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.engines import engine_of, engines
from stepbot.engines.workers import check_required
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from stepbot.report.robot import Report, Status
from stepbot.robot.surfaces import Surface
from stepbot.runtime.worker import Workers
from stepbot.verification.files import verify_files
from tests.conftest import ReadDiagnostics
from tests.robots import ROBOTS, two_link_arm
from tests.simulators.conftest import Folder, skip_without, write

INSTALLED = {engine.name for engine in engines() if engine.available() is None}


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Folder:
    """The two-link arm on disk."""
    return write(ROBOTS["two_link_arm"](), tmp_path_factory.mktemp("arm"))


def _copy(folder: Folder, written_in: str, name: str, *changes: tuple[str, str]) -> Path:
    """A copy of a file in its folder, with some text replaced."""
    right = folder.written[written_in].path
    text = right.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    wrong = right.with_name(name)
    wrong.write_text(text, encoding="utf-8")
    return wrong


def _failed(report: Report) -> set[tuple[str, str]]:
    return {(check.engine, check.quantity) for check in report.checks if check.status is Status.FAILED}


def _is_another_robot(name: str, format_: str) -> bool:
    """Whether a format that is not a default one reports a loss: a mimic left out, a stand-in for a missing mass."""
    diagnostics = Diagnostics()
    if format_ in FORMATS and not FORMATS[format_].default:
        lower(ROBOTS[name](), FORMATS[format_], diagnostics)
    return any(diagnostic.severity == "warning" for diagnostic in diagnostics)


@pytest.mark.slow
@pytest.mark.mujoco
@pytest.mark.parametrize(
    "name", ["two_link_arm", *(pytest.param(name, marks=pytest.mark.long) for name in ("gripper_with_mimic", "tree"))]
)
def test_three_formats_are_the_same_robot(name: str, tmp_path: Path) -> None:
    """Three formats of one robot pass, each alone and against the first; the joint table has the names of all joints.

    MuJoCo, which is asked first, drops those of fixed joints of a URDF.
    """
    skip_without("mujoco")
    robot = ROBOTS[name]()
    folder = write(robot, tmp_path)
    diagnostics = Diagnostics()
    same = [one.path for format_, one in folder.written.items() if not _is_another_robot(name, format_)]
    report = verify_files(same, diagnostics, workers=Workers(120.0))
    assert not list(diagnostics)
    assert not report.failed
    names = {row.name for row in report.joint_table}
    assert "" not in names
    assert names >= {joint.name for joint in robot.joints}
    first = folder.written["urdf"].path.as_posix()
    across = {row.file: row for row in report.rows() if row.against == f"{first} (mujoco)"}
    assert set(across) == {path.as_posix() for path in same} - {first}
    for row in across.values():
        assert {"links", "joints", "mass", "inertia", "poses", "mass matrix", "meshes"} <= set(row.compared)


@pytest.mark.slow
@pytest.mark.mujoco
@pytest.mark.usefixtures("brief")
def test_a_difference_between_files_is_found(arm: Folder, diagnostics: ReadDiagnostics) -> None:
    """Another mass in one file is reported with both files, the quantity, the link and the number."""
    skip_without("mujoco")
    right = arm.written["urdf"].path
    wrong = _copy(arm, "mjcf", "heavy.xml", ('mass="0.972', 'mass="0.973'))
    report = verify_files([right, wrong], diagnostics, workers=Workers(120.0))
    assert ("mujoco", "mass") in _failed(report)
    assert ("mujoco", "poses") not in _failed(report)
    masses = next(one for one in diagnostics if one.code == "SB803" and ": mass: " in one.message)
    assert masses.span.file == wrong.as_posix()
    assert masses.message.startswith(
        f"mujoco against {right.as_posix()} (mujoco): mass: mass of link 'upper_arm': 0.001 kg"
    )
    assert diagnostics.exit_code == 1


@pytest.mark.usefixtures("brief")
def test_a_mass_that_one_engine_invents(arm: Folder, diagnostics: ReadDiagnostics) -> None:
    """A link without ``<inertial>`` has no mass, and 1 kg in PyBullet: a warning, and the rest is compared."""
    for engine in ("mujoco", "pybullet"):
        skip_without(engine)
    zero = '<mass value="0"/>'
    text = arm.written["urdf"].path.read_text(encoding="utf-8")
    start = text.index("<inertial>", text.index('<link name="tool0">'))
    inertial = text[start : text.index("</inertial>", start) + len("</inertial>")]
    assert zero in inertial
    path = arm.written["urdf"].path.with_name("no_inertial.urdf")
    path.write_text(text[:start] + text[start + len(inertial) :], encoding="utf-8")
    report = verify_files([path], diagnostics, workers=Workers(120.0))
    assert _failed(report) == {("pybullet", "warnings")}
    assert diagnostics.codes() == ["SB813"]
    assert "1 kg for a link without <inertial>; compared with 0: tool0" in str(next(iter(diagnostics)))


@pytest.mark.skipif(sys.platform == "win32", reason="no signals")
def test_an_engine_that_dies_is_a_diagnostic(arm: Folder, diagnostics: ReadDiagnostics) -> None:
    """Two roots crash PyBullet; the results of the other engines are still reported."""
    skip_without("pybullet")
    path = _copy(arm, "urdf", "two_roots.urdf", ('<link name="base">', '<link name="other"/><link name="base">'))
    report = verify_files([path], diagnostics, workers=Workers(120.0))
    assert ("pybullet", "load") in _failed(report)
    (death,) = (diagnostic for diagnostic in diagnostics if diagnostic.code == "SB802")
    assert death.message == "pybullet: killed by SIGSEGV"
    assert any("multiple root links" in note for note in death.notes)


def test_files_that_are_none(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A missing file, one that is not XML, and another kind of XML are reported; the others are verified."""
    (tmp_path / "broken.urdf").write_text("<robot", encoding="utf-8")
    (tmp_path / "page.xml").write_text("<html/>", encoding="utf-8")
    (tmp_path / "empty.sdf").write_bytes(b"")
    (tmp_path / "step.xml").write_text("ISO-10303-21;", encoding="utf-8")
    names = ("missing.urdf", "broken.urdf", "page.xml", "empty.sdf", "step.xml")
    report = verify_files([tmp_path / name for name in names], diagnostics)
    (line,) = (one for one in diagnostics if one.span.file.endswith("step.xml"))
    assert line.span.line == 1
    assert "correct this line" in line.help[0]
    codes = {diagnostic.span.file.rsplit("/", 1)[1]: diagnostic.code for diagnostic in diagnostics}
    assert codes.pop("missing.urdf") == "SB001"
    assert codes.pop("page.xml") == "SB814"
    assert codes.pop("empty.sdf") == "SB814"
    assert codes.pop("step.xml") == "SB814"
    assert codes.pop("broken.urdf") in ("SB814", "SB801")
    assert report.rows() == () or {row.file.rsplit("/", 1)[1] for row in report.rows()} == {"broken.urdf"}


def test_a_required_engine_that_is_unknown_or_missing(
    arm: Folder, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An unknown or missing required engine is SB005, with a similar name, and exit code 2."""
    monkeypatch.setattr(engine_of("mujoco"), "available", lambda: "mujoco is not installed")
    report = verify_files([arm.written["mjcf"].path], diagnostics, require=("mujoko", "mujoco"), workers=Workers(120.0))
    unknown, missing = (diagnostic for diagnostic in diagnostics if diagnostic.code == "SB005")
    assert unknown.help == ("did you mean 'mujoco'?",)
    assert missing.message == "--require mujoco: mujoco is not installed"
    assert diagnostics.exit_code == 2
    assert all(check.status is not Status.PASSED for check in report.checks if check.engine == "mujoco")


@pytest.mark.parametrize(
    ("engine", "install"),
    [
        ("drake", "pip install 'stepbot[verify]'"),
        ("pinocchio", "pip install 'stepbot[verify]'"),
        ("libsdformat", "apt-get install libsdformat-dev ignition-tools"),
        ("yourdfpy", "pip install yourdfpy"),
    ],
)
def test_a_missing_required_engine_names_its_package(
    engine: str, install: str, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """SB005 names the package to install, which may differ from the engine's name."""
    monkeypatch.setattr(engine_of(engine), "available", lambda: f"{engine} is not installed")
    check_required((engine,), diagnostics)
    (missing,) = diagnostics
    assert (missing.code, missing.help) == ("SB005", (install,))


def test_a_file_without_an_engine_is_a_warning(
    arm: Folder, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file without an engine that reads it is a warning, since nothing passed."""
    for engine in engines():
        monkeypatch.setattr(engine, "available", lambda: "not installed")
    report = verify_files([arm.written["mjcf"].path], diagnostics)
    assert diagnostics.codes() == ["SB815"]
    assert {check.status for check in report.checks} == {Status.NOT_RUN}


@pytest.mark.usefixtures("brief")
def test_the_same_file_twice_is_one(arm: Folder) -> None:
    """A path given twice is not compared with itself."""
    diagnostics = Diagnostics()
    path = arm.written["sdf"].path
    report = verify_files([path, path], diagnostics, workers=Workers(120.0))
    assert not list(diagnostics)
    assert {check.against for check in report.checks} == {"itself", "reader"} & ({"itself"} | INSTALLED)


@pytest.mark.usefixtures("brief")
def test_names_of_files_are_those_of_the_user(
    arm: Folder, monkeypatch: pytest.MonkeyPatch, diagnostics: ReadDiagnostics
) -> None:
    """Relative paths stay relative in checks and messages."""
    monkeypatch.chdir(arm.path)
    name = arm.written["sdf"].path.name
    report = verify_files([Path(name)], diagnostics, workers=Workers(120.0))
    assert {check.file for check in report.checks} == {name}
    assert not diagnostics.codes()


@pytest.mark.slow
@pytest.mark.mujoco
@pytest.mark.parametrize(
    ("written_in", "old", "new", "quantity", "where"),
    [
        pytest.param("urdf", 'velocity="2"', 'velocity="2.02"', "limits", "velocity limit of joint 'elbow'"),
        pytest.param("urdf", '"kp">100', '"kp">101', "actuators", "kp of actuator 'shoulder_motor'"),
        pytest.param(
            *("mjcf", 'forcerange="-12.5', 'forcerange="-12.6', "actuators", "lowest force of actuator"),
            marks=pytest.mark.long,
        ),
        pytest.param(
            *("sdf", "<cmd_max>12.5", "<cmd_max>12.6", "actuators", "highest force of actuator"), marks=pytest.mark.long
        ),
        pytest.param("sdf", "<ambient>0.9", "<ambient>0.8", "shapes", "ambient colour of visual"),
    ],
)
@pytest.mark.usefixtures("brief")
def test_a_number_that_one_engine_reads_is_compared(
    written_in: str, old: str, new: str, quantity: str, where: str, arm: Folder, diagnostics: ReadDiagnostics
) -> None:
    """Each quantity is compared across files by an engine that reads it, not only by the first engine."""
    skip_without("mujoco")
    skip_without("yourdfpy")
    changed = _copy(arm, written_in, f"changed.{written_in}", (old, new))
    files = [changed if name == written_in else arm.written[name].path for name in ("urdf", "sdf", "mjcf")]
    report = verify_files(files, diagnostics, workers=Workers(120.0))
    assert quantity in {name for _, name in _failed(report)}
    assert any(where in diagnostic.message + "".join(diagnostic.notes) for diagnostic in diagnostics)


@pytest.mark.slow
@pytest.mark.mujoco
@pytest.mark.parametrize("side", ["a", pytest.param("b", marks=pytest.mark.long)])
@pytest.mark.usefixtures("brief")
def test_where_a_loop_closes_is_compared_with_the_file_that_has_loops(
    side: str, tmp_path: Path, diagnostics: ReadDiagnostics
) -> None:
    """A moved site in the MJCF differs from the closing joint of the SDFormat, even if the first file is a URDF."""
    skip_without("mujoco")
    folder = write(ROBOTS["four_bar"](), tmp_path)
    sites = folder.written["mjcf"].path.read_text(encoding="utf-8")
    (place,) = re.findall(rf'<site name="rocker_pin::{side}" class="mark" pos="([^"]*)"', sites)
    x, *rest = place.split()
    site = f'<site name="rocker_pin::{side}" class="mark" pos="'
    moved = _copy(folder, "mjcf", "moved.xml", (f"{site}{place}", f"{site}{' '.join([str(float(x) + 1e-6), *rest])}"))
    report = verify_files(
        [folder.written["urdf"].path, folder.written["sdf"].path, moved], diagnostics, workers=Workers(120.0)
    )
    assert _failed(report) == {("mujoco", "closures")}
    (wrong,) = diagnostics
    assert f"closure 'rocker_pin', point on link {side}: 1e-06 m off" in wrong.notes[0]


@pytest.mark.slow
@pytest.mark.parametrize("other", [Surface(friction=0.7), Surface(restitution=0.4)])
def test_formats_with_one_surface_per_link_have_that_with_most_friction(
    other: Surface, tmp_path: Path, diagnostics: ReadDiagnostics
) -> None:
    """A URDF of stepbot's was another robot than its own MJCF, unless all shapes of a link had one surface."""
    robot = two_link_arm()
    touched = Surface(friction=0.9, torsional=0.002), other
    link = robot.link_by_name["upper_arm"]
    shapes = tuple(
        replace(link.collisions[0], name=name, surface=one) for name, one in zip(("a", "b"), touched, strict=True)
    )
    mixed = tuple(replace(link, collisions=shapes) if one is link else one for one in robot.links)
    folder = write(replace(robot, links=mixed), tmp_path)
    files = [folder.written[name].path for name in ("urdf", "sdf", "mjcf")]
    assert not _failed(verify_files(files, diagnostics))
    text = files[0].read_text(encoding="utf-8")
    files[0].write_text(text.replace('lateral_friction value="0.9"', 'lateral_friction value="0.7"'), encoding="utf-8")
    assert _failed(verify_files(files, diagnostics))


_TURNED = """<mujoco model="turned"><compiler angle="radian"/><option timestep="0.001"/>
<worldbody><body name="base"><geom size="0.03"/><freejoint/>
<body name="a" pos="0 0 0.3"><joint name="a"/><geom size="0.01" pos="0.1 0 0"/>
<body name="b" pos="0 0 0.3"><joint name="b" axis="0 1 0"/><geom size="0.01" pos="0.1 0 0"/></body></body></body>
</worldbody>
<equality>
<joint joint1="a" joint2="b" polycoef="1.9 1 0 0 0" solref="0.002 0.5" solimp="0.99 0.999 0.001"/></equality>
<keyframe><key name="home" qpos="0 0 0.1 1 0 0 0 0 -1.9"/></keyframe></mujoco>"""


@pytest.mark.slow
def test_a_file_is_simulated_from_its_initial_pose(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """At 0 the joints of a mimic with an offset are far apart, and MuJoCo's simulation diverges."""
    (tmp_path / "turned.xml").write_text(_TURNED, encoding="utf-8")
    assert not _failed(verify_files([tmp_path / "turned.xml"], diagnostics))


_PARTS = (
    '<joint joint1="a" joint2="b" polycoef="0.1 1 0 0 0"/>',
    '<joint joint1="c" joint2="b" polycoef="0.2 1 0 0 0"/>',
    '<motor name="one" joint="b"/>',
    '<motor name="two" joint="d"/>',
    "0.3",
    "0.4",
)
_ORDERED = """<mujoco model="ordered"><worldbody><body name="base"><geom size="0.1"/>{bodies}</body></worldbody>
<equality>{0}{1}</equality><actuator>{2}{3}</actuator><keyframe><key name="home" ctrl="{4} {5}"/></keyframe></mujoco>"""


@pytest.mark.slow
@pytest.mark.parametrize("changed", ["", "0.1 1", "0.2 1", "0.3", "0.4"])
def test_order_of_constraints_and_actuators_means_nothing(
    changed: str, tmp_path: Path, diagnostics: ReadDiagnostics
) -> None:
    """Constraints without names, and controls of a keyframe, are compared by what they relate, not by their number."""
    joint = '<body name="{0}"><joint name="{0}" axis="0 1 0"/><geom size="0.01" pos="0.1 0 0"/></body>'
    bodies = "".join(map(joint.format, "abcd"))
    other = [part.replace(changed, "0.7" + changed[3:]) if changed else part for part in _PARTS]
    swapped = [other[index] for index in (1, 0, 3, 2, 5, 4)]
    for name, parts in (("a.xml", _PARTS), ("b.xml", swapped)):
        (tmp_path / name).write_text(_ORDERED.format(*parts, bodies=bodies), encoding="utf-8")
    assert bool(_failed(verify_files([tmp_path / "a.xml", tmp_path / "b.xml"], diagnostics))) == bool(changed)
