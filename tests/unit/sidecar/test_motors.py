"""The catalogue of motors: its sources, its names, and what a motor gives its joint."""

import json
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from stepbot.diagnostics import Diagnostics
from stepbot.robot.model import ActuatorKind, JointKind
from stepbot.robot.motors import Motor
from stepbot.sidecar.load import load_sidecar
from stepbot.sidecar.motors import (
    AmbiguousMotor,
    NamedMotor,
    UnknownMotor,
    UnscalableMotor,
    bare,
    catalogue_motor,
    catalogue_names,
    find_motor,
    fitted,
    motors_named_in,
)
from stepbot.sidecar.schema import motors_schema_text
from stepbot.sidecar.vocabulary import meant_by
from tests.conftest import ROOT

REFERENCE = ROOT.parent / "shared" / "reference" / "motors.yaml"
GRADES = (
    *("data sheet", "maker page", "maker library", "maker name", "robot maker page", "identified", "measured"),
    *("model file", "reseller page", "community", "derived"),
)
CATALOGUE = ROOT / "src" / "stepbot" / "sidecar" / "motors.json"
VALUES = ("effort", "velocity", "armature", "friction", "damping")


def values(motor: Motor) -> dict[str, float]:
    """What a motor gives, by quantity."""
    return {one.quantity: one.value for one in motor.figures}


def fit(name: str, joint: JointKind = JointKind.REVOLUTE, voltage: float | None = None, gear: float = 1.0) -> Motor:
    """A motor of the catalogue on a joint."""
    return fitted(find_motor(name), joint, voltage, gear)


def test_each_figure_has_a_source_of_a_known_grade() -> None:
    """Each figure has a source of a known grade."""
    for name in catalogue_names():
        motor = catalogue_motor(name)
        for key, figure in motor.figures().items():
            assert figure.source.partition(":")[0] in GRADES, (name, key)
        for other in (*motor.at_other_voltages, *motor.alternatives):
            assert (other.source or "").partition(":")[0] in GRADES, name


ADDED = {"STS3215-12V": frozenset({"armature", "coulomb_friction"})}
"""Figures that the reference leaves out: the maker's simulation file uses them with this motor's stall torque."""


@pytest.mark.slow
@pytest.mark.skipif(not REFERENCE.exists(), reason=f"reference figures are absent: no {REFERENCE}")
def test_the_catalogue_has_the_figures_and_sources_of_the_reference() -> None:
    """The catalogue has the figures and sources of the reference."""
    from ruamel.yaml import YAML

    listed = YAML(typ="safe", pure=True).load(REFERENCE)["motors"]
    assert [one["key"] for one in listed] == list(catalogue_names())
    count = 0
    for one in listed:
        motor, added = catalogue_motor(one["key"]), ADDED.get(one["key"], frozenset())
        figures = motor.figures()
        assert figures.keys() - added == one["sources"].keys()
        for key, source in one["sources"].items():
            count += 1
            assert figures[key].source == source
            given = one[key]
            wanted = tuple(map(tuple, sorted(given.items()))) if isinstance(given, dict) else given
            assert figures[key].value == (tuple(wanted) if isinstance(wanted, list) else wanted), (one["key"], key)
        assert len(motor.alternatives) == len(one.get("alternatives", ()))
        kept = {key: doubt for key, doubt in motor.doubts.items() if key not in added}
        assert set(kept.values()) == {doubt for key, doubt in one.get("doubt", {}).items() if key not in added}
    assert count == 895


@pytest.mark.slow
def test_the_catalogue_has_the_form_of_a_users_own_file() -> None:
    """The catalogue has the form of a users own file."""
    schema = json.loads(motors_schema_text())
    Draft202012Validator.check_schema(schema)
    Draft202012Validator(schema).validate(json.loads(CATALOGUE.read_text(encoding="utf-8")))


def test_motors_are_found_by_any_of_their_names() -> None:
    """Motors are found by any of their names."""
    for name in catalogue_names():
        for one in (name, name.lower(), name.replace("-", "_"), *catalogue_motor(name).names):
            assert find_motor(one).name == name


def test_a_family_asks_which_member() -> None:
    """A family asks which member."""
    for name in catalogue_names():
        for family in catalogue_motor(name).family:
            with pytest.raises(AmbiguousMotor) as raised:
                find_motor(family)
            assert name in raised.value.members


@pytest.mark.parametrize("typed", ["STS-3215-7.4V", "sts 3215 7.4v", "sts3215_7.4V", " STS3215-7.4V"])
def test_separators_of_names_do_not_matter(typed: str) -> None:
    """Names are found with other separators, or none, and mean one motor each."""
    assert find_motor(typed).name == "STS3215-7.4V"
    joined = [bare(one).replace("-", "") for one in catalogue_names()]
    assert len(set(joined)) == len(joined)


def test_motors_named_with_their_maker_are_proposed() -> None:
    """The members of a family come before names that are spelled alike."""
    with pytest.raises(UnknownMotor) as raised:
        find_motor("dynamixel xm430")
    assert raised.value.nearest == ("XM430-W210", "XM430-W350")


def test_an_unknown_motor_has_neighbours() -> None:
    """An unknown motor has neighbours."""
    with pytest.raises(UnknownMotor) as raised:
        find_motor("XL43O-W250")
    assert raised.value.nearest[0] == "XL430-W250"
    with pytest.raises(UnknownMotor):
        find_motor("no such thing at all")


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("Dynamixel_XL430-W250-T v3", ("XL430-W250",)),
        ("28BYJ-48 stepper:1", ("28BYJ-48",)),
        ("STS3215_03a-v1", ("STS3215-7.4V", "STS3215-12V", "STS3215-C044", "STS3215-C046")),
        ("XL4301", ()),
        ("base plate", ()),
    ],
)
def test_names_in_cad_files(text: str, named: tuple[str, ...]) -> None:
    """Names in cad files."""
    assert motors_named_in(text) == named


def test_figures_of_other_sources_are_never_used() -> None:
    """Figures of other sources are never used."""
    for name in catalogue_names():
        motor = catalogue_motor(name)
        kind = JointKind.PRISMATIC if motor.max_force is not None else JointKind.REVOLUTE
        given = {one.quantity for one in fitted(NamedMotor(name, motor), kind, None, 1.0).figures}
        assert ("friction" in given) == (motor.coulomb_friction is not None)
        assert ("kp" in given) == (motor.position_gain is not None)
        assert ("mass" in given) == (motor.mass is not None)
    assert fit("XC330-T288").unknown == ("armature", "friction")


def test_back_emf_is_added_once_and_only_at_a_set_voltage() -> None:
    """Back emf is added once and only at a set voltage."""
    servo = fit("STS3215-7.4V")
    assert values(servo)["damping"] == pytest.approx(0.05909 + 0.5486)
    assert values(fit("eRob80-50"))["damping"] == 1.298  # current control
    # Where it is unknown, the line from stall to no load has the slope of both: 0.8336 N m at 0, 0 N m at 56.55 rad/s.
    assert values(fit("Pololu-37D-19"))["damping"] == pytest.approx(0.8336 / 56.55)


def test_numbers_of_the_makers_own_simulation_of_so101() -> None:
    """joints_properties.xml of SO-ARM100: damping 0.60, friction 0.052, armature 0.028, kp 17.8; forces disagree."""
    found = values(fit("STS3215-7.4V"))
    assert found["damping"] == pytest.approx(0.60, rel=0.02)
    assert found["friction"] == pytest.approx(0.052, rel=0.02)
    assert found["armature"] == pytest.approx(0.028, rel=0.02)
    assert found["kp"] == pytest.approx(17.8, rel=0.02)
    assert 1.9 < found["effort"] < 3.36


def test_motors_that_do_not_reach_their_speed() -> None:
    """At (effort - friction) / damping nothing is left; the share of the limit is that with any gear."""
    slow = {}
    for name in catalogue_names():
        motor = catalogue_motor(name)
        kind = JointKind.PRISMATIC if motor.max_force is not None else JointKind.REVOLUTE
        for gear in (1.0, 7.0):
            doubts = fitted(NamedMotor(name, motor), kind, None, gear).doubts
            slow[name, gear] = [one.rpartition(" %")[0].rpartition(" ")[2] for one in doubts if "reachable" in one]
    found = {key: share for key, (share, *_) in ((key, one) for key, one in slow.items() if one)}
    names = {"STS3215-7.4V": "56", "2XL430-W250": "81", "2XC430-W250": "86"}
    assert found == {(name, gear): share for name, share in names.items() for gear in (1.0, 7.0)}
    assert pytest.approx(0.56, abs=0.005) == (1.912 - 0.05239) / (0.05909 + 0.5486) / 5.454
    assert pytest.approx(0.805, abs=0.005) == (1.5 - 0.292) * 6.388 / 1.5 / 6.388


@given(st.sampled_from(catalogue_names()), st.floats(0.05, 50.0), st.booleans())
def test_a_gear_keeps_power_and_energy(name: str, gear: float, turned: bool) -> None:
    """A gear keeps power and energy."""
    motor = catalogue_motor(name)
    kind = JointKind.PRISMATIC if motor.max_force is not None else JointKind.REVOLUTE
    one, geared = (
        values(fitted(NamedMotor(name, motor), kind, None, ratio)) for ratio in (1.0, -gear if turned else gear)
    )
    assert one.keys() == geared.keys()
    if {"effort", "velocity"} <= one.keys():
        assert geared["effort"] * geared["velocity"] == pytest.approx(one["effort"] * one["velocity"])
    for quantity in ("armature", "damping"):
        if quantity in one:
            assert geared[quantity] == pytest.approx(one[quantity] * gear**2)


def test_voltage_takes_published_figures_then_lines_then_proportion() -> None:
    """Voltage takes published figures then lines then proportion."""
    at = {volts: values(fit("XL330-M288", voltage=volts)) for volts in (3.7, 5.0, 5.5, 6.0, 7.4)}
    assert (at[3.7]["effort"], at[6.0]["effort"]) == (0.42, 0.6)
    assert at[5.5]["effort"] == pytest.approx(0.5 * (0.52 + 0.6))
    assert at[7.4]["velocity"] == pytest.approx(12.88 * 7.4 / 6.0)
    assert at[5.0]["kp"] == pytest.approx(0.8309 * 5.0 / 7.5)
    assert at[5.0]["armature"] == at[7.4]["armature"]
    with pytest.raises(UnscalableMotor):
        fit("L16-35", JointKind.PRISMATIC, 12.0)


def test_a_linear_drive_does_not_turn() -> None:
    """A linear drive does not turn."""
    with pytest.raises(UnscalableMotor):
        fit("L16-35")


SIDECAR = """version: 1
robot: arm
step: arm.step
links: {{base: {{rest: true}}, arm: {{parts: [arm]}}}}
joints:
  elbow: {{type: {kind}, parent: base, child: arm{more}}}
actuators:
  elbow: {actuator}
"""


PASSIVE = {"damping": 0.60769, "friction": 0.05239, "armature": 0.0284}
"""Of the STS3215-7.4V."""


def load(folder: Path, actuator: str, more: str = "", kind: str = "revolute", end: str = ""):  # type: ignore[no-untyped-def]
    """A sidecar with one actuator, and its diagnostics."""
    path, diagnostics = folder / "arm.robot.yaml", Diagnostics()
    path.write_text(SIDECAR.format(actuator=actuator, more=more, kind=kind) + end, encoding="utf-8")
    return load_sidecar(path, diagnostics), list(diagnostics)


def settings(sidecar) -> dict[str, float]:  # type: ignore[no-untyped-def]
    """Limits and dynamics of the joint."""
    from stepbot.sidecar.joint_settings import joint_settings

    return {field: one.value for field, one in joint_settings(sidecar.document, "elbow").items()}


def test_keys_beside_the_motor_and_of_the_joint_take_precedence(tmp_path: Path) -> None:
    """Keys beside the motor and of the joint take precedence."""
    plain, _ = load(tmp_path, "{motor: STS3215-7.4V}")
    assert settings(plain) == {"effort": 1.912, "velocity": 5.454, **PASSIVE}
    assert plain.document.actuators["elbow"].kind is ActuatorKind.POSITION
    assert plain.document.actuators["elbow"].kp.value == 17.8
    more = ", limits: {velocity: 2}, dynamics: {armature: 0.05}"
    own, _ = load(tmp_path, "{motor: STS3215-7.4V, limits: {effort: 1.5 N*m}, kp: 30}", more)
    assert settings(own) == {"effort": 1.5, "velocity": 2.0, **PASSIVE, "armature": 0.05}
    assert own.document.actuators["elbow"].kp.value == 30.0


def test_a_gear_on_a_slide_has_a_unit(tmp_path: Path) -> None:
    """A lead of 10 mm turns 36 degrees for each millimetre: effort x 2 pi / lead."""
    slide, found = load(tmp_path, "{motor: XL430-W250, gear: 36 deg/mm}", kind="prismatic")
    assert {one.code for one in found} <= {"SB149"}
    assert slide.document.actuators["elbow"].gear == pytest.approx(math.tau / 0.010, rel=1e-12)
    assert settings(slide)["effort"] == pytest.approx(1.5 * math.tau / 0.010)
    assert settings(slide)["velocity"] == pytest.approx(6.388 * 0.010 / math.tau)


def test_a_motor_on_an_endless_joint_takes_a_speed(tmp_path: Path) -> None:
    """A motor on an endless joint takes a speed."""
    sidecar, _ = load(tmp_path, "{motor: Pololu-37D-50}", kind="continuous")
    drive = sidecar.document.actuators["elbow"]
    assert (drive.kind, drive.gains) == (ActuatorKind.VELOCITY, "auto")


OWN = """motors:
  mine:
    kind: servo
    source: measured by hand
    stall_torque: 20 kg.cm
    no_load_speed: {value: 60 rpm, source: my tachometer}
    mass: 57 g
"""


def test_a_users_own_file(tmp_path: Path) -> None:
    """A users own file."""
    (tmp_path / "my_motors.yaml").write_text(OWN, encoding="utf-8")
    sidecar, found = load(tmp_path, "{motor: mine}", end="motors: my_motors.yaml\n")
    assert [one.code for one in found] == ["SB149"]
    assert settings(sidecar)["effort"] == pytest.approx(20 * 9.80665e-2)
    assert settings(sidecar)["velocity"] == pytest.approx(math.tau)
    assert sidecar.motors["elbow"].figure("velocity").source == "my tachometer"


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        (OWN.replace("stall_torque: 20 kg.cm", "stall_torque: 20 kg"), "SB124", 5),
        (OWN.replace("stall_torque", "stal_torque"), "SB120", 5),
        (OWN.replace("kind: servo", "kind: server"), "SB123", 3),
        (OWN.replace("    source: measured by hand\n", ""), "SB121", 4),
        (OWN.replace("source: my", "sauce: my"), "SB120", 6),
        (OWN.replace("60 rpm", "-1"), "SB125", 6),
        ("mine: {kind: servo}\n", "SB120", 1),
        ("motors: [\n", "SB104", 1),
        ("", "SB102", 0),
    ],
)
def test_faults_of_a_users_own_file(tmp_path: Path, text: str, code: str, line: int) -> None:
    """Faults of a user's own file; the motors in it are not unknown as well."""
    (tmp_path / "my_motors.yaml").write_text(text, encoding="utf-8")
    sidecar, found = load(tmp_path, "{motor: mine}", end="motors: my_motors.yaml\n")
    assert sidecar is None
    assert "SB147" not in {one.code for one in found}
    first = next(one for one in found if one.code == code)
    assert (Path(first.span.file).name, first.span.line) == ("my_motors.yaml", line)


@pytest.mark.parametrize(
    ("actuator", "end", "code", "text"),
    [
        ("{motor: mine}", "motors: gone.yaml\n", "SB001", "gone.yaml"),
        ("{motor: STS3215}", "", "SB147", "STS3215-12V"),
        ("{motor: STS3215-7.4V, voltage: 12 V}", "", "SB148", "of its family: STS3215-12V at 12 V"),
        ("{motor: XL43O-W250}", "", "SB147", "XL430-W250"),
        ("{motor: AS1010, voltage: 24 V}", "", "SB148", "no source gives the supply"),
        ("{voltage: 24 V}", "", "SB137", "'voltage' without 'motor'"),
    ],
)
def test_faults_of_a_sidecar(tmp_path: Path, actuator: str, end: str, code: str, text: str) -> None:
    """Faults of a sidecar."""
    from stepbot.sidecar.check import check_sidecar

    sidecar, found = load(tmp_path, actuator, end=end)
    if sidecar is not None:
        more = Diagnostics()
        check_sidecar(sidecar, more)
        found += list(more)
    first = next(one for one in found if one.code == code)
    assert text in " ".join((first.message, *first.help))


def test_names_are_compared_without_case_and_separators() -> None:
    """Names are compared without case and separators."""
    assert bare("MX 64") == bare("mx_64") == "mx-64"


def test_words_for_joints_lead_to_figures() -> None:
    """What an actuator calls effort and velocity is a stall torque and a no-load speed of a motor."""
    figures = ("kind", "stall_torque", "no_load_speed", "gear_ratio", "mass")
    assert [meant_by(word, figures) for word in ("effort", "Speed", "gear", "weight")] == list(figures[1:])
    assert meant_by("effort", ("motor", "position")) == "motor"
