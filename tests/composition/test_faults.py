"""Faults in modules are reported once, in their own file, with the module that uses it."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics, StepbotError
from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.pipeline.composing import compose
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.sidecars import load
from stepbot.robot.kinematics import Tree, link_poses_at
from stepbot.robot.model import Robot

from .described import ARM, composing, joint, link, urdf

Errors = Callable[[Mapping[str, str], Diagnostics], list[str]]
MESH = "<visual><geometry><mesh filename='package://elsewhere/part.obj'/></geometry></visual>"


def test_a_fault_of_a_file_that_is_used_four_times(errors: Errors) -> None:
    """One error, at the line of the module's own sidecar; a note names the first module that uses it."""
    inner = composing("arm: {file: arm.urdf}", more="frames: {x: {link: arm/bse, origin: {relative_to: arm/base}}}\n")
    first, *others = (f"m{i}: {{file: inner.robot.yaml{', at: m0/x' if i else ''}}}" for i in range(4))
    diagnostics = Diagnostics()
    files = {"r.robot.yaml": composing(first, *others), "inner.robot.yaml": inner, "arm.urdf": ARM}
    (line,) = errors(files, diagnostics)
    assert line.startswith("SB152 6:20 frame 'x': link: no frame or link 'bse' in module 'arm'")
    (error,) = [one for one in diagnostics if one.severity == "error"]
    assert error.span.file.endswith("inner.robot.yaml")
    assert [note.split(" of ")[0] for note in error.notes] == ["module 'm0'"]


def test_meshes_of_a_package(tmp_path: Path, write: Callable[[Mapping[str, str]], None], errors: Errors) -> None:
    """A URDF whose package is not found is an error with the module; with the package path it is composed."""
    files = {"r.robot.yaml": composing("arm: {file: arm.urdf}"), "arm.urdf": urdf("arm", link("base", 1.0, MESH))}
    diagnostics = Diagnostics()
    (line,) = errors(files, diagnostics)
    assert line.startswith("SB861")
    assert any("module 'arm' of" in note for one in diagnostics for note in one.notes)
    package = tmp_path / "packages" / "elsewhere"
    package.mkdir(parents=True)
    (package / "part.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
    options = Options(tmp_path / "out", package_path=(tmp_path / "packages",))
    robot: Robot = compose(
        load(tmp_path / "r.robot.yaml", options, diagnostics := Diagnostics()), options, diagnostics
    ).robot
    assert [asset.name for asset in robot.meshes] == ["part"]


def test_an_sdformat_with_an_include(errors: Errors) -> None:
    """It is as unsupported as alone, and the note names the module."""
    include = '<sdf version="1.9"><model name="m"><include><uri>other</uri></include></model></sdf>'
    diagnostics = Diagnostics()
    lines = errors({"r.robot.yaml": composing("arm: {file: m.sdf}"), "m.sdf": include}, diagnostics)
    assert [one.partition(" is not supported")[0] for one in lines] == ["SB823 0:0 <include> of 'other'"]
    assert "module 'arm'" in str(next(one.notes for one in diagnostics if one.code == "SB823"))


def test_a_gap_between_the_ends_of_a_closure(errors: Errors) -> None:
    """A closure between modules whose ports are 2 mm apart states the distance, at its own line."""
    more = "closures:\n  ring: {type: revolute, link_a: a/tip, link_b: b/tip}\n"
    modules = ("a: {file: arm.urdf}", "b: {file: arm.urdf, at: a/base, offset: {xyz: [0, 0, 2 mm]}}")
    files = {"r.robot.yaml": composing(*modules, more=more), "arm.urdf": ARM}
    (line,) = errors(files, Diagnostics())
    assert line.startswith("SB411 8:3 closure 'ring': open by 0.002 m")


@pytest.mark.parametrize("origin", [", origin: auto", ", origin: {auto: true}"])
def test_auto_between_modules_is_no_origin(origin: str, composed: Callable[..., Robot]) -> None:
    """Ports coincide, in joints and in closures, as without an origin."""
    limits = "limits: {lower: 0, upper: 1, effort: 1, velocity: 1}"
    more = f"""joints: {{wrist: {{type: revolute, parent: a/tip, child: c/base, {limits}%s}}}}
closures: {{ring: {{type: revolute, link_a: a/tip, link_b: b/tip%s}}}}
"""
    modules = ("a: {file: arm.urdf}", "b: {file: arm.urdf, at: a/base}", "c: {file: arm.urdf}")
    robots = [
        composed({"r.robot.yaml": composing(*modules, more=more % (one, one)), "arm.urdf": ARM}, Diagnostics())
        for one in (origin, "")
    ]
    assert robots[0] == robots[1]
    assert robots[0].joint_by_name["wrist"].X_PC == IDENTITY


def test_a_prefix_with_a_slash(errors: Errors) -> None:
    """A slash leads into modules, and cannot be in a name."""
    files = {"r.robot.yaml": composing("arm: {file: arm.urdf, prefix: 'a/'}"), "arm.urdf": ARM}
    assert errors(files, Diagnostics())[0].startswith("SB126 5:33 modules.arm.prefix: 'a/' contains '/'")


@pytest.mark.slow
@pytest.mark.parametrize("count", [256, 257])
def test_the_number_of_modules_is_limited(count: int, composed: Callable[..., Robot]) -> None:
    """256 instances of one file are composed; one more is an error at that module."""
    modules = ("m0: {file: arm.urdf}", *(f"m{i}: {{file: arm.urdf, at: m0/tip}}" for i in range(1, count)))
    files, diagnostics = {"r.robot.yaml": composing(*modules), "arm.urdf": ARM}, Diagnostics()
    if count <= 256:
        assert len(composed(files, diagnostics).links) == 2 * count
        return
    with pytest.raises(StepbotError, match=r"SB150.*'m256': more than 256 modules"):
        composed(files, diagnostics)


def test_each_configuration_is_computed_once(composed: Callable[..., Robot], monkeypatch: pytest.MonkeyPatch) -> None:
    """However many instances of a file there are, poses of the whole and of the file are computed equally often."""
    calls: list[str] = []

    def counted(robot: Robot, of: Sequence[Mapping[str, float]], tree: Tree) -> list[dict[str, Pose]]:
        calls.extend(robot.name for _ in of)
        return link_poses_at(robot, of, tree)

    monkeypatch.setattr("stepbot.engines.reference.link_poses_at", counted)
    counts = []
    for count in (4, 32):
        calls.clear()
        lines = ("m0: {file: arm.urdf}", *(f"m{i}: {{file: arm.urdf, at: m0/tip}}" for i in range(1, count)))
        composed({"r.robot.yaml": composing(*lines), "arm.urdf": ARM}, Diagnostics())
        counts.append(len(calls))
    assert counts[0] == counts[1] > 0


@pytest.mark.slow
def test_a_bare_step_needs_a_density(composed: Callable[..., Robot]) -> None:
    """The warning is at the module, since there is no other file to write a density into; `set` gives it."""
    text = "fixture: {file: LIBRARY/robotiq_2f85/2f85.step%s}"
    diagnostics = Diagnostics()
    composed({"r.robot.yaml": composing(text % "")}, diagnostics)
    (placeholder,) = [one for one in diagnostics if one.code == "SB522"]
    assert placeholder.span.file.endswith("r.robot.yaml")
    assert placeholder.help == ("write the density of its material: `set: {defaults: {density: 2700 kg/m^3}}`",)
    diagnostics = Diagnostics()
    composed({"r.robot.yaml": composing(text % ", set: {defaults: {density: 2700}}")}, diagnostics)
    assert "SB522" not in {one.code for one in diagnostics}


ARM_ALONE, HAND_AT_TIP = "arm: {file: arm.urdf}", "hand: {file: hand.urdf, at: arm/tip}"
FREE_HAND, WRIST = "hand: {file: hand.urdf}", "type: revolute, parent: arm/tip, limits: {lower: 0, upper: 1}"
HAND = urdf("hand", link("palm"), link("f1"), link("f2"), joint("grip", "palm", "f1"))
HAND = HAND.replace("</robot>", joint("follow", "palm", "f2", mimic='"grip"') + "</robot>")
MISTAKES: Mapping[str, tuple[tuple[str, ...], str, str]] = {
    "SB150 5:15 module 'arm': file '.' is a folder": (("arm: {file: .}",), "", "name the sidecar"),
    "SB150 5:15 module 'arm': file 'x.stl': unsupported type of file": (
        ("arm: {file: x.stl}",),
        "",
        "a sidecar (.yaml)",
    ),
    "SB150 5:15 module 'arm': file '.\\arm.urdf' not found": ((r"arm: {file: '.\arm.urdf'}",), "", "./arm.urdf"),
    "SB150 5:3 module 'arm': neither `file` nor `mirror_of` is set": (("arm: {at: world}",), "", ""),
    "SB152 6:31 modules.hand.at: no link, frame or module 'arm.tip'": (
        (ARM_ALONE, "hand: {file: hand.urdf, at: arm.tip}"),
        "",
        "did you mean 'arm/tip'?",
    ),
    "SB152 6:31 modules.hand.at: no link, frame or module 'arm::tip'": (
        (ARM_ALONE, "hand: {file: hand.urdf, at: 'arm::tip'}"),
        "",
        "did you mean 'arm/tip'?",
    ),
    "SB126 6:31 modules.hand.at: 'arm/': empty name before or after '/'": (
        (ARM_ALONE, "hand: {file: hand.urdf, at: arm/}"),
        "",
        "arm/tool0",
    ),
    "SB154 5:3 module 'arm': attached in a circle: arm -> hand -> arm": (
        ("arm: {file: arm.urdf, at: hand/palm}", HAND_AT_TIP),
        "",
        "it is the root then",
    ),
    "SB154 6:3 module 'arm': attached in a circle: arm -> hand -> arm": (
        (
            "root: {file: arm.urdf}",
            "arm: {file: arm.urdf, at: hand/palm}",
            HAND_AT_TIP,
            "on: {file: arm.urdf, at: arm/tip}",
        ),
        "",
        "",
    ),
    "SB154 8:88 joint 'wrist': 'hand_f1' moves relative to the root link of its part": (
        (ARM_ALONE, FREE_HAND, "image: {mirror_of: hand}"),
        f"joints: {{wrist: {{{WRIST}, child: hand/f1}}}}\n",
        "",
    ),
    "SB137 5:25 module 'arm': 'offset' without 'at'": (
        ("arm: {file: arm.urdf, offset: {xyz: [0, 0, 1]}}",),
        "",
        "at: world",
    ),
    "SB137 6:27 module 'hand': 'by' without 'at'": (
        (ARM_ALONE, "hand: {file: hand.urdf, by: palm}"),
        f"joints: {{wrist: {{{WRIST}, child: hand}}}}\n",
        "as its `child`",
    ),
    "SB137 5:25 module 'arm': 'flip' without 'mirror'": (
        ("arm: {file: arm.urdf, flip: [lift]}",),
        "",
        "reverse `axis`",
    ),
    "SB137 7:42 module 'other': 'set' without 'file'": (
        (ARM_ALONE, HAND_AT_TIP, "other: {mirror_of: hand, at: arm/base, set: {joints: {}}, prefix: b}"),
        "",
        "in module 'hand'",
    ),
    "SB135 6:44 module 'b': link 'base': duplicate name (also a link of module 'arm') and 2 more names": (
        ("arm: {file: arm.urdf, prefix: ''}", "b: {file: arm.urdf, at: arm/tip, prefix: ''}"),
        "",
        "remove `prefix`",
    ),
    "SB126 5:3 modules.world: 'world' is reserved": (("world: {file: arm.urdf}",), "", ""),
    "SB135 5:3 module 'arm': duplicate name (also used by frame 'arm')": (
        (ARM_ALONE,),
        "frames: {arm: {link: arm/tip, origin: {relative_to: arm/tip}}}\n",
        "rename one of them",
    ),
    "SB456 5:63 joint 'lift': lower limit 3 is above upper limit 2": (
        ("arm: {file: arm.urdf, set: {joints: {lift: {limits: {lower: 3}}}}}",),
        "",
        "",
    ),
    "SB138 5:63 joint 'lift': lower: '-3 mm' is not an angle": (
        ("arm: {file: arm.urdf, set: {joints: {lift: {limits: {lower: -3 mm}}}}}",),
        "",
        "45 deg",
    ),
    "SB138 5:38 module 'arm': home: lift: '3 mm' is not an angle": (
        ("arm: {file: arm.urdf, home: {lift: 3 mm}}",),
        "",
        "",
    ),
    "SB152 6:24 actuator 'm': joint: no joint 'lift'": (
        (ARM_ALONE,),
        "actuators: {m: {joint: lift, kind: motor}}\n",
        "did you mean 'arm/lift'?",
    ),
    "SB459 7:24 actuator 'm': joint 'hand/follow' mimics joint 'hand/grip' and cannot be actuated": (
        (ARM_ALONE, HAND_AT_TIP),
        "actuators: {m: {joint: hand/follow, kind: motor}}\n",
        "use joint 'hand/grip'",
    ),
    "SB152 6:20 frame 'f': circular frame reference": (
        (ARM_ALONE,),
        "frames: {f: {link: arm/tip, origin: {relative_to: g}}, g: {link: arm/tip, origin: {relative_to: f}}}\n",
        "",
    ),
    "SB121 6:7 sidecar: missing key 'links'": ((ARM_ALONE,), "step: arm.step\n", "rest: true"),
    "SB121 6:17 link 'plate': 'rest' without 'step'": ((ARM_ALONE,), "links: {plate: {rest: true}}\n", "step: "),
    "SB160 6:46 module 'hand': home: outside the limits of a joint: 'grip' at 90 (-1 to 2)": (
        (ARM_ALONE, "hand: {file: hand.urdf, at: arm/tip, home: {grip: 90}}"),
        "",
        "`grip: 90 deg`",
    ),
    "SB120 6:40 modules.hand: unknown key 'joints'": (
        (ARM_ALONE, "hand: {file: hand.urdf, at: arm/tip, joints: {grip: {type: fixed}}}"),
        "",
        "`set: {joints: {grip: {type: fixed}}}`",
    ),
    "SB152 6:31 modules.hand.at: no link, frame or module 'wrld'": (
        (ARM_ALONE, "hand: {file: hand.urdf, at: wrld}"),
        "",
        "did you mean 'world'?",
    ),
    "SB150 5:15 module 'arm': file 'library/arm2' not found": (("arm: {file: library/arm2}",), "", "'library:arm2'"),
    "SB137 6:1 sidecar: 'parts' without 'step'": ((ARM_ALONE,), "parts: {'**': {density: 2700}}\n", "`set`"),
}


@pytest.mark.parametrize("expected", MISTAKES)
def test_a_mistake_is_one_error_with_place_and_remedy(expected: str, errors: Errors) -> None:
    """Each cause is reported once, where it is written, with what to write instead."""
    modules, more, remedy = MISTAKES[expected]
    files = {"r.robot.yaml": composing(*modules, more=more), "arm.urdf": ARM, "hand.urdf": HAND, "x.stl": "solid"}
    (line,) = errors(files, diagnostics := Diagnostics())
    assert line.startswith(expected)
    (help,) = [one.help for one in diagnostics if one.severity == "error"]
    assert remedy in " ".join(help)


@pytest.mark.slow
def test_paths_lead_into_modules_of_modules(composed: Callable[..., Robot], errors: Errors) -> None:
    """`home` and `without` take paths; unknown ones list paths, and a middle part that is unknown is not skipped."""
    inner = composing(ARM_ALONE, HAND_AT_TIP)
    files = {"inner.robot.yaml": inner, "arm.urdf": ARM, "hand.urdf": HAND}
    changed = "a: {file: inner.robot.yaml, home: {arm/lift: 0.5}, without: [hand]}"
    robot = composed({"r.robot.yaml": composing(changed), **files}, Diagnostics())
    assert [link.name for link in robot.links] == ["a_arm_base", "a_arm_tip"]
    assert robot.joint_by_name["a_arm_lift"].drawn_position == 0.5
    for path in ("b/arm_tip", "tip"):
        wrong = composing("a: {file: inner.robot.yaml}", f"b: {{file: arm.urdf, at: a/{path}}}")
        (line,) = errors({"r.robot.yaml": wrong, **files}, diagnostics := Diagnostics())
        assert line.startswith(f"SB152 6:27 modules.b.at: no frame or link '{path}' in module 'a'")
        assert "ports of 'a': arm/base, arm/tip, hand/palm" in " ".join(
            *(one.help for one in diagnostics if one.code == "SB152")
        )
