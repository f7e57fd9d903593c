"""Loading a sidecar: every key, every place, all errors at once."""

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepbot.diagnostics import Diagnostics
from stepbot.robot.model import ActuatorKind, Base, JointKind
from stepbot.sidecar.load import load_sidecar, parse_sidecar
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.origins import AxisOrigin, ExplicitOrigin, MateOrigin
from stepbot.sidecar.shapes import BoxShape, CollisionShape, MergedCollision, SphereShape
from tests.unit.sidecar.samples import FULL


def loaded(text: str, diagnostics: Diagnostics, path: str = "robots/arm.robot.yaml") -> Sidecar:
    """The sidecar of a text without errors."""
    sidecar = parse_sidecar(text, Path(path), diagnostics)
    assert sidecar is not None, list(map(str, diagnostics))
    return sidecar


def test_every_key_arrives(diagnostics: Diagnostics) -> None:
    """Each key of the format is read, in SI."""
    d = loaded(FULL, diagnostics).document
    assert (d.robot, d.base, d.step_density, d.mass) == ("follower", Base.FLOATING, "ignore", "mesh")
    assert d.root is not None
    assert isinstance(d.root.frame, AxisOrigin)
    assert d.root.frame.offset is not None
    assert d.root.frame.offset.xyz == (0, 0, -0.04)
    assert d.materials["pla"].density == 1240
    assert d.mesh.tolerance is not None
    assert (d.mesh.tolerance.relative, d.mesh.angle) == (0.001, pytest.approx(math.radians(10)))
    assert list(d.parts) == ["**/M3x8*", "**/XL-430*", "**/Cover"]
    assert d.parts["**/XL-430*"].mass == 0.0572
    assert d.parts["**/Cover"].visual is False
    assert d.parts["**/Cover"].collision is CollisionShape.NONE
    assert d.links["base"].collision == MergedCollision(merge=CollisionShape.HULL)
    assert d.links["shoulder"].collision is CollisionShape.HULL
    box, sphere = d.links["gripper"].collision  # type: ignore[misc, union-attr]
    assert isinstance(box, BoxShape)
    assert isinstance(sphere, SphereShape)
    assert (box.size, box.origin.rpy) == ((0.01, 0.02, 0.03), (0.0, math.pi / 2, 0.0))
    inertial = d.links["gripper"].inertial
    assert inertial is not None
    assert inertial.inertia is not None
    assert (inertial.mass, inertial.com, inertial.inertia.ixy) == (0.11, (0, 0, 0.02), -1e-7)
    assert d.joints["pan"].origin == "auto"
    assert d.joints["pan"].zero.value == pytest.approx(math.pi / 6)
    assert isinstance(d.joints["lift"].origin, MateOrigin)
    assert d.joints["lift"].axis == (0, 0, -1)
    assert isinstance(d.joints["grip"].origin, ExplicitOrigin)
    assert d.joints["grip"].origin.relative_to == "gripper"
    assert d.joints["grip"].axis == pytest.approx((0, math.sqrt(0.5), math.sqrt(0.5)))
    assert d.joints["grip"].dynamics.armature == 2e-6
    assert d.joints["grip"].mimic is not None
    assert d.joints["grip"].mimic.multiplier == -1
    assert (d.closures["pin"].type, d.closures["pin"].axis) == (JointKind.REVOLUTE, (0, 1, 0))
    assert d.frames["tool0"].link == "jaw"
    assert (d.actuators["motor"].kind, d.actuators["motor"].kp) == (ActuatorKind.POSITION, 100)
    assert d.sensors["imu"].type == "imu"


def test_step_path_is_relative_to_the_sidecar(diagnostics: Diagnostics) -> None:
    """`step` is relative to the folder of the sidecar."""
    assert loaded(FULL, diagnostics).step_path == Path("robots/cad/follower.step")


def test_places_of_values_and_keys(diagnostics: Diagnostics) -> None:
    """A value and a key have a place; a missing one has that of its nearest key above."""
    sidecar = loaded(FULL, diagnostics)
    lines = FULL.split("\n")
    value = sidecar.span("joints", "pan", "limits", "upper")
    assert lines[value.line - 1][value.column - 1 : value.end_column - 1] == "150 deg"
    key = sidecar.key_span("joints", "pan", "limits", "upper")
    assert lines[key.line - 1][key.column - 1 : key.end_column - 1] == "upper"
    absent = sidecar.span("joints", "pan", "dynamics", "damping")
    assert lines[absent.line - 1][absent.column - 1 : absent.end_column - 1] == "pan"
    item = sidecar.span("links", "base", "parts", 1)
    assert lines[item.line - 1][item.column - 1 : item.end_column - 1] == '"XL-430:1"'
    assert sidecar.span("nothing").line == 1
    assert value.file == "robots/arm.robot.yaml"


@pytest.mark.parametrize(
    ("origin", "form"),
    [
        ("auto", "str"),
        ("{}", "AutoOrigin"),
        ("{auto: true}", "AutoOrigin"),
        ("{radius: 4 mm}", "AutoOrigin"),
        ("{offset: {xyz: [0, 0, 1]}}", "AutoOrigin"),
        ("{xyz: [0, 0, 1]}", "ExplicitOrigin"),
        ("{relative_to: base}", "ExplicitOrigin"),
        ("{component: a}", "ComponentOrigin"),
        ("{center: a}", "CenterOrigin"),
        ("{axis_of: a, radius: 4 mm}", "AxisOrigin"),
        ("{mate: [a, b]}", "MateOrigin"),
    ],
)
def test_form_of_an_origin_is_determined_by_its_keys(origin: str, form: str, diagnostics: Diagnostics) -> None:
    """The form of an origin is determined by its keys; without one it is `auto`."""
    text = FULL.replace("    limits: {lower: -150", f"    origin: {origin}\n    limits: {{lower: -150", 1)
    assert type(loaded(text, diagnostics).document.joints["pan"].origin).__name__ == form


@pytest.mark.parametrize(
    ("parts", "index", "hint"),
    [
        ("[XL,XC-330 v1]", 0, 'quote a name that contains a comma: ["XL,XC-330 v1"]'),
        ("[a, XL,XC-330 v1, b]", 2, 'quote a name that contains a comma: ["XL,XC-330 v1"]'),
        ("[XL, XC-330 v1]", 0, ""),
        ('["XL,XC-330 v1"]', 0, ""),
        ("\n    - ID #71\n", 0, '"ID #71"'),
        ("\n    - ID # the base\n", 0, ""),
        ("[a]", 7, ""),
    ],
)
def test_quoting_hints(parts: str, index: int, hint: str, diagnostics: Diagnostics) -> None:
    """An unquoted path cut at a special character is explained where it matches nothing."""
    text = "version: 1\nrobot: arm\nstep: arm.step\nlinks:\n  base:\n    parts: " + parts + "\n"
    hints = loaded(text, diagnostics).quoting_hints("links", "base", "parts", index)
    assert hint in "".join(hints)
    assert bool(hint) == bool(hints)


def test_all_faults_at_once_in_the_order_of_the_file() -> None:
    """Syntax, schema and consistency errors are reported together, in the order of the file."""
    text = FULL.replace("robot: follower", "robot: follower\nrobot: leader")
    text = text.replace("base: floating", "base: hanging").replace("damping: 0.1", "dampng: 0.1")
    text = text.replace("child: shoulder", "child: shulder").replace("-inf, upper: 1}", "-inf, upper: 1 kg}")
    text = text.replace("lower: -1,", "lower: 2,").replace("kind: position", "kindd: position")
    diagnostics = Diagnostics()
    assert parse_sidecar(text, Path("a.robot.yaml"), diagnostics) is None
    # The actuator is not checked further: the requirements of its kind are unknown.
    assert [d.code for d in diagnostics] == ["SB107", "SB123", "SB120", "SB130:link", "SB124", "SB456", "SB120"]
    lines = [d.span.line for d in diagnostics]
    assert lines == sorted(lines)


def test_loading_twice_gives_equal_results(tmp_path: Path) -> None:
    """Loading twice gives equal documents and findings."""
    path = tmp_path / "a.robot.yaml"
    path.write_text(FULL, encoding="utf-8")
    first, second = load_sidecar(path, Diagnostics()), load_sidecar(path, Diagnostics())
    assert first is not None
    assert second is not None
    assert first.document == second.document


LINES = FULL.split("\n")


@pytest.mark.slow
@given(data=st.data())
def test_damaged_sidecars_end_in_diagnostics(data: st.DataObject) -> None:
    """Lines dropped, doubled, swapped or cut in a valid sidecar give a document or errors."""
    lines = list(LINES)
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(lines) - 1))
        action = data.draw(st.sampled_from(["drop", "double", "swap", "cut", "word"]))
        if action == "drop" and len(lines) > 1:
            del lines[at]
        elif action == "double":
            lines.insert(at, lines[at])
        elif action == "swap":
            lines[at], lines[at - 1] = lines[at - 1], lines[at]
        elif action == "cut":
            lines[at] = lines[at][: data.draw(st.integers(0, 40))]
        else:
            word = data.draw(st.sampled_from(["7", "nan", "[]", "{}", "-1", "'x y'", "*a", "true", "1 kg", "&b", ": "]))
            head, colon, _ = lines[at].rpartition(": ")
            lines[at] = head + colon + word
    diagnostics = Diagnostics()
    sidecar = parse_sidecar("\n".join(lines), Path("a.robot.yaml"), diagnostics)
    assert (sidecar is None) == diagnostics.has_errors
    for diagnostic in diagnostics:
        assert diagnostic.span.line <= len(lines)
        assert "\n" not in diagnostic.message
