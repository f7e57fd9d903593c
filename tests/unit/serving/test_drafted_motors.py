"""What a draft has in comments becomes entries in the page: motors, fused parts; marks below an element are settled."""

from typing import Any

import pytest

from stepbot.serving.decisions import decisions
from stepbot.serving.local_server import Refused

from .test_values import after, parsed

ENTRIES = """# Joints that motors turn. Uncomment these lines to drive them.
# (`stepbot motors NAME`); without it, add `effort`.
# actuators:
#   pan_motor: {joint: pan, motor: STS3215, part: "servo, a:1"}  # REVIEW: it fits; one of STS3215-7.4V, STS3215-12V
#   tilt_motor: {joint: tilt, motor: STS3215, part: "servo, a:2"}  # REVIEW: as above
#   "roll motor": {joint: roll, kind: position, gains: auto}
"""
TEXT = f"""version: 1
robot: arm
step: arm.step

links:
  base: {{rest: true}}
  a:
    parts: [a]
    contact: rubber-on-floor  # REVIEW: a tyre; friction 0.7
  b:
    parts: [b]
    contact: rubber-on-floor  # as above
  c: {{parts: [c]}}

joints:
  pan: {{type: revolute, parent: base, child: a, limits: todo}}
  tilt: {{type: revolute, parent: a, child: b, limits: todo}}
  roll: {{type: continuous, parent: b, child: c}}

{ENTRIES}"""
MOTOR = "STS3215-12V"


def listed(text: str, diagnostics: tuple[dict[str, Any], ...] = ()) -> list[tuple[str, list[str], str]]:
    """Kind, names and text of all decisions."""
    found = decisions(parsed(text), {"connections": [], "diagnostics": diagnostics})
    return [(one["kind"], [keys[1] for keys in one["keys"]], one["text"]) for one in found]


def test_equal_questions_are_one() -> None:
    """Marks and motors that the draft says once are one decision with several places, and so are equal limits."""
    finding = {"code": "SB512", "severity": "warning", "file": "arm.robot.yaml", "help": ["weigh it"]}
    found = listed(TEXT, ({**finding, "message": "a", "line": 7}, {**finding, "message": "b", "line": 10}))
    assert found == [
        ("todo", ["pan", "tilt"], "limits"),
        ("motor", ["pan", "tilt"], "it fits; one of STS3215-7.4V, STS3215-12V"),
        ("motor", ["roll"], ""),
        ("review", ["a", "b"], "a tyre; friction 0.7"),
        ("finding", ["a", "b"], "a\nb"),
    ]
    models = [one["models"] for one in decisions(parsed(TEXT), {}) if one["kind"] == "motor"]
    assert models == [["STS3215-7.4V", "STS3215-12V"], []]


def test_motors_become_actuators() -> None:
    """The lines leave their comment for a section of their own; the last ones take the comment above along."""
    every = after(TEXT, action="drive", joints=["pan", "tilt"], motor=MOTOR)
    every = after(every, action="drive", joints=["roll"])
    assert every == TEXT.replace(
        ENTRIES,
        f"""actuators:
  pan_motor: {{joint: pan, motor: {MOTOR}, part: "servo, a:1"}}
  tilt_motor: {{joint: tilt, motor: {MOTOR}, part: "servo, a:2"}}
  roll motor: {{joint: roll, kind: position, gains: auto}}
""",
    )


def test_motors_can_be_declined() -> None:
    """Without a motor only the comment goes; a joint without a drafted one is refused."""
    assert after(TEXT, action="drive", joints=["pan", "tilt", "roll"], drop=True) == TEXT.replace(f"\n{ENTRIES}", "")
    with pytest.raises(Refused, match="no actuator"):
        after(TEXT, action="drive", joints=["elbow"])


def test_a_mark_below_an_element_is_settled() -> None:
    """A mark beside a value of a link is that link's, and goes with it."""
    changed = after(TEXT, action="settle", keys=["links", "a"])
    assert "contact: rubber-on-floor\n  b:" in changed
    assert after(changed, action="settle", keys=["links", "b"]).count("# as above") == 0
    assert "# REVIEW: a tyre" in after(TEXT, action="settle", keys=["links", "c"])


@pytest.mark.parametrize("below", ["collision: {merge: wheel}", "collision:\n      merge: wheel"])
def test_a_mark_beside_settings_of_its_own_is_settled(below: str) -> None:
    """A link with settings of their own below it, as a drafted wheel has."""
    text = TEXT.replace("# as above\n", f"# as above\n    {below}\n").replace("0.7\n", f"0.7\n    {below}\n")
    changed = after(text, action="all", edits=[{"action": "settle", "keys": ["links", name]} for name in "ab"])
    assert changed == text.replace("  # REVIEW: a tyre; friction 0.7", "").replace(
        "rubber-on-floor  # as above", "rubber-on-floor"
    )
    assert after(text, action="settle", keys=["links"]) == text


def test_findings_of_actuators_are_ignored_once() -> None:
    """Actuators have no list of ignored codes: that of the robot gets the code once."""
    edits = [{"action": "ignore", "keys": ["actuators", name], "code": "SB524"} for name in ("pan", "tilt")]
    assert after(TEXT, action="all", edits=edits).count("SB524") == 1


FUSED = """version: 1
robot: press
step: press.step
links:
  base: {rest: true}
  jaw: {parts: [jaw, "pin #2"]}
  # Fused parts that look movable. To free one, uncomment it and its joint, and take it off its link.
  # knob: {parts: ["knob#1"]}
  # "pin 2": {parts: ["pin #2"]}
  # my own note: keep

joints:
  slide: {type: prismatic, parent: base, child: jaw, limits: todo}
  # fused: 'knob#1' and 'base' are one link: pressed in by 0.02 mm, with a shoulder that is as wide as the whole collar
  #   of the knob
  # knob_joint: {type: continuous, parent: base, child: knob, origin: {xyz: [1 mm, 0, 0]}}  # score 0.40: shaft in bore
  # fused: 'pin #2' and 'jaw' are one link: a screw through both
  # "pin joint": {type: revolute, parent: jaw, child: "pin 2", limits: todo}  # score 0.30: round face
  # mine: keep
"""


def test_a_fused_part_is_freed_or_stays() -> None:
    """Its link and joint are written as drafted, its part leaves its list, and comments of the user stay."""
    assert listed(FUSED)[:2] == [
        (
            "fused",
            ["knob#1"],
            "'knob#1' and 'base' are one link: pressed in by 0.02 mm, with a shoulder that is as wide as the whole"
            " collar of the knob. Or continuous, score 0.40: shaft in bore",
        ),
        (
            "fused",
            ["pin #2"],
            "'pin #2' and 'jaw' are one link: a screw through both. Or revolute, score 0.30: round face",
        ),
    ]
    freed = after(FUSED, action="free", parts=["pin #2"])
    document = parsed(freed).document
    assert document.links["jaw"].parts == ("jaw",)
    assert document.links["pin 2"].parts == ("pin #2",)
    assert (document.joints["pin joint"].parent, document.joints["pin joint"].limits) == ("jaw", "todo")
    assert '# "pin' not in freed
    assert [one[1] for one in listed(freed) if one[0] == "fused"] == [["knob#1"]]
    fixed = after(FUSED, action="free", parts=["knob#1", "pin #2"], drop=True)
    kept = [line for line in FUSED.split("\n") if not line.startswith("  #") or "keep" in line]
    assert fixed == "\n".join(kept)
    with pytest.raises(Refused, match="no joint of these parts"):
        after(fixed, action="free", parts=["knob#1"])
    with pytest.raises(Refused, match="link 'base' is gone"):
        after(
            FUSED.replace("  base:", "  plate:").replace("parent: base, child: jaw", "parent: plate, child: jaw"),
            action="free",
            parts=["knob#1"],
        )
