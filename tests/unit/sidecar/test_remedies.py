"""A snippet in the help of a diagnostic, pasted at the error, fixes the sidecar."""

import re
from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostic, Diagnostics
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.load import parse_sidecar

ARM = """\
version: 1
robot: arm
step: arm.step
links:
  base: {rest: true}
  forearm: {parts: [forearm]}
joints:
  elbow: {type: revolute, parent: base, child: forearm, limits: {lower: -1, upper: 1}}
"""
SNIPPET = re.compile(r"`([^`]+)`")


def findings(text: str) -> list[Diagnostic]:
    """The findings of loading and checking a text."""
    diagnostics = Diagnostics()
    sidecar = parse_sidecar(text, Path("a.robot.yaml"), diagnostics)
    if sidecar is not None:
        check_sidecar(sidecar, diagnostics)
    return list(diagnostics)


@pytest.mark.parametrize(
    ("right", "wrong", "pasted"),
    [
        ("  forearm: {parts: [forearm]}", "  forearm: [forearm]", "forearm: {parts: [forearm]}"),
        ("  forearm: {parts: [forearm]}", "  forearm: C:\\forearm", "forearm: {parts: ['C:\\forearm']}"),
        ("limits: {lower: -1, upper: 1}", "limits: [-1, 1]", "limits: {lower: -1, upper: 1}"),
        ("limits: {lower: -1, upper: 1}", "range: [-1, 1 rad]", "limits: {lower: -1, upper: 1 rad}"),
        ("type: revolute", "origin: [0, 0, 1 mm], type: revolute", "origin: {xyz: [0, 0, 1 mm]}"),
        ("type: revolute", "axis: 0 0 1, type: revolute", "axis: [0, 0, 1]"),
        ("type: revolute", 'axis: "(0, 0, -1)", type: revolute', "axis: [0, 0, -1]"),
        ("type: revolute", "origin: {xyz: 0 0 0.1}, type: revolute", "xyz: [0, 0, 0.1]"),
        ("parent: base", "parent: {link: base}", "parent: base"),
        ("parent: base", "parent: [base]", "parent: base"),
        ("type: revolute", "type: [revolute]", "type: revolute"),
        ("type: revolute", "type: revolute, zero: [30 deg]", "zero: 30 deg"),
        ("  forearm: {parts: [forearm]}", "  forearm: {parts: [[forearm]]}", "forearm"),
        ("joints:", "ignore_findings: [305]\njoints:", "SB305"),
        ("joints:", "self_collision: {exclude: [[base, forearm]]}\njoints:", "exclude: [always]"),
        ("joints:", "self_collision: {exclude: [base, forearm]}\njoints:", "exclude: [always]"),
        ("  elbow: {", "  elbow:{", "elbow: {type: revolute"),
        ("limits: {lower: -1, upper: 1}", "lower: -1, limits: {upper: 1}", "limits: {lower: -1}"),
        ("  base: {rest: true}", "  base: {rest: true, mass: 5}", "inertial: {mass: 5}"),
        ("  base: {rest: true}", '  base: {parts: ["a*"], density: 2700}', 'parts: {"a*": {density: 2700}}'),
        ("  base: {rest: true}", "  base: {rest: true, inertial: 2 kg}", "inertial: {mass: 2 kg}"),
        ("type: revolute", "type: revolute, mimic: wrist", "mimic: {joint: wrist}"),
        ("type: revolute", "type: revolute, dynamics: 0.1", "dynamics: {damping: 0.1}"),
        ("joints:", "frames: {tip: forearm}\njoints:", "tip: {link: forearm}"),
        ("joints:", "actuators: {elbow: STS3215-12V}\njoints:", "elbow: {motor: STS3215-12V}"),
        ("joints:", "actuators: {elbow: velocity}\njoints:", "elbow: {kind: velocity}"),
        ("joints:", "modules: {hand: hand.urdf}\njoints:", "hand: {file: hand.urdf}"),
        ("joints:", "materials: {pla: 1240 kg/m^3}\njoints:", "pla: {density: 1240 kg/m^3}"),
    ],
)  # fmt: skip
def test_snippet_is_what_to_write(right: str, wrong: str, pasted: str) -> None:
    """The help has the value in the form that the key requires."""
    assert right in ARM
    found = findings(ARM.replace(right, wrong))
    snippets = [snippet for d in found for line in d.help for snippet in SNIPPET.findall(line)]
    assert any(snippet.startswith(pasted) for snippet in snippets), [d.help for d in found]


@pytest.mark.parametrize(
    ("joint", "expected"),
    [
        ("type: revolute, limits: {lower: 0, upper: 115 kg}", "angle [rad]"),
        ("type: prismatic, limits: {lower: 0, upper: 1 rad}", ""),
        ("type: prismatic, limits: {lower: 0, upper: 1 kg}", "length [m]"),
        ("type: revolute, zero: 1 kg, limits: {lower: 0, upper: 1}", "angle [rad]"),
        ("type: revolute, dynamics: {damping: 1 kg}, limits: {lower: 0, upper: 1}", "damping [N*m*s/rad]"),
        ("type: twisting, limits: {lower: 0, upper: 1 kg}", "angle [rad] or length [m]"),
    ],
)
def test_a_wrong_unit_names_what_the_joint_takes(joint: str, expected: str) -> None:
    """The type of the joint decides between angle and length, where it is known."""
    elbow = "type: revolute, parent: base, child: forearm, limits: {lower: -1, upper: 1}"
    found = [d for d in findings(ARM.replace(elbow, f"{joint}, parent: base, child: forearm")) if d.code == "SB124"]
    assert [d.message.partition("expected ")[2] for d in found] == ([expected] if expected else [])


def test_a_wrong_unit_of_a_gain_names_what_its_joint_takes() -> None:
    """Gains have the dimensions of their joint's stiffness and damping."""
    text = ARM + "actuators: {motor: {joint: elbow, kind: position, kp: 5 kg}}\n"
    (fault,) = findings(text)
    assert fault.message.endswith("wrong unit 'kg': expected stiffness [N*m/rad]")


def test_positions_of_a_message_have_one_unit() -> None:
    """Degrees beside a plain number in radians, and for positions that were computed."""
    limits = "limits: {lower: -1, upper: 1}"
    outside = findings(ARM.replace(limits, "zero: 5, limits: {lower: 0, upper: 100 deg}"))
    assert "position 5 rad (286.479 deg) is above the upper limit 100 deg" in outside[0].message
    outside = findings(ARM.replace(limits, "limits: {lower: 0.5, upper: 100 deg}"))
    assert "position 0 deg is below the lower limit 0.5 rad (28.6479 deg)" in outside[0].message
    text = ARM.replace("  forearm: {", "  hand: {parts: [hand]}\n  forearm: {")
    wrist = "type: revolute, parent: forearm, child: hand, limits: {lower: 0, upper: 45 deg}, mimic: {joint: elbow}"
    text += f"  wrist: {{{wrist}}}\n"
    (beyond,) = findings(text)
    assert "ranges from -57.2958 to 57.2958 deg, beyond its limits 0 to 45 deg" in beyond.message
    assert beyond.help


def test_missing_version_is_one_line() -> None:
    """The line in the help, put at the top, is all that is missing."""
    (fault,) = findings(ARM.removeprefix("version: 1\n"))
    assert fault.code == "SB121"
    (line,) = SNIPPET.findall(fault.help[0])
    assert findings(line + "\n" + ARM.removeprefix("version: 1\n")) == []


@pytest.mark.parametrize("way", [0, 1])
def test_second_root_is_connected_by_a_pasted_line(way: int) -> None:
    """Each line that the help offers for a second root connects the tree."""
    text = ARM.replace(
        "  base: {rest: true}", "  stand: {parts: [stand]}\n  stand_joint: {parts: [a]}\n  base: {rest: true}"
    )
    text += "  slide: {type: fixed, parent: base, child: stand_joint}\n"
    (fault,) = findings(text)
    assert (fault.code, fault.span.line) == ("SB450:disconnected", 5)
    assert "not connected to the root 'base'" in fault.message
    snippet = SNIPPET.findall(fault.help[way])[-1]
    assert findings(f"{text}  {snippet}\n") == []


def test_two_trees_are_connected_by_a_pasted_line() -> None:
    """A second tree of several links is connected at its root."""
    text = ARM + "  wrist: {type: fixed, parent: a, child: b}\n"
    text = text.replace("joints:", "  a: {parts: [a]}\n  b: {parts: [b]}\njoints:")
    (fault,) = findings(text)
    assert "link 'a'" in fault.message
    assert findings(f"{text}  {SNIPPET.findall(fault.help[0])[-1]}\n") == []


BLOCK = ARM.replace("{type: revolute, parent: base, child: forearm, limits:", "\n    type: revolute\n    limits:")
BLOCK = BLOCK.replace("upper: 1}}", "upper: 1}\n    parent: base\n    child: forearm")


@pytest.mark.parametrize("wrong", ["type:\trevolute", "type: \t revolute", "'type':\t'revolute'", "\ttype: revolute"])
def test_tab_is_replaced_by_a_pasted_line(wrong: str) -> None:
    """A tab that the parser rejects is reported with the corrected line."""
    text = BLOCK.replace("    type: revolute", "    " + wrong)
    fault = findings(text)[0]
    assert (fault.code, fault.span.line) == ("SB104", 9)
    assert text.split("\n")[8][fault.span.column - 1] == "\t"
    (line,) = SNIPPET.findall(fault.help[0])
    assert "\t" not in line
    assert findings(BLOCK.replace("    type: revolute", "    " + line.lstrip())) == []


def test_tabs_elsewhere_stay() -> None:
    """Tabs in quotes, comments and brackets are accepted."""
    text = BLOCK.replace("type: revolute", "type:\trevolute").replace("parent: base", "parent:\tbase") + "# a:\tb\n"
    text = text.replace("lower: -1, ", "lower:\t-1,\t")
    assert [(d.code, d.span.line) for d in findings(text)] == [("SB104", 9), ("SB104", 11)]
    assert findings(ARM.replace("[forearm]", '["a\tb"]')) == []


def test_decimal_comma_in_braces() -> None:
    """In braces ``1,5 N*m`` is a value and a key; the help has the corrected value."""
    text = ARM.replace("upper: 1}", "upper: 1,5 rad, effort: 2}")
    (fault,) = findings(text)
    assert (fault.code, SNIPPET.findall(fault.help[0])) == ("SB110", ["1.5 rad"])
    text = ARM.replace("joints:", "defaults: {density: 1,04}\njoints:")
    (fault,) = findings(text)  # not that 1 kg/m^3 is less than foam
    assert (fault.code, SNIPPET.findall(fault.help[0])) == ("SB110", ["1.04"])


def test_comma_that_is_missing_is_shown() -> None:
    """The help for two pairs without a comma has the comma."""
    (fault,) = (d for d in findings(ARM.replace("revolute, parent", "revolute parent")) if d.code == "SB104")
    assert SNIPPET.findall(fault.help[0]) == ["revolute, parent:"]


def test_colour_without_quotes_in_braces() -> None:
    """The help for a # that comments out the closing brace has the quoted colour."""
    text = ARM.replace("{rest: true}", "{rest: true}\nparts:\n  a: {color: #ff0000}")
    (fault,) = (d for d in findings(text) if d.code == "SB104")
    assert '"#ff0000"' in fault.help[0]


@pytest.mark.parametrize(
    ("added", "help"),
    [
        ("material: pla\n", "move it to 'defaults': `defaults: {material: pla}`"),
        ("actuators: {m: {joint: elbow, type: position, kp: 10}}\n", "did you mean 'kind'?"),
        ("defaults: {collision: {merge: hull}}\n", "one shape for a whole link: `collision: {merge: hull}` in `links`"),
    ],
)
def test_keys_at_home_elsewhere(added: str, help: str) -> None:
    """A setting of `defaults` at the top level, and the type of an actuator, are led to their keys."""
    (fault,) = findings(ARM + added)
    assert (fault.code, fault.help[0]) == ("SB120", help)


def test_a_list_where_a_word_is_required() -> None:
    """The message names the words, and nothing of the validator."""
    (fault,) = findings(ARM + "parts: {a: {collision: [1]}}\n")
    assert fault.code == "SB122"
    assert fault.message.startswith("parts rule 'a': collision: expected one of 'none', 'mesh',")
    assert fault.message.endswith(", not a list")
    (fault,) = findings(ARM + "root: {up: [0, 1, 0]}\n")
    assert fault.help == ("choices: 'z', '-z', 'y', '-y', 'x', '-x'",)


def test_a_joint_of_a_module_is_changed_by_set() -> None:
    """`arm/elbow` is a reference, not a name below `joints`: one finding, with the place of the change."""
    text = "version: 1\nrobot: r\nmodules: {arm: {file: arm.urdf}}\njoints: {arm/elbow: {limits: {upper: 1}}}\n"
    (finding,) = findings(text)
    assert finding.code == "SB126"
    assert finding.help[0].startswith("`modules: {arm: {set: {joints: {elbow: ...}}}}` changes that of module 'arm'")


def test_a_joint_is_not_offered_as_its_own_leader() -> None:
    """A misspelt leader has one finding, and its remedy is another joint."""
    text = ARM.replace("upper: 1}", "upper: 1}, mimic: {joint: elbo}") + "actuators: {elbow: {kind: motor}}\n"
    (finding,) = findings(text)
    assert (finding.code, finding.help) == ("SB130:joint", ("no other joints are defined",))
    (finding,) = findings(text.replace("elbo}", "left/elbow}"))
    assert finding.help[0].startswith("a joint of another module can lead one of the composing file's own `joints`")


def test_key_under_another_name_is_not_missing_too() -> None:
    """``parent_link`` is one error about the name, and `parent` is not reported as missing."""
    assert [d.code for d in findings(ARM.replace("parent:", "parent_link:"))] == ["SB120"]
