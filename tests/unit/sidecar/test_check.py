"""Consistency checks of a sidecar: valid ones pass, and each inconsistency is reported."""

import math
import time
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepbot.diagnostics import Diagnostics
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.connections import rings
from stepbot.sidecar.load import parse_sidecar
from tests.unit.sidecar.samples import FULL


def checked(text: str) -> Diagnostics:
    """The findings of loading and checking a text."""
    diagnostics = Diagnostics()
    sidecar = parse_sidecar(text, Path("a.robot.yaml"), diagnostics)
    if sidecar is not None:
        check_sidecar(sidecar, diagnostics)
    return diagnostics


def codes(text: str) -> list[str]:
    """The codes of the findings."""
    return [d.code for d in checked(text)]


def robot(links: int, joints: list[tuple[int, int]], extra: str = "") -> str:
    """A sidecar with links ``l0`` ... and fixed joints between them."""
    lines = ["version: 1", "robot: tree", "step: tree.step", "links:"]
    lines += [f"  l{n}: {{parts: [p{n}]}}" for n in range(links)]
    lines += ["joints:"] if joints else []
    lines += [f"  j{n}: {{type: fixed, parent: l{a}, child: l{b}}}" for n, (a, b) in enumerate(joints)]
    return "\n".join(lines) + "\n" + extra


@st.composite
def trees(draw: st.DrawFn) -> tuple[int, list[tuple[int, int]]]:
    """A random tree: each link except the first has an earlier one as parent; joints in any order."""
    links = draw(st.integers(2, 12))
    edges = [(draw(st.integers(0, child - 1)), child) for child in range(1, links)]
    return links, draw(st.permutations(edges))


def test_full_sidecar_is_sound() -> None:
    """The sidecar with every key has no findings except those of its mimic."""
    sound = FULL.replace(
        "mimic: {joint: lift, multiplier: -1, offset: 0}", "mimic: {joint: pan, multiplier: 0, offset: 0}"
    )
    assert codes(sound) == []


@pytest.mark.slow
@given(tree=trees())
def test_trees_are_sound(tree: tuple[int, list[tuple[int, int]]]) -> None:
    """A tree has no errors, for any order of its joints."""
    assert codes(robot(*tree)) == []


@given(tree=trees(), data=st.data())
def test_one_joint_more_is_found(tree: tuple[int, list[tuple[int, int]]], data: st.DataObject) -> None:
    """A further joint gives a link a second parent, or the root a parent, which forms a cycle."""
    links, joints = tree
    a, b = data.draw(st.tuples(st.integers(0, links - 1), st.integers(0, links - 1)).filter(lambda ab: ab[0] != ab[1]))
    assert codes(robot(links, [*joints, (a, b)])) == ["SB450"]


@given(tree=trees(), data=st.data())
def test_one_joint_less_is_found(tree: tuple[int, list[tuple[int, int]]], data: st.DataObject) -> None:
    """Without one of its joints a tree is not connected."""
    links, joints = tree
    del joints[data.draw(st.integers(0, len(joints) - 1))]
    assert codes(robot(links, joints)) == ["SB450:disconnected"]


def test_wrong_units_of_one_cause_are_one_error() -> None:
    """A joint whose values all have units of another type, and a default of several joints; else one for each value."""
    values = "limits: {lower: -90 deg, upper: 90 deg, effort: 2 N*m}, zero: 5 deg"
    links = "links: {a: {rest: true}, b: {parts: [b]}, c: {parts: [c]}}\n"
    text = f"version: 1\nrobot: r\nstep: r.step\n{links}joints:\n"
    text += "  j: {type: prismatic, parent: a, child: b, VALUES}\n"
    (fault,) = checked(text.replace("VALUES", values).replace(", c: {parts: [c]}", ""))
    assert fault.message == "joint 'j': the units of 4 values do not match its type prismatic"
    assert (fault.span.line, len(fault.notes), fault.help) == (
        6,
        4,
        ("change the type to revolute, or correct the values",),
    )
    mixed = values.replace("90 deg, e", "90 mm, e")
    several = checked(text.replace("VALUES", mixed).replace(", c: {parts: [c]}", ""))
    assert [d.code for d in several] == ["SB138"] * 3
    text = text.replace("VALUES", "limits: {lower: 0, upper: 1}")
    text += "  k: {type: prismatic, parent: b, child: c, limits: {lower: 0, upper: 1}}\n"
    (fault,) = checked(text + "joint_defaults: {'*': {limits: {effort: 2 N*m}}}\n")
    assert fault.message.startswith("joint default '*': effort: '2 N*m' is not a force [N], required for 2 prismatic")
    assert fault.notes == ("joints: 'j', 'k'",)


def test_disconnected_links_are_notes_of_the_joint_that_causes_them() -> None:
    """A joint with a wrong child is the error; what it leaves disconnected is a note. Further links are errors."""
    (cause,) = checked(robot(3, [(0, 1), (0, 0)]))
    assert (cause.code, cause.notes) == ("SB450", ("not connected to the root 'l0': link 'l2'",))
    (cause,) = checked(robot(3, [(0, 1), (0, 1)]))
    assert (cause.code, cause.notes[1:]) == ("SB450", ("not connected to the root 'l0': link 'l2'",))
    assert sorted(codes(robot(4, [(0, 1), (0, 1)]))) == ["SB450", "SB450:disconnected", "SB450:disconnected"]


@given(tree=trees(), data=st.data())
def test_only_the_root_is_the_root(tree: tuple[int, list[tuple[int, int]]], data: st.DataObject) -> None:
    """Naming a link as root that has a parent is an error."""
    named = data.draw(st.integers(0, tree[0] - 1))
    assert codes(robot(*tree, extra=f"root: {{link: l{named}}}\n")) == (["SB450"] if named else [])


@given(successor=st.lists(st.integers(0, 9), min_size=10, max_size=10))
def test_rings(successor: list[int]) -> None:
    """The cycles of any map are the names that lead back to themselves, each once."""
    names = {str(n): str(m) for n, m in enumerate(successor)}
    back = set()
    for start, name in names.items():
        reached = name
        for _ in names:
            if reached == start:
                back.add(start)
            reached = names[reached]
    found = rings(names)
    assert sorted(name for ring in found for name in ring) == sorted(back)
    for ring in found:
        assert [names[name] for name in ring] == [*ring[1:], ring[0]]


JOINT = """\
version: 1
robot: arm
step: arm.step
links: {{base: {{rest: true}}, arm: {{parts: [arm]}}, hand: {{parts: [hand]}}}}
joints:
  elbow: {{parent: base, child: arm, {elbow}}}
  wrist: {{parent: arm, child: hand, {wrist}}}
"""
TURNS = "type: continuous"


@pytest.mark.parametrize(
    ("elbow", "wrist", "expected"),
    [
        ("type: revolute, limits: {lower: -1, upper: 1}", TURNS, []),
        ("type: revolute, limits: {lower: 10 deg, upper: 1}, zero: 20 deg", TURNS, []),
        ("type: revolute, limits: {lower: 0, upper: 1}", TURNS, []),
        ("type: revolute, limits: {lower: 0, upper: inf}", TURNS, []),
        ("type: prismatic, limits: {lower: -inf, upper: inf}", TURNS, []),
        ("type: revolute, limits: {lower: inf, upper: inf}", TURNS, ["SB456"]),
        ("type: revolute, limits: {lower: 1e-3, upper: 1}", TURNS, ["SB457"]),
        ("type: revolute, limits: {lower: -1, upper: 1}, zero: 1.0000000001", TURNS, []),
        ("type: revolute, limits: todo", "type: prismatic, limits: todo", ["SB463", "SB463"]),
        ("type: fixed, limits: todo", TURNS, ["SB137"]),
        ("type: screw, pitch: 2 mm/rev, limits: {upper: 10 rev}", TURNS, []),
        ("type: screw, pitch: 0", TURNS, ["SB125"]),
        ("type: universal, axis: z, axis2: x, limits: {effort: 1 N*m}", TURNS, []),
        ("type: universal, axis: [1, 1, 0], axis2: [-1, -1, 0]", TURNS, ["SB462"]),
        ("type: ball, dynamics: {damping: 0.1 N*m*s/rad}", TURNS, []),
        ("type: floating", "type: fixed", []),
        ("type: planar, axis: x", "type: cylindrical, axis: y", []),
        ("type: planar, limits: {velocity: 1}", TURNS, ["SB137"]),
        (TURNS, "type: continuous, mimic: {joint: elbow, multiplier: -2, offset: 0}", []),
        (TURNS, "type: continuous, mimic: {joint: elbow, offset: 1}", ["SB460"]),
        (
            "type: continuous, zero: 1",
            "type: continuous, zero: 2.5, mimic: {joint: elbow, multiplier: 2, offset: 0.5}",
            [],
        ),
        (
            "type: revolute, limits: {lower: -1, upper: 1}",
            "type: revolute, limits: {lower: -2, upper: 2}, mimic: {joint: elbow, multiplier: -2}",
            [],
        ),
        (
            "type: revolute, limits: {lower: -1, upper: 1}",
            "type: revolute, limits: {lower: -1, upper: 2}, mimic: {joint: elbow, multiplier: -2}",
            ["SB460"],
        ),
        ("type: revolute, limits: {lower: -20, upper: 20}", TURNS, []),
        ("type: revolute, limits: {lower: -21 rad, upper: 21 rad}", TURNS, []),
        ("type: revolute, limits: {lower: -21, upper: 0}", TURNS, ["SB139"]),
        ("type: continuous, limits: {velocity: 30, effort: 3000}", TURNS, []),
        ("type: continuous, limits: {velocity: 31}", TURNS, ["SB139"]),
        ("type: continuous, limits: {velocity: 31 rad/s, effort: 16500 N*m}", TURNS, []),
        ("type: continuous, limits: {effort: 16500}", TURNS, ["SB139"]),
        ("type: prismatic, limits: {lower: 0, upper: 1, velocity: 45, effort: 16500}", TURNS, ["SB139"]),
        ("type: continuous, zero: 20", TURNS, ["SB139"]),
        ("type: continuous, zero: 20 rad", TURNS, []),
        ("type: screw, pitch: 0.1", TURNS, []),
        ("type: screw, pitch: 2", TURNS, ["SB139"]),
        ("type: screw, pitch: 2 m/rad", TURNS, []),
    ],
)
def test_rules_of_joints(elbow: str, wrist: str, expected: list[str]) -> None:
    """The requirements of a joint type, at their limits."""
    assert codes(JOINT.format(elbow=elbow, wrist=wrist)) == expected


@pytest.mark.parametrize(("upper", "expected"), [("2 rad", []), ("1.9 rad", ["SB460"])])
def test_range_of_a_mimic_of_a_mimic(upper: str, expected: list[str]) -> None:
    """A joint that mimics a mimic ranges as far as the first joint moves it, not as the limits between allow."""
    text = JOINT.format(
        elbow="type: revolute, limits: {lower: -2, upper: 2}",
        wrist="type: revolute, limits: {lower: -2, upper: 2}, mimic: {joint: elbow, multiplier: -0.5}",
    )
    limits = f"limits: {{lower: -2, upper: {upper}}}"
    third = f"  third: {{type: revolute, parent: hand, child: tip, {limits}, mimic: {{joint: wrist, multiplier: 2}}}}\n"
    assert codes(text.replace("links: {", "links: {tip: {parts: [tip]}, ") + third) == expected


def test_defaults_fill_limits() -> None:
    """Limits given by a default need not be repeated."""
    text = JOINT.format(elbow="type: revolute", wrist=TURNS)
    assert codes(text) == ["SB455"]
    assert codes(text + "joint_defaults: {'*': {limits: {lower: -1, upper: 1}}}\n") == []


def test_defaults_fill_limits_that_are_to_do() -> None:
    """`limits: todo` is a warning unless the joint or a default has both bounds."""
    text = JOINT.format(elbow="type: revolute, limits: todo", wrist=TURNS)
    assert codes(text + "joint_defaults: {'*': {limits: {upper: 1, effort: 2}}}\n") == ["SB463"]
    assert codes(text + "joint_defaults: {'*': {limits: {lower: -1, upper: 1}}}\n") == []


@pytest.mark.parametrize(
    ("kind", "stops", "remedies"),
    [
        ("revolute", (), ("limits: {lower: -90 deg, upper: 90 deg}",)),
        (
            "revolute",
            ("-88.17 deg", "219.3 deg"),
            (
                "limits: {lower: -88.17 deg, upper: 219.3 deg}",
                "lower and upper are stops that `init` found by collision; a limit may be closer",
            ),
        ),
        (
            "prismatic",
            ("12.5 mm",),
            (
                "limits: {lower: 0, upper: 12.5 mm}",
                "upper is a stop that `init` found by collision; a limit may be closer",
            ),
        ),
    ],
)
def test_limits_that_are_to_do_name_the_stops_of_the_draft(
    kind: str, stops: tuple[str, ...], remedies: tuple[str, ...]
) -> None:
    """The remedy has the stops in the comments of the draft, where there are any."""
    comments = "".join(f"  # stop found by collision at {at}: 'a' and 'b'; a limit may be closer\n" for at in stops)
    joint = f"  # score 0.95: m\n{comments}  turn:\n    {{type: {kind}, parent: base, child: arm, limits: todo}}\n"
    text = f"version: 1\nrobot: r\nstep: r.step\nlinks: {{base: {{rest: true}}, arm: {{parts: [a]}}}}\njoints:\n{joint}"
    diagnostics = Diagnostics()
    sidecar = parse_sidecar(text, Path("r.robot.yaml"), diagnostics)
    assert sidecar is not None
    check_sidecar(sidecar, diagnostics)
    (placeholder,) = (one for one in diagnostics if one.code == "SB463")
    assert placeholder.help == remedies


def test_error_in_a_default_is_reported_at_the_default() -> None:
    """Swapped limits of a default are reported at the default."""
    text = JOINT.format(elbow="type: revolute", wrist=TURNS) + "joint_defaults: {'*': {limits: {lower: 2, upper: 1}}}\n"
    (diagnostic,) = checked(text)
    assert (diagnostic.code, diagnostic.span.line) == ("SB456", 8)
    assert diagnostic.message.startswith("joint 'elbow'")


@pytest.mark.parametrize("name", ["CON", "nul", "aux.v2", "LPT1"])
def test_robots_are_not_called_like_devices(name: str) -> None:
    """A robot named like a Windows device is rejected, since files are named after it; a link is accepted."""
    text = robot(1, []).replace("robot: tree", f"robot: {name}")
    (diagnostic,) = checked(text)
    assert (diagnostic.code, diagnostic.span.line) == ("SB126", 2)
    assert diagnostic.message == f"robot: '{name}' is a device name on Windows"
    assert codes(robot(1, []).replace("l0", name)) == []


@pytest.mark.parametrize("character", ["\u202e", "\u2066", "\u200f", "\u200b", "\ufeff", "\u00ad"])
def test_names_are_what_they_look_like(character: str) -> None:
    """Invisible and bidi characters are rejected in names of robots and links."""
    name = f'"arm\\u{ord(character):04x}jbo.exe"'
    for sidecar in (robot(1, []).replace("robot: tree", f"robot: {name}"), robot(1, []).replace("l0", name)):
        diagnostics = list(checked(sidecar))
        assert [diagnostic.code for diagnostic in diagnostics] == ["SB126"], diagnostics
        assert f"U+{ord(character):04X}" in diagnostics[0].message


@pytest.mark.parametrize(
    ("damage", "expected"),
    [
        # Removing a joint disconnects its child, which is a consequence.
        (("type: revolute", "tpye: revolute"), ["SB120"]),
        # The misspelt section may contain the joints.
        (("joints:", "jonits:"), ["SB120"]),
        # Another error does not hide one of the tree.
        (("robot: arm", "robot: a/b"), ["SB126"]),
        (("robot: arm", "robot: a/b\nroot: {link: arm}"), ["SB126", "SB450"]),
    ],
)
def test_faults_do_not_beget_faults(damage: tuple[str, str], expected: list[str]) -> None:
    """In a document with errors, consequences of them are not reported."""
    text = JOINT.format(elbow="type: revolute, limits: {lower: -1, upper: 1}", wrist=TURNS)
    assert codes(text.replace(*damage, 1)) == expected


@pytest.mark.slow
def test_large_robots_are_checked_quickly() -> None:
    """A chain of a thousand joints that all mimic one another is checked in seconds."""
    links = "".join(f"  l{n}: {{parts: [p{n}]}}\n" for n in range(1001))
    joints = "".join(
        f"  j{n}: {{type: continuous, parent: l{n}, child: l{n + 1}, mimic: {{joint: j{n + 1}}}}}\n" for n in range(999)
    )
    last = "  j999: {type: continuous, parent: l999, child: l1000}\n"
    text = f"version: 1\nrobot: chain\nstep: c.step\nlinks:\n{links}joints:\n{joints}{last}"
    start = time.process_time()
    assert codes(text) == []
    assert time.process_time() - start < 15


@pytest.mark.parametrize(
    ("actuator", "message"),
    [
        ("kind: position, gains: auto", ""),
        ("kind: position, gains: {bandwidth: 8 Hz, damping_ratio: 0.7}", ""),
        ("kind: velocity, gains: {bandwidth: 8 Hz}", ""),
        ("gains: auto", "SB137: actuator 'motor': 'gains' is not valid for kind motor"),
        ("kind: position, gains: auto, kv: 3", "SB137: actuator 'motor': both 'gains' and 'kv'"),
        (
            "kind: velocity, gains: {damping_ratio: 1}",
            "SB137: actuator 'motor': 'gains.damping_ratio' is not valid for kind velocity",
        ),
        ("kind: position", "SB121: actuator 'motor': missing key 'kp', required for kind position"),
        ("kind: position, gains: {bandwidth: 0 Hz}", "SB125: actuator 'motor': gains.bandwidth: "),
        ("kind: position, gains: {bandwidth: 3 s}", "SB124: actuator 'motor': gains.bandwidth: "),
        ("kind: position, gains: automatic", "SB123: actuator 'motor': gains: "),
    ],
)
def test_computed_gains(actuator: str, message: str) -> None:
    """`gains` computes the gains of position and velocity actuators; other uses are reported."""
    joints = "joints:\n  turn: {type: continuous, parent: l0, child: l1}\n"
    found = checked(robot(2, [], f"{joints}actuators:\n  motor: {{joint: turn, {actuator}}}\n"))
    assert [f"{one.code}: {one.message}"[: len(message)] for one in found] == ([message] if message else [])


@pytest.mark.parametrize(
    ("simulation", "message"),
    [
        ("{timestep: 1 ms, integrator: rk4, closure_stiffness: 50 %}", ""),
        ("{timestep: 0}", "SB125: simulation.timestep: "),
        ("{timestep: 1}", "SB125: simulation.timestep: "),
        ("{timestep: 1 mm}", "SB124: simulation.timestep: "),
        ("{integrator: runge_kutta}", "SB123: simulation.integrator: "),
        ("{closure_stiffness: 2}", "SB125: simulation.closure_stiffness: "),
        ("{gravity: 1}", "SB120: simulation: "),
    ],
)
def test_settings_of_a_simulation(simulation: str, message: str) -> None:
    """Time step, integrator and stiffness are checked; other settings are unknown keys."""
    found = checked(robot(2, [(0, 1)], f"simulation: {simulation}\n"))
    assert [f"{one.code}: {one.message}"[: len(message)] for one in found] == ([message] if message else [])


@pytest.mark.parametrize(
    ("follower", "leader", "multiplier", "value"),
    [
        ("prismatic", "revolute", "3 mm/rad", 0.003),
        ("prismatic", "revolute", "8 mm/rev", 0.008 / (2.0 * math.pi)),
        ("revolute", "prismatic", "30 deg/mm", 1000.0 * math.pi / 6.0),
        ("revolute", "revolute", "50 %", 0.5),
        ("prismatic", "revolute", "0.003", 0.003),
        ("prismatic", "revolute", "30 deg/mm", None),
        ("revolute", "revolute", "3 mm/rad", None),
        ("prismatic", "revolute", "50 %", None),
    ],
)
def test_multipliers_between_turns_and_slides(follower: str, leader: str, multiplier: str, value: float | None) -> None:
    """A multiplier may have the unit of its joints, and no other."""
    text = f"""version: 1
robot: r
step: r.step
links: {{a: {{rest: true}}, b: {{parts: [b]}}, c: {{parts: [c]}}}}
joints:
  l: {{type: {leader}, parent: a, child: b, limits: {{lower: -0.001, upper: 0.001}}}}
  f: {{type: {follower}, parent: a, child: c, mimic: {{joint: l, multiplier: {multiplier}}},
      limits: {{lower: -1, upper: 1}}}}
"""
    diagnostics = Diagnostics()
    sidecar = parse_sidecar(text, Path("a.robot.yaml"), diagnostics)
    assert sidecar is not None, list(map(str, diagnostics))
    check_sidecar(sidecar, diagnostics)
    mimic = sidecar.document.joints["f"].mimic
    assert mimic is not None
    if value is None:
        assert [one.code for one in diagnostics] == ["SB138"]
    else:
        assert not list(diagnostics)
        assert mimic.multiplier.value == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("seen", "code"),
    [
        ("samples: 100, range: [0.1 m, .inf]", ""),
        ("samples: 100, range: [0.1 m, .nan]", "SB125"),
        ("samples: 100_001, range: [0.1 m, 3 m]", "SB122"),
        ("samples: 100001, range: [0.1 m, 3 m]", "SB125"),
    ],
)
def test_ranges_without_end_and_numbers_of_rays(seen: str, code: str) -> None:
    """A lidar may see without end; MJCF has an element for each ray, so that their number is bounded."""
    text = f"""version: 1
robot: r
step: r.step
links: {{a: {{rest: true}}}}
sensors: {{scan: {{type: lidar, link: a, fov: 90 deg, {seen}}}}}
"""
    assert codes(text) == ([code] if code else [])


def test_every_name_that_is_written_is_portable() -> None:
    """The robot's, which names files, modules', prefixes, and those that `rename` gives; each with a remedy."""
    text = """version: 1
robot: my 2f85
modules:
  the arm: {file: arm.urdf, prefix: ""}
  hand: {file: hand.urdf, at: the arm/tip, prefix: hånd_, rename: {links: {base: der Fuß}}}
"""
    found = checked(text)
    assert [(one.code, one.span.line, one.help) for one in found] == [
        ("SB129", 2, ("rename it to 'my_2f85'",)),
        ("SB129", 4, ("rename it to 'the_arm'",)),
        ("SB129", 5, ("rename it to 'hand'",)),
        ("SB129", 5, ("rename it to 'der_Fuss'",)),
    ]
    portable = (
        text.replace("my 2f85", "2f85").replace("the arm", "arm").replace("hånd_", "h.").replace("der Fuß", "foot")
    )
    assert codes(portable) == []


@pytest.mark.parametrize("density", [".inf", "1e400", "9e9 g/cm^3", ".5", "4. kg/m^3", ".000_001"])
def test_densities_of_any_form(density: str) -> None:
    """Densities that no material has, each in another form of a number, end in findings, also beside another error."""
    for fault in ("", "colour: red\n"):
        assert codes(
            f"version: 1\nrobot: a\nstep: a.step\n{fault}defaults: {{density: {density}}}\nlinks: {{base: {{}}}}\n"
        )


@pytest.mark.parametrize(
    ("section", "expected"),
    [
        ("sensors: {s: {type: lidar, link: base, range: [0.1, 300]}}", []),
        ("sensors: {s: {type: lidar, link: base, range: [100, 12000]}}", ["SB139"]),
        ("defaults: {density: 1000, contact: {friction: 1, torsional: 2}}", ["SB139"]),
    ],
)
def test_lengths_of_each_kind_have_a_usual_size(section: str, expected: list[str]) -> None:
    """A range in millimetres is longer than sensors see, though as metres of a place it would not be."""
    assert codes(f"version: 1\nrobot: a\nstep: a.step\nlinks: {{base: {{rest: true}}}}\n{section}\n") == expected
