"""A xacro as the source of a conversion: arguments, places of errors, and what its expressions cannot do."""

from pathlib import Path

import numpy as np
import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.engines.macros.expansion import expand
from stepbot.engines.macros.expressions import Expansion
from stepbot.engines.observation import Quantity
from stepbot.jobs.incremental import check, convert
from stepbot.pipeline.conversion import Options
from stepbot.runtime.worker import Worker
from stepbot.verification import admission
from stepbot.verification.files import compare_two, verify_files

HEAD = '<robot name="legs" xmlns:xacro="http://www.ros.org/wiki/xacro">'
LEGS = f"""{HEAD}
<xacro:arg name="length" default="0.5"/>
<xacro:property name="L" value="$(arg length)"/>
<xacro:include filename="$(find legs_description)/urdf/leg.xacro"/>
<link name="base"/>
<xacro:leg name="left" side="1"/>
<xacro:leg name="right" side="${{-1}}"/>
</robot>
"""
LEG = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:macro name="leg" params="name side">
  <link name="${name}">
    <inertial><origin xyz="0 0 ${L/2}"/><mass value="${2*L}"/>
      <inertia ixx="${2*L*L*L/12}" iyy="${2*L*L*L/12}" izz="${L/1000}" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><mesh filename="package://legs_description/meshes/foot.obj"/></geometry></collision>
  </link>
  <joint name="${name}_hip" type="revolute">
    <origin xyz="0 ${side*0.1} 0" rpy="0 ${radians(90)} 0"/><parent link="base"/><child link="${name}"/>
    <limit lower="-1" upper="1" effort="10" velocity="3"/>
  </joint>
</xacro:macro>
</robot>
"""
FOOT = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


@pytest.fixture
def legs(tmp_path: Path) -> Path:
    """A package with a xacro that includes another one."""
    package = tmp_path / "src" / "legs_description"
    texts = {"package.xml": "<package/>", "urdf/legs.urdf.xacro": LEGS, "urdf/leg.xacro": LEG, "meshes/foot.obj": FOOT}
    for name, text in texts.items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(text, encoding="utf-8")
    return package / "urdf" / "legs.urdf.xacro"


def expanded(file: Path, **arguments: str) -> Expansion:
    """What a file expands to, in a process of its own."""
    with Worker(f"{expand.__module__}:{expand.__name__}") as worker:
        found: Expansion = worker.submit(str(file), arguments, ()).result(60.0)
    return found


def expanded_body(tmp_path: Path, body: str) -> Expansion:
    """What the elements of a robot expand to; the first is in line 2."""
    file = tmp_path / "robot.urdf.xacro"
    file.write_text(f"{HEAD}\n{body}\n</robot>\n", encoding="utf-8")
    return expanded(file)


@pytest.mark.slow
def test_a_robot_is_converted_with_its_arguments(legs: Path, tmp_path: Path) -> None:
    """Masses and poses follow the argument, the mesh is found, and engines confirm the files."""
    options = Options(tmp_path / "out", formats=("mjcf", "urdf"), base="fixed", xacro=(("length", "0.25"),))
    conversion = convert(legs, options)
    assert not conversion.diagnostics.has_errors, list(map(str, conversion.diagnostics))
    robot = conversion.robot
    assert robot is not None
    assert [link.mass_properties.mass for link in robot.links] == [0.0, 0.5, 0.5]
    assert [joint.X_PC.position for joint in robot.joints] == [(0.0, 0.1, 0.0), (0.0, -0.1, 0.0)]
    np.testing.assert_allclose(robot.joints[0].X_PC.rpy, (0.0, np.pi / 2, 0.0), atol=1e-12)
    assert robot.mesh_by_name
    assert conversion.report is not None
    sources = {one.against.split(" ")[0] for one in conversion.report.checks if one.status == "passed"}
    assert "legs.urdf.xacro" in sources
    assert {"legs.urdf.xacro", "leg.xacro", "foot.obj"} <= {Path(name).name for name in conversion.report.inputs}


@pytest.mark.slow
def test_two_files_are_compared_with_their_macros_expanded(legs: Path, tmp_path: Path) -> None:
    """Engines load what a xacro expands to; only an argument differs from the expanded file."""
    diagnostics, workers, xacro = Diagnostics(), Options(tmp_path).workers, (("length", "0.25"),)
    report = verify_files([legs], diagnostics, workers=workers, xacro=xacro)
    assert not diagnostics.has_errors, list(map(str, diagnostics))
    assert {check.engine for check in report.checks if check.status == "passed"} >= {"mujoco", "yourdfpy"}
    plain = tmp_path / "legs.urdf"
    plain.write_bytes(expanded(legs, length="0.25").text)
    for given, masses in ((xacro, []), ((), [0.5, 0.5])):
        results = compare_two(legs, plain, diagnostics, workers, xacro=given)
        assert results is not None
        mass = next(one for one in results if one.quantity is Quantity.MASS)
        np.testing.assert_allclose([one.amount for one in mass.deviations.failures], masses)
    legs.with_name("leg.xacro").write_text(LEG.replace("foot.obj", "boot.obj"), encoding="utf-8")
    assert compare_two(legs, plain, diagnostics, workers) is None
    lost = next(one for one in diagnostics if one.code == "SB861")
    assert (Path(lost.span.file).name, lost.span.line) == ("leg.xacro", 6)


def test_relative_meshes_are_found_in_the_folders_above(legs: Path, tmp_path: Path) -> None:
    """They are relative to the URDF, which a xacro does not name; those of a URDF are also found by an option."""
    legs.with_name("leg.xacro").write_text(LEG.replace("package://legs_description", "."), encoding="utf-8")
    diagnostics = Diagnostics()
    check(legs, Options(legs.parent, base="fixed"), diagnostics)
    assert not list(diagnostics)
    plain = tmp_path / "legs.urdf"
    plain.write_bytes(expanded(legs).text.replace((legs.parents[1] / "meshes").as_posix().encode(), b"meshes"))
    for folders, missing in (((), True), ((legs.parents[1],), False)):
        diagnostics = Diagnostics()
        verify_files([plain], diagnostics, workers=Options(tmp_path).workers, packages=folders)
        assert diagnostics.has_errors is missing, list(map(str, diagnostics))
        assert ("SB861" in {one.code for one in diagnostics}) is missing


def test_findings_have_the_line_that_states_them(legs: Path) -> None:
    """What is lost is at its line in the included file; a fault of the robot is, too."""
    leg = legs.with_name("leg.xacro")
    leg.write_text(LEG.replace("<limit ", '<safety_controller k_velocity="1"/><limit '), encoding="utf-8")
    diagnostics = Diagnostics()
    check(legs, Options(legs.parent, base="fixed"), diagnostics)
    lost = next(one for one in diagnostics if one.code == "SB860")
    assert (Path(lost.span.file).name, lost.span.line) == ("leg.xacro", 10)
    leg.write_text(LEG.replace('lower="-1"', 'lower="low"'), encoding="utf-8")
    wrong = Diagnostics()
    check(legs, Options(legs.parent, base="fixed"), wrong)
    fault = next(one for one in wrong if one.code == "SB823")
    assert (Path(fault.span.file).name, fault.span.line) == ("leg.xacro", 10)
    assert fault.message.startswith("'lower' of <limit> is 'low', not a number")


@pytest.mark.parametrize(
    ("body", "line", "message"),
    [
        ('<link name="a"/>\n<link name="${length}"/>', 3, "name 'length' is not defined"),
        ('\n<xacro:leg name="a"/>', 3, "unknown macro name: xacro:leg"),
        ('<link name="$(arg length)"/>', 2, "Undefined substitution argument length"),
        ('<xacro:include filename="$(find legs)/a.xacro"/>', 2, "package 'legs' not found"),
        ('<xacro:if value="perhaps"><link name="a"/></xacro:if>', 2, "not a boolean expression"),
        ('<xacro:macro name="m" params="a"><xacro:m a="${a}"/></xacro:macro><xacro:m a="1"/>', 2, "without end"),
        ('<link name="a">\n', 4, "not XML: mismatched tag"),
        ('<link name="${1 +}"/>', 2, "invalid syntax"),
    ],
)
def test_errors_have_their_place(tmp_path: Path, body: str, line: int, message: str) -> None:
    """Each error of a macro has the line of the element that causes it."""
    found = expanded_body(tmp_path, body)
    assert message in found.error
    assert found.at.line == line


def test_an_error_in_a_macro_has_its_line_and_its_call(tmp_path: Path) -> None:
    """The place is within the macro, and the note names the call."""
    macro = '<xacro:macro name="m" params="a">\n<link name="${1/a}"/></xacro:macro>'
    found = expanded_body(tmp_path, f'{macro}\n<xacro:m a="0"/>')
    assert (found.at.line, [one.line for one in found.calls]) == (3, [4])
    assert found.error.startswith("division by zero")


@pytest.mark.parametrize(("name", "help"), [("lenght", "did you mean 'length'?"), ("w", "arguments: length")])
def test_wrong_arguments_are_named(legs: Path, name: str, help: str) -> None:
    """An argument that the file does not declare is an error with the nearest one, or all."""
    diagnostics = Diagnostics()
    check(legs, Options(legs.parent, xacro=((name, "1"),)), diagnostics)
    fault = next(one for one in diagnostics if one.code == "SB877")
    assert fault.help == (help,)


def test_an_argument_that_is_used_need_not_be_declared(tmp_path: Path) -> None:
    """A file that others include uses the arguments of those, and can be expanded alone."""
    (tmp_path / "tool.obj").write_text(FOOT, encoding="utf-8")
    tool = tmp_path / "tool.urdf.xacro"
    mesh = "<visual><geometry><mesh filename='$(arg folder)/tool.obj'/></geometry></visual>"
    tool.write_text(f"<robot name='r'><link name='tool'>{mesh}</link></robot>", encoding="utf-8")
    options = Options(tmp_path / "out", verify=False, formats=("mjcf",), xacro=(("folder", str(tmp_path)),))
    conversion = convert(tool, options)
    assert conversion.robot is not None
    assert conversion.robot.mesh_by_name


def test_a_macro_that_nothing_expanded_is_named(tmp_path: Path) -> None:
    """A URDF whose file names have substitutions is a xacro."""
    urdf = tmp_path / "tool.urdf"
    mesh = "<visual><geometry><mesh filename='$(arg folder)/tool.obj'/></geometry></visual>"
    urdf.write_text(f"<robot name='r'><link name='tool'>{mesh}</link></robot>", encoding="utf-8")
    conversion = convert(urdf, Options(tmp_path / "out", verify=False, formats=("mjcf",)))
    error = next(one for one in conversion.diagnostics if one.code == "SB861")
    assert error.help[0].startswith("the name has a substitution of xacro: name the file .xacro")


@pytest.mark.parametrize(
    "expression",
    [
        "().__class__",
        "[x.__class__ for x in (1,)]",
        "(lambda: ().__class__)()",
        "(x for x in [1]).gi_frame.f_back.f_globals",
        "'a'.format(1)",
        "'a'.format_map(dict())",
        "python.type(1)",
        "python.vars(str)",
        "str.mro()",
        "xacro.load_yaml.func_globals",
        "xacro.message.__globals__",
        "__import__('os')",
        "open('/etc/passwd')",
        "xacro.load_yaml('/etc/passwd')",
        "xacro.load_yaml('../outside.yaml')",
        "(a := 1)",
    ],
)
def test_expressions_cannot_leave(tmp_path: Path, expression: str) -> None:
    """What leads from an expression to the interpreter, or to files elsewhere, is an error at its line."""
    (tmp_path / "outside.yaml").write_text("a: 1", encoding="utf-8")
    (tmp_path / "own").mkdir()
    body = f'<xacro:property name="e" value="1"/><link name="${{{expression}}}"/>'
    found = expanded_body(tmp_path / "own", body)
    assert found.error
    assert not found.text
    assert found.at.line == 2


@pytest.mark.slow
def test_files_and_environment_are_not_reached(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Includes stay in the package, also through links; variables of the environment are not set; no entities."""
    monkeypatch.setenv("SECRET", "42")
    own, other = tmp_path / "own", tmp_path / "other.xacro"
    own.mkdir()
    other.write_text(f"{HEAD}<link name='a'/></robot>", encoding="utf-8")
    (own / "link.xacro").symlink_to(other)
    for name in (other, "../other.xacro", "link.xacro", "/etc/passwd", "/dev/zero"):
        assert "outside of the package" in expanded_body(own, f'<xacro:include filename="{name}"/>').error
    assert "'SECRET' is not set" in expanded_body(own, '<link name="$(env SECRET)"/>').error
    assert b'name="none"' in expanded_body(own, '<link name="$(optenv SECRET none)"/>').text
    file = own / "robot.urdf.xacro"
    file.write_text(f'<!DOCTYPE robot [<!ENTITY a "b">]>{HEAD}<link name="&a;"/></robot>', encoding="utf-8")
    assert "document type" in expanded(file).error


@pytest.mark.slow
def test_the_process_runs_nothing_and_writes_nothing(tmp_path: Path) -> None:
    """Beneath the expressions, the interpreter itself refuses programs and files."""
    with Worker(f"{__name__}:barred") as worker:
        refused = worker.submit(str(tmp_path / "written")).result(60.0)
    assert refused == ["PermissionError"] * 4
    assert not (tmp_path / "written").exists()


def barred(file: str) -> list[str]:
    """Names of the exceptions of what a process must not do once macros are expanded."""
    import os
    import socket
    import subprocess

    from stepbot.engines.macros.expansion import _bar

    _bar()
    tries = (
        lambda: subprocess.run(["true"], check=False),
        lambda: os.system("true"),
        lambda: Path(file).write_text("", encoding="utf-8"),
        lambda: socket.create_connection(("127.0.0.1", 9)),
    )
    names = []
    for one in tries:
        try:
            one()
        except Exception as error:  # noqa: BLE001
            names.append(type(error).__name__)
    return names


def test_foreign_namespaces_and_texts_are_kept(tmp_path: Path) -> None:
    """Elements for simulators keep their namespace and their text."""
    found = expanded_body(tmp_path, '<gazebo><a:b xmlns:a="urn:x" c="&lt;1">two  &amp; three</a:b></gazebo>')
    assert not found.error
    assert b'<a:b xmlns:a="urn:x" c="&lt;1">two &amp; three</a:b>' in found.text


def test_without_xacro_the_remedy_is_its_command(legs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the package, the command that installs it is the remedy."""
    monkeypatch.setattr(admission, "find_spec", lambda name: None)
    diagnostics = Diagnostics()
    check(legs, Options(legs.parent), diagnostics)
    assert [(one.code, one.help) for one in diagnostics] == [("SB877", ("pip install 'stepbot[xacro]'",))]
