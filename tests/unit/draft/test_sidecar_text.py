"""Drafts written as sidecars, which are then read, checked and built."""

from pathlib import Path

import pytest
from msgspec.structs import replace

from stepbot.assemble import build_robot
from stepbot.diagnostics import Diagnostics
from stepbot.draft.draft import (
    Alternative,
    Confidence,
    Draft,
    DraftClosure,
    DraftJoint,
    DraftLink,
    Option,
    OriginForm,
    OriginSnippet,
    Question,
)
from stepbot.draft.text.sidecar_text import equal_density, sidecar_text
from stepbot.robot.model import JointKind, Limit, Robot
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.load import load_sidecar, parse_sidecar
from stepbot.sidecar.located import Sidecar
from tests.unit.assemble.workshop import Workshop, at, axis

PIN = OriginSnippet(OriginForm.MATE, ("base", "arm"), radius=4e-3)
HINGE = DraftJoint(
    "elbow",
    JointKind.REVOLUTE,
    PIN,
    "-z",
    (0.0, 0.0, 0.01),
    (0.0, 0.0, -1.0),
    Confidence(0.9, ("shaft of r 4 mm in bore of r 4 mm", "10 mm engaged")),
    ("base", "arm"),
    parent="base",
    child="arm",
)
DRAFT = Draft(
    "test",
    "base",
    (DraftLink("base", (), Confidence(1.0), rest=True), DraftLink("arm", ("arm",), Confidence(0.95, ("one part",)))),
    (HINGE,),
    without_density=("",),
)


def shop() -> Workshop:
    """A base with a bore and an arm with a pin in it, 10 mm up."""
    made = Workshop()
    made.box("base", axes=[axis((0, 0, 10))])
    made.box("arm", X_PC=at(0, 0, 10), axes=[axis((0, 0, 0), bore=False)])
    return made


def read(text: str, folder: Path) -> tuple[Sidecar, Diagnostics]:
    """The sidecar of a text, and the findings of its checks."""
    path = folder / "test.robot.yaml"
    path.write_bytes(text.encode())
    diagnostics = Diagnostics()
    loaded = load_sidecar(path, diagnostics)
    assert loaded is not None, text + "\n".join(map(str, diagnostics))
    check_sidecar(loaded, diagnostics)
    return loaded, diagnostics


def built(draft: Draft, folder: Path, made: Workshop | None = None) -> tuple[Robot, Diagnostics]:
    """The robot of a draft; warnings are allowed, errors are not."""
    sidecar, found = read(sidecar_text(draft, "robot.step"), folder)
    made = made or shop()
    result = build_robot(made.assembly, sidecar, lambda: made.measures, found)
    assert result is not None, "\n".join(map(str, found))
    assert not found.has_errors
    return result.robot, found


def uncommented(text: str, line: str) -> str:
    """A sidecar in which a commented joint replaces the one above it."""
    lines = text.split("\n")
    at = next(i for i, one in enumerate(lines) if line in one)
    start = max(i for i in range(at) if lines[i].startswith("  elbow:"))
    lines[at] = lines[at].replace("# ", "", 1)
    return "\n".join([*lines[:start], *lines[at:]])


def test_sure_joint_is_written_with_its_evidence_and_no_mark(tmp_path: Path) -> None:
    """A certain joint has its score and evidence as a comment, limits to fill in, and no REVIEW."""
    text = sidecar_text(DRAFT, "robot.step")
    assert "  # score 0.90: shaft of r 4 mm in bore of r 4 mm; 10 mm engaged\n  elbow:\n" in text
    assert "REVIEW" not in text.partition("joints:")[2]
    robot, found = built(DRAFT, tmp_path)
    (joint,) = robot.joints
    assert (joint.kind, joint.parent, joint.child) == (JointKind.REVOLUTE, "base", "arm")
    assert joint.axis == (0.0, 0.0, -1.0)
    assert [one.code for one in found] == ["SB463", "SB522"]


def test_text_is_the_smallest_that_says_all() -> None:
    """The whole text of a small draft, byte by byte."""
    assert sidecar_text(replace(DRAFT, without_density=()), "cad/robot.step") == (
        "# yaml-language-server: $schema=robot-1.schema.json\n"
        "# Drafted by `stepbot init` from the STEP: shapes, contacts, names. A score from 0 to 1 ranks the evidence.\n"
        "# Check each REVIEW, fill in each `todo`, then run `stepbot check --step` and `stepbot convert`.\n"
        "#\n"
        "# Found: 1 joint\n"
        "#   base  (root)\n"
        "#     arm: revolute, 0.90\n"
        "#\n"
        "version: 1\n"
        "robot: test\n"
        "step: cad/robot.step\n"
        "\n"
        "defaults: {collision: auto}\n"
        "\n"
        "links:\n"
        "  base:  # root: no joint moves it\n"
        "    rest: true  # everything that no other link claims\n"
        "  # one part\n"
        "  arm:\n"
        '    parts: ["arm"]\n'
        "\n"
        "joints:\n"
        "  # score 0.90: shaft of r 4 mm in bore of r 4 mm; 10 mm engaged\n"
        "  elbow:\n"
        "    type: revolute\n"
        "    parent: base\n"
        "    child: arm\n"
        '    origin: {mate: ["base", "arm"], radius: 4 mm}\n'
        "    axis: -z\n"
        "    limits: todo\n"
    )


def test_code_page_that_was_given_is_kept(tmp_path: Path) -> None:
    """A given encoding is written into the sidecar."""
    sidecar, _ = read(sidecar_text(DRAFT, "robot.step", encoding="cp1251"), tmp_path)
    assert sidecar.document.step_encoding == "cp1251"


def test_weak_joint_is_marked_with_other_readings_to_uncomment(tmp_path: Path) -> None:
    """Below 0.8 a joint has a REVIEW mark, and each commented alternative builds in its place."""
    slide = Alternative(JointKind.PRISMATIC, "base", "arm", Confidence(0.6, ("no stop",)), HINGE.point, HINGE.direction)
    other = Alternative(JointKind.BALL, "base", "arm", Confidence(0.5), (0.01, 0.0, 0.0))
    across = Alternative(JointKind.CONTINUOUS, "base", "arm", Confidence(0.5), (0.0, 0.0, 0.0), (0.0, 0.6, 0.8))
    weak = replace(
        HINGE, confidence=Confidence(0.7, ("a pin",)), review="turn or slide?", alternatives=(slide, other, across)
    )
    draft = replace(DRAFT, joints=(weak,))
    text = sidecar_text(draft, "robot.step")
    assert "  # REVIEW: turn or slide?\n  elbow:\n" in text
    assert built(draft, tmp_path)[0].joints[0].kind is JointKind.REVOLUTE
    for kind in (JointKind.PRISMATIC, JointKind.BALL, JointKind.CONTINUOUS):
        sidecar, found = read(uncommented(text, f"# elbow: {{type: {kind}"), tmp_path)
        made = shop()
        result = build_robot(made.assembly, sidecar, lambda: made.measures, found)  # noqa: B023 - called at once
        assert result is not None, "\n".join(map(str, found))
        assert not found.has_errors
        assert result.robot.joints[0].kind is kind
    joint = result.robot.joints[0]
    assert joint.X_PC.turn(joint.axis) == pytest.approx((0.0, 0.6, 0.8))


def test_another_reading_of_a_joint_has_its_axis(tmp_path: Path) -> None:
    """A slide in place of a hinge is along the hinge's axis, also if the sidecar states that axis."""
    origin = OriginSnippet(OriginForm.XYZ, xyz=(0.0, 0.0, 0.01))
    turning = replace(HINGE, origin=origin, axis="x", direction=(1.0, 0.0, 0.0))
    slide = Alternative(JointKind.PRISMATIC, "base", "arm", Confidence(0.6), turning.point, turning.direction)
    text = sidecar_text(replace(DRAFT, joints=(replace(turning, alternatives=(slide,)),)), "robot.step")
    sidecar, found = read(uncommented(text, "# elbow: {type: prismatic"), tmp_path)
    made = shop()
    result = build_robot(made.assembly, sidecar, lambda: made.measures, found)
    assert result is not None, "\n".join(map(str, found))
    (joint,) = result.robot.joints
    assert (joint.kind, joint.X_PC.turn(joint.axis).tolist()) == (JointKind.PRISMATIC, [1.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("densities", "shared"),
    [([7850.0] * 3, 0.0), ([7850.0] * 4, 7850.0), ([7850.0] * 4 + [2700.0], 0.0), ([None] * 4, 0.0)],
)
def test_several_solids_of_one_density_are_suspected(densities: list[float | None], shared: float) -> None:
    """Four solids and more that all have one density may have a program's default; surfaces have none."""
    made = Workshop()
    for n in range(len(densities)):
        made.box(f"box {n}")
    values = [None] * (len(made.assembly.components) - len(densities)) + densities
    solids = tuple(replace(c, density=one) for c, one in zip(made.assembly.components, values, strict=True))
    assert equal_density(replace(made.assembly, components=solids)) == shared


def test_joint_that_is_not_chosen_is_fixed_with_the_guess_beneath(tmp_path: Path) -> None:
    """Below 0.5 a joint of the tree is a comment; a fixed joint connects the links."""
    draft = replace(DRAFT, joints=(replace(HINGE, confidence=Confidence(0.4)),))
    assert built(draft, tmp_path)[0].joints[0].kind is JointKind.FIXED
    sidecar, found = read(uncommented(sidecar_text(draft, "robot.step"), "a guess, score 0.40"), tmp_path)
    assert sidecar.document.joints["elbow"].type is JointKind.REVOLUTE
    assert not found.has_errors


def test_guess_that_is_the_joint_itself_is_not_repeated() -> None:
    """A fixed joint that is not chosen has no comment with the same joint beneath it."""
    rigid = replace(HINGE, type=JointKind.FIXED, axis="z", limits=None, confidence=Confidence(0.0))
    text = sidecar_text(replace(DRAFT, joints=(rigid,)), "robot.step")
    assert "    type: fixed\n" in text
    assert "a guess" not in text


def test_actuators_of_motors_are_lines_to_uncomment(tmp_path: Path) -> None:
    """A joint that a named motor turns has an actuator as a comment; uncommented, it drives the joint."""
    assert "actuators" not in sidecar_text(DRAFT, "robot.step")
    driven = replace(HINGE, motor="servo")
    text = sidecar_text(replace(DRAFT, joints=(driven,)), "robot.step")
    assert "# actuators:\n#   elbow_motor: {joint: elbow, kind: position, gains: auto}\n" in text
    sidecar, found = read(text.replace("# actuators:\n#   ", "actuators:\n  "), tmp_path)
    made = shop()
    result = build_robot(made.assembly, sidecar, lambda: made.measures, found)
    assert result is not None
    (motor,) = result.robot.actuators
    assert (motor.joint, motor.kp > 0.0) == ("elbow", True)


@pytest.mark.parametrize("score", [0.9, 0.3])
def test_closures(score: float, tmp_path: Path) -> None:
    """A closure is written like a joint, below 0.5 as a comment; an empty section is a comment, too."""
    closure = DraftClosure(
        "loop", JointKind.REVOLUTE, PIN, "z", HINGE.point, HINGE.direction, Confidence(score), ("base", "arm"),
        link_a="base", link_b="arm",
    )  # fmt: skip
    sidecar, _ = read(sidecar_text(replace(DRAFT, closures=(closure,)), "robot.step"), tmp_path)
    assert list(sidecar.document.closures) == (["loop"] if score > 0.5 else [])


def test_every_kind_of_joint_is_valid(tmp_path: Path) -> None:
    """Each type has the keys that it requires and no others; an unknown pitch is not written."""
    for kind in JointKind:
        joint = replace(
            HINGE, type=kind, axis="x", axis2="y", origin=OriginSnippet(OriginForm.XYZ, rpy=(0.1, 0.0, 1.0))
        )
        robot, found = built(replace(DRAFT, joints=(joint,)), tmp_path)
        assert robot.joints[0].kind is (JointKind.CYLINDRICAL if kind is JointKind.SCREW else kind)
        assert {one.code for one in found} <= {"SB463", "SB522"}
    known = replace(HINGE, type=JointKind.SCREW, pitch=2e-3)
    assert built(replace(DRAFT, joints=(known,)), tmp_path)[0].joints[0].pitch == pytest.approx(2e-3 / 6.283185307)


def test_limits_and_drawn_position_are_written_in_their_units(tmp_path: Path) -> None:
    """Limits stated in the file are degrees or millimetres, beside the drawn position."""
    turning = replace(HINGE, limits=Limit(-1.5707963267948966, 0.5), limits_from="stated in the STEP", zero=0.25)
    text = sidecar_text(replace(DRAFT, joints=(turning,)), "robot.step")
    assert "limits: {lower: -90 deg, upper: 28.64788976 deg}" in text
    robot, found = built(replace(DRAFT, joints=(turning,)), tmp_path)
    limit = robot.joints[0].limit
    assert (limit.lower, limit.upper) == pytest.approx((-1.5707963267948966, 0.5), abs=1e-9)
    assert robot.joints[0].drawn_position == pytest.approx(0.25, abs=1e-9)
    assert [one.code for one in found] == ["SB522"]
    sliding = replace(turning, type=JointKind.PRISMATIC, limits=Limit(-0.02, 0.0315), limits_from="", zero=0.0)
    assert "{lower: -20 mm, upper: 31.5 mm}" in sidecar_text(replace(DRAFT, joints=(sliding,)), "robot.step")


def test_names_are_made_valid_and_unique(tmp_path: Path) -> None:
    """Reserved, duplicate or invalid names are replaced; of a link and a joint the link keeps its name."""
    names = ("world", "a/b <x>", "a_b_x", "yes", "Größe v2:1", "arm\u2028", "__x__")
    links = [DraftLink("arm", (), Confidence(1.0), rest=True), *(DraftLink(n, (n,), Confidence(1.0)) for n in names)]
    joints = [replace(HINGE, name="arm", parent="arm", child=n, origin=OriginSnippet(OriginForm.XYZ)) for n in names]
    made = Workshop()
    made.box("frame")
    for name in names:
        made.box(name)
    paths = [component.path for component in made.assembly.components[2:]]
    links = [links[0], *(replace(link, parts=(path,)) for link, path in zip(links[1:], paths, strict=True))]
    robot, _ = built(Draft("test", "arm", tuple(links), tuple(joints), without_density=("",)), tmp_path, made)
    assert [link.name for link in robot.links] == [
        "arm", "world_link", "a_b_x", "a_b_x_2", "yes", "Größe_v2_1", "arm_2", "x"
    ]  # fmt: skip
    assert [joint.name for joint in robot.joints] == ["arm_3", "arm_4", "arm_5", "arm_6", "arm_7", "arm_8", "arm_9"]


def test_paths_of_any_characters_are_quoted(tmp_path: Path) -> None:
    """Quotes, stars, slashes, hashes, colons and control characters in part names survive, in lists of any length."""
    names = ["a: b", "c #1", 'in "quotes"', "it's", "s*r", "x/y", "back\\slash", "tab\tbed", "{a}", "[b]", "ünï", "- z"]
    made = Workshop()
    made.box("base", axes=[axis((0, 0, 10))])
    for name in names:
        made.box(name, X_PC=at(0, 0, 10), axes=[axis((0, 0, 0), bore=False)])
    paths = tuple(component.path for component in made.assembly.components[2:])
    joint = replace(HINGE, origin=OriginSnippet(OriginForm.MATE, ("base", paths[2])))
    robot, found = built(
        replace(DRAFT, links=(DRAFT.links[0], replace(DRAFT.links[1], parts=paths)), joints=(joint,)), tmp_path, made
    )
    assert robot.links[1].mass_properties.mass == pytest.approx(12e-3)
    assert [one.code for one in found] == ["SB463", "SB522"]


def test_materials_get_typical_densities_and_the_rest_a_placeholder(tmp_path: Path) -> None:
    """A material of known name has its typical density, others a placeholder, each with a REVIEW mark."""
    made = shop()
    made.made_of(2, "ABS Plastic, black")
    draft = replace(DRAFT, without_density=("ABS Plastic, black", "Unobtainium: #7", ""))
    text = sidecar_text(draft, "robot.step")
    assert '  "ABS Plastic, black": {density: 1050 kg/m^3}  # REVIEW: typical of ABS' in text
    assert "Unobtainium: #7" in text
    assert "defaults: {density: todo, collision: auto}  # REVIEW" in text
    robot, _ = built(draft, tmp_path, made)
    assert [link.mass_properties.mass for link in robot.links] == pytest.approx([1e-3, 1.05e-3])


def test_comments_end_where_their_line_ends(tmp_path: Path) -> None:
    """Line breaks in evidence, which may contain part names, do not end a comment."""
    evil = "line\nrobot: evil\u2028{"
    other = Alternative(JointKind.FIXED, evil, evil, Confidence(0.5, (evil,)))
    joint = replace(HINGE, confidence=Confidence(0.7, (evil,)), review=evil, alternatives=(other,))
    draft = replace(DRAFT, joints=(joint,), notes=(evil,), offered=(other,))
    sidecar, found = read(sidecar_text(draft, "robot.step"), tmp_path)
    assert sidecar.document.robot == "test"
    assert not found.has_errors


def test_a_fused_part_is_freed_by_its_two_lines() -> None:
    """The lines of a fused part say what holds it; uncommented, they make a link and a joint of it."""
    fused = Alternative(
        *(JointKind.REVOLUTE, "base", "arm", Confidence(0.6, ("a pair of coaxial holes",)), (0.0, 0.0, 0.01)),
        direction=(0.0, 0.0, 1.0),
        link="base",
        moving="arm",
        held="faces in contact",
        freed="arm",
    )
    base = DraftLink("base", (), Confidence(1.0), rest=True, drawn="ベース")
    text = sidecar_text(Draft("test", "base", (base,), offered=(fused,), without_density=("",)), "robot.step")
    assert "# fused: 'arm' and 'base' are one link: faces in contact" in text
    assert "# in the CAD: 'ベース'" in text
    for line in ("# joints:", "  # arm:", "  # arm_joint:"):
        assert f"\n{line}" in text
        text = text.replace(f"\n{line}", f"\n{line.replace('# ', '')}")
    diagnostics = Diagnostics()
    sidecar = parse_sidecar(
        text.replace("limits: todo", "limits: {lower: -1, upper: 1}"), Path("r.robot.yaml"), diagnostics
    )
    assert sidecar is not None, list(diagnostics)
    made = shop()
    result = build_robot(made.assembly, sidecar, lambda: made.measures, diagnostics)
    assert result is not None, list(diagnostics)
    assert [(joint.name, joint.parent, joint.child) for joint in result.robot.joints] == [("arm_joint", "base", "arm")]


def test_the_top_shows_the_tree_and_asks(tmp_path: Path) -> None:
    """Links are below what moves them, and questions are lines to uncomment; answers are kept."""
    links = [DraftLink("base", (), Confidence(1.0), rest=True)]
    links += [DraftLink(name, (name,), Confidence(1.0)) for name in ("arm", "leg", "hand")]
    joints = [
        replace(HINGE, name=f"to_{child}", parent=parent, child=child, origin=OriginSnippet(OriginForm.XYZ))
        for parent, child in (("base", "arm"), ("base", "leg"), ("arm", "hand"))
    ]
    options = (Option("revolute", "revolute", is_drafted=True), Option("fixed", "fixed", is_drafted=False))
    question = Question("arm + base", "Does 'arm' turn on 'base', or is it fixed?", options, 1)
    draft = Draft("test", "base", tuple(links), tuple(joints), questions=(question,), answers={"stands": "base"})
    text = sidecar_text(draft, "robot.step")
    assert (
        "# Found: 3 joints\n"
        "#   base  (root)\n"
        "#     arm: revolute, 0.90\n"
        "#       hand: revolute, 0.90\n"
        "#     leg: revolute, 0.90\n"
    ) in text
    line = "  # arm + base: revolute  # as drafted; or fixed\n"
    assert line in text
    asked, _ = read(text, tmp_path)
    assert asked.document.answers == {"stands": "base"}
    answered, _ = read(text.replace(line, line.replace("  # ", "  ", 1)), tmp_path)
    assert answered.document.answers == {"stands": "base", "arm + base": "revolute"}


def test_lists_that_are_cut_say_so() -> None:
    """What is not listed in the sidecar is counted there."""
    fused = [
        Alternative(
            *(JointKind.REVOLUTE, "base", f"arm{n}", Confidence(0.6), (0.0, 0.0, 0.01), (0.0, 0.0, 1.0)),
            link="base",
            moving=f"arm{n}",
            held="",
            freed="arm",
        )
        for n in range(20)
    ]
    text = sidecar_text(replace(DRAFT, offered=tuple(fused)), "robot.step")
    assert text.count("  # 8 more: `stepbot init --json` lists all\n") == 1
