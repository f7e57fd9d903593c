"""Variants of a sidecar, and values that a composing file changes in a module."""

import json
from collections.abc import Callable, Mapping
from math import inf
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

from stepbot.diagnostics import Diagnostics, StepbotError
from stepbot.formats.usd.asset import configurations
from stepbot.pipeline.composing import compose
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.sidecars import load
from stepbot.robot.model import Cylinder, JointKind, Robot
from tests.command_line import stepbot

ARM = """
    <robot name="arm">
      <link name="base"><inertial><mass value="2"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <link name="upper"><inertial><mass value="1"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="lift" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
        <limit lower="-1" upper="1" effort="10" velocity="2"/></joint>
    </robot>
    """
HAND = """
    version: 1
    robot: hand
    modules: {palm: {file: palm.urdf, prefix: ""}}
    links: {finger: &finger {inertial: {mass: 0.1, com: [0, 0, 0], inertia: {ixx: 1, iyy: 1, izz: 1}}}}
    frames: {tip: {link: palm, origin: {xyz: [0, 0, 0.1], relative_to: palm}}}
    joints: {grip: {type: revolute, parent: tip, child: finger, limits: {lower: 0, upper: 1, effort: 5, velocity: 1}}}
    variants: {strong: {joints: {grip: {limits: {effort: 50}}}}}
    """
PALM = """
    <robot name="palm"><link name="palm"><inertial><mass value="0.5"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>
    """
WHOLE = """
    version: 1
    robot: whole
    modules:
      arm: {file: arm.urdf, prefix: "", set: {joints: {lift: {limits: {upper: 30 deg, effort: 20}}}}}
      hand: {file: hand.robot.yaml, at: arm/upper}
    frames:
      tcp: {link: hand/finger, origin: {xyz: [0, 0, 0], relative_to: hand/finger}}
      eye: {link: arm/upper, origin: {xyz: [0, 0, 0], relative_to: arm/upper}}
    actuators: {lift_motor: {joint: arm/lift, kind: motor}, grip_motor: {joint: hand/grip, kind: motor}}
    sensors: {imu: {type: imu, link: hand/palm}}
    excluded_contacts: [[arm/base, hand/palm], [arm/base, arm/upper]]
    variants:
      bare: {without: [hand]}
      strong: {modules: {hand: {variant: strong}}}
      strong_named: {like: strong, robot: hercules}
      bare_named: {like: strong_named, without: [hand], base: floating}
    """
FILES = {"whole.robot.yaml": WHOLE, "arm.urdf": ARM, "hand.robot.yaml": HAND, "palm.urdf": PALM}


@pytest.fixture
def variant(tmp_path: Path, write: Callable[[Mapping[str, str]], None]) -> Callable[..., Robot]:
    """Composes a variant of the first of some files."""

    def robot(name: str, diagnostics: Diagnostics, files: Mapping[str, str] = FILES) -> Robot:
        write(files)
        options = Options(tmp_path / "out", variant=name)
        return compose(load(tmp_path / next(iter(files)), options, diagnostics), options, diagnostics).robot

    return robot


def effort(robot: Robot, joint: str) -> float:
    """The limit of a joint's effort [N m]."""
    return robot.joint_by_name[joint].limit.effort


@pytest.mark.slow
def test_values_of_a_module_are_changed(variant: Callable[..., Robot]) -> None:
    """``set`` changes what it names in a description, ``variant`` what the module's own variant names."""
    robot = variant("", Diagnostics())
    limit = robot.joint_by_name["lift"].limit
    assert (limit.lower, limit.upper, limit.effort, limit.velocity) == pytest.approx((-1.0, 0.5235987756, 20.0, 2.0))
    assert effort(robot, "hand_grip") == 5.0
    assert effort(variant("strong", Diagnostics()), "hand_grip") == 50.0


IMPOSSIBLE = 'ixx="1" iyy="1" izz="9" ixy="0.5" ixz="0" iyz="0"'


@pytest.mark.slow
@pytest.mark.parametrize(
    ("inertia", "error"),
    [(f"<inertia {IMPOSSIBLE}/>", r"SB509.*link 'base'.*moment"), ("", r"SB861.*link 'base'.*no <inertia>")],
)
def test_an_impossible_inertia_is_replaced(inertia: str, error: str, variant: Callable[..., Robot]) -> None:
    """What ``set`` gives is judged, not what it replaces; an inertia is one value, with its products."""
    arm = ARM.replace('<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>', inertia)
    with pytest.raises(StepbotError, match=error):
        variant("", Diagnostics(), {**FILES, "arm.urdf": arm})
    new = "links: {%s: {inertial: {mass: 1, com: [0, 0, 0], inertia: {ixx: 1, iyy: 2, izz: IZZ}}}}"
    sets = WHOLE.replace("set: {", "set: {" + f"{(new % 'base')[:-1]}, {(new % 'upper').removeprefix('links: {')}, ")
    assert sets.count("IZZ") == 2
    robot = variant("", Diagnostics(), {**FILES, "whole.robot.yaml": sets.replace("IZZ", "2.5"), "arm.urdf": arm})
    expected = ((1.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 2.5))
    assert [robot.link_by_name[name].mass_properties.inertia for name in ("base", "upper")] == [expected] * 2
    with pytest.raises(StepbotError, match="SB509") as raised:
        variant("", Diagnostics(), {**FILES, "whole.robot.yaml": sets.replace("IZZ", "9"), "arm.urdf": arm})
    errors = [one.span for one in raised.value.diagnostics if one.severity == "error"]
    assert {(span.file.rpartition("/")[2], span.line) for span in errors} == {("whole.robot.yaml", 5)}


SWAPPED = """
    version: 1
    robot: whole
    base: fixed
    modules:
      arm: {file: arm.urdf, prefix: ""}
      hand:
        {file: hand.robot.yaml, at: arm/upper, prefix: h_, by: palm, home: {grip: 0.5},
         set: {joints: {grip: {limits: {effort: 7}}}}}
    variants: {other: {modules: {hand: {file: arm.urdf}}}, same: {modules: {hand: {file: hand.robot.yaml}}}}
    """


def test_another_file_begins_anew(variant: Callable[..., Robot]) -> None:
    """A variant that swaps a module keeps its place and prefix, and nothing that names elements of the former file."""
    files = {**FILES, "whole.robot.yaml": SWAPPED}
    robot = variant("other", Diagnostics(), files)
    assert {joint.name: joint.parent for joint in robot.joints} == {
        "lift": "base",
        "hand_mount": "upper",
        "h_lift": "h_base",
    }
    same = variant("same", Diagnostics(), files)
    assert (effort(same, "h_grip"), same.joint_by_name["h_grip"].drawn_position) == (7.0, 0.5)


def test_what_is_attached_to_a_part_that_is_left_out_goes_too(variant: Callable[..., Robot]) -> None:
    """Without the hand there are neither its devices, nor frames on it, nor pairs with it."""
    robot = variant("bare", Diagnostics())
    assert robot.name == "whole_bare"
    assert [link.name for link in robot.links] == ["base", "upper"]
    assert [frame.name for frame in robot.frames] == ["eye"]
    assert [one.name for one in robot.actuators] == ["lift_motor"]
    assert robot.sensors == ()
    assert robot.excluded_contacts == (("base", "upper"),)


def test_a_variant_like_another_is_both_patches(variant: Callable[..., Robot]) -> None:
    """``like`` of ``like`` is the patches one after the other, with the last name."""
    named, bare = variant("strong_named", Diagnostics()), variant("bare_named", Diagnostics())
    assert (named.name, bare.name) == ("hercules", "hercules")
    assert effort(named, "hand_grip") == 50.0
    assert (len(bare.links), bare.base.value) == (2, "floating")


@pytest.mark.slow
def test_a_module_is_a_robot_of_the_library(composed: Callable[..., Robot]) -> None:
    """``library:NAME`` is its sidecar, with either name; an unknown one lists near names; no path is in a message."""
    text = "{version: 1, robot: r, modules: {arm: {file: 'library:arm2'}}}"
    diagnostics = Diagnostics()
    short = composed({"r.robot.yaml": text}, diagnostics)
    long = composed({"r.robot.yaml": text.replace("arm2", "stepbot_arm2")}, Diagnostics())
    assert len(short.links) == 5
    assert (short.links, short.joints) == (long.links, long.joints)
    assert not any("robot_library" in one.span.file for one in diagnostics)
    with pytest.raises(StepbotError, match="no robot 'arm3' in the library"):
        composed({"r.robot.yaml": text.replace("arm2", "arm3")}, diagnostics := Diagnostics())
    assert any("did you mean 'arm2'?" in one.help for one in diagnostics)


@pytest.mark.parametrize("null", ["null", "~"])
def test_null_drops_a_key(null: str, variant: Callable[..., Robot]) -> None:
    """In a variant, and in what is set in a module: its sidecar, or its URDF."""
    lift = WHOLE.replace("{upper: 30 deg, effort: 20}", f"{{velocity: {null}}}")
    grip = f"{{joints: {{grip: {{type: fixed, limits: {null}}}}}}}"
    stiff = f"strong: {{modules: {{hand: {{set: {grip}}}}}, actuators: {null}}}"
    files = {**FILES, "whole.robot.yaml": lift.replace("strong: {modules: {hand: {variant: strong}}}", stiff)}
    robot = variant("strong", diagnostics := Diagnostics(), files)
    assert not [one for one in diagnostics if one.severity == "error"]
    assert (robot.joint_by_name["hand_grip"].kind, robot.actuators) == (JointKind.FIXED, ())
    assert (effort(robot, "lift"), robot.joint_by_name["lift"].limit.velocity) == (10.0, inf)


def test_a_key_that_a_variant_inherits_can_be_dropped(tmp_path: Path) -> None:
    """The remedy of a key that does not suit the variant's type says how; only there is null a value."""
    links = "{a: {rest: true}, b: {parts: [b]}}"
    joint = "{type: revolute, parent: a, child: b, zero: 10 deg, limits: {lower: 0, upper: 1, effort: 1, velocity: 1}}"
    text = f"version: 1\nrobot: r\nstep: r.step\nlinks: {links}\njoints: {{j: {joint}}}\nvariants:\n  v: "
    (path := tmp_path / "r.robot.yaml").write_text(text + "{joints: {j: {type: fixed}}}\n", encoding="utf-8")
    found = json.loads(stepbot("check", path, "--json", cwd=tmp_path).out)["diagnostics"]
    assert {one["code"] for one in found} == {"SB137"}
    assert all(one["help"][-1].endswith("`KEY: null`") for one in found)
    path.write_text(text + "{joints: {j: {type: fixed, zero: null, limits: null}}}\n", encoding="utf-8")
    assert stepbot("check", path, cwd=tmp_path).code == 0
    for faulty in (text + "{joints: {j: {zero: }}}\n", text.replace("10 deg", "null") + "{base: floating}\n"):
        path.write_text(faulty, encoding="utf-8")
        assert "SB110" in stepbot("check", path, cwd=tmp_path).out


FAULTS = {
    ("strong: {modules: {", "strong: {joints: {grab: null}, modules: {"): (
        "SB160 15:21 variant 'strong': no key 'grab' to drop"
    ),
    ("set: {joints: {lift: {", "set: {joints: {lift: {mimic: null, "): "SB160 5:59 set: no key 'mimic' to drop",
    ("strong: {modules: {hand: {variant: strong}}}", "strong: {like: bare_named}"): (
        "SB160 15:18 variant 'strong': like: circular: bare_named -> strong_named -> strong -> bare_named"
    ),
    ("strong: {modules", "strong: {witout: [tcp], modules"): "SB120 15:12 sidecar: unknown key 'witout'",
    ("like: strong,", "like: strung,"): "SB160 16:24 variant 'strong_named': like: no variant 'strung'",
    ("without: [hand], base", "without: [tcp, hnd], base"): (
        "SB160 17:51 variant 'bare_named': without: no element 'hnd'"
    ),
    ("without: [hand], base", "without: hand, base"): (
        "SB160 17:45 variant 'bare_named': without: not a list of names"
    ),
    (
        "hand: {variant: strong}",
        "hand: {variant: string}",
    ): "SB160 15:38 variant: no variant 'string' in 'hand.robot.yaml'",
    ("set: {joints: {lift:", "set: {joints: {lft:"): "SB160 5:52 set: no joint 'lft' in 'arm.urdf'",
    ("set: {joints: {lift: {limits: ", "set: {links: {lift: {limits: "): (
        "SB160 5:58 set: of a link of a description, `set` can change `inertial`, `collision`"
    ),
    ("upper: 30 deg", "upper: 30 furlongs"): "SB124 5:75 joint 'lift': limits.upper: unknown unit 'furlongs'",
    ("hand.robot.yaml, at", "hand.robot.yaml, set: {joints: {grap: {type: disc}}}, at"): (
        "SB160 6:48 set: no joint 'grap' in 'hand.robot.yaml'"
    ),
    ("hand.robot.yaml, at", "hand.robot.yaml, set: {joints: {grip: {limits: {effort: 5 kg}}}}, at"): "SB124 6:",
    ("arm.urdf, prefix", "arm.urdf, variant: long, prefix"): (
        "SB160 5:34 module 'arm': variant: 'arm.urdf' is not a sidecar and has no variants"
    ),
}


@pytest.mark.parametrize(("change", "expected"), FAULTS.items(), ids=range(len(FAULTS)))
def test_faults_have_their_place(change: tuple[str, str], expected: str, variant: Callable[..., Robot]) -> None:
    """Each mistake is one diagnostic at the line where it is written, in the file where it is written."""
    assert change[0] in WHOLE
    diagnostics = Diagnostics()
    with pytest.raises(StepbotError):
        variant(
            "bare_named" if "_named" in expected else "strong",
            diagnostics,
            {**FILES, "whole.robot.yaml": WHOLE.replace(*change)},
        )
    (error,) = [one for one in diagnostics if one.severity == "error"]
    assert error.span.file.endswith("whole.robot.yaml")
    assert f"{error.code} {error.span.line}:{error.span.column} {error.message}".startswith(expected)


@pytest.mark.slow
def test_each_variant_is_a_robot_of_a_batch(tmp_path: Path, write: Callable[[Mapping[str, str]], None]) -> None:
    """`batch` writes a folder for each, once; `uptodate` compares each; `check` names the variant of a fault."""
    write(FILES)
    sidecar, out = str(tmp_path / "whole.robot.yaml"), str(tmp_path / "out")
    for expected in ("converted", "unchanged"):
        options = ("--no-verify", "-f", "urdf", "--no-cache", "--json", "-j", "1")
        result = stepbot("batch", sidecar, "-o", out, *options, cwd=tmp_path)
        robots = json.loads(result.out)["robots"]
        assert {one["name"]: one["status"] for one in robots} == dict.fromkeys(
            ("whole", "whole_bare", "whole_strong", "whole_strong_named", "whole_bare_named"), expected
        )
    assert (tmp_path / "out/whole_strong_named/hercules.urdf").is_file()
    ways = [("uptodate", sidecar, "-o", output, "-f", "urdf", "--no-cache") for output in (out, f"{out}/{{name}}")]
    assert [stepbot(*compared, cwd=tmp_path).code for compared in ways] == [0, 0]
    urdf = tmp_path / "out/whole_bare/whole_bare.urdf"
    urdf.write_bytes(urdf.read_bytes() + b"<!-- -->")
    for compared in ways:
        late = stepbot(*compared, cwd=tmp_path)
        assert late.code == 1
        assert "--variant bare" in late.out
    text = dedent(WHOLE).replace("base: floating", "base: flying")
    (tmp_path / "whole.robot.yaml").write_text(text, encoding="utf-8")
    checked = json.loads(stepbot("check", sidecar, "--json", "--no-cache", cwd=tmp_path).out)
    (error,) = [one for one in checked["diagnostics"] if one["severity"] == "error"]
    assert "variant 'bare_named'" in error["notes"]


@pytest.mark.slow
def test_sidecars_that_differ_in_a_variant_alone_differ(
    tmp_path: Path, write: Callable[[Mapping[str, str]], None]
) -> None:
    """`diff` compares the robot of each variant, too, and lists variants that are new or gone."""
    other = WHOLE.replace("bare: {without: [hand]}", "bare: {without: [hand, eye]}")
    write({**FILES, "same.robot.yaml": WHOLE + "# a word", "new.robot.yaml": other.replace("bare_named", "light")})
    same, new = (
        stepbot("diff", "whole.robot.yaml", f"{name}.robot.yaml", "--json", cwd=tmp_path) for name in ("same", "new")
    )
    assert (same.code, json.loads(same.out)["differences"]) == (0, [])
    assert new.code == 1
    assert [(one["name"], one.get("detail")) for one in json.loads(new.out)["differences"]] == [
        ("variant 'bare_named'", "removed"),
        ("variant 'light'", "added"),
        ("variant 'bare': frame 'eye' is missing", None),
    ]


def test_a_finding_of_several_variants_is_reported_once(
    tmp_path: Path, write: Callable[[Mapping[str, str]], None]
) -> None:
    """With the names of the variants that have it."""
    write({**FILES, "whole.robot.yaml": WHOLE.replace("strong: {modules", "strong: {base: flying, modules")})
    checked = json.loads(stepbot("check", str(tmp_path / "whole.robot.yaml"), "--json", cwd=tmp_path).out)
    (error,) = [one for one in checked["diagnostics"] if one["severity"] == "error"]
    assert "variants 'strong', 'strong_named'" in error["notes"]


@pytest.mark.parametrize(
    "arguments", [("convert", "arm.urdf"), ("inspect", "arm.step"), ("view", "arm.yaml", "--edit")]
)
def test_a_variant_is_one_of_a_sidecar(arguments: tuple[str, ...], tmp_path: Path) -> None:
    """`--variant` of anything else, or with an editor, is a usage error and not ignored."""
    run = stepbot(*arguments, "--variant", "long", cwd=tmp_path)
    assert run.code == 2
    assert "--variant" in run.err


@pytest.mark.slow
def test_a_variant_has_its_own_results_in_the_cache(tmp_path: Path, write: Callable[[Mapping[str, str]], None]) -> None:
    """The second run of a variant gives its own bytes, not those of the sidecar as it is."""
    write(FILES)
    sidecar, cache = str(tmp_path / "whole.robot.yaml"), str(tmp_path / "cache")
    seen = []
    for name, variant in (("a", []), ("b", ["--variant", "bare"]), ("c", []), ("d", ["--variant", "bare"])):
        result = stepbot("convert", sidecar, *variant, "-o", name, "--no-verify", "--cache", cache, cwd=tmp_path)
        assert result.code == 0, result.err
        seen.append({path.name: path.read_bytes() for path in (tmp_path / name).glob("whole*")})
    assert seen[0] == seen[2] != seen[1] == seen[3]
    assert "whole_bare.urdf" in seen[1]


@pytest.mark.slow
def test_variants_are_a_variant_set_of_openusd(tmp_path: Path, write: Callable[[Mapping[str, str]], None]) -> None:
    """Each selection is the stage of that variant's own file; a variant that fails is not in the set."""
    from pxr import Usd

    write({**FILES, "whole.robot.yaml": dedent(WHOLE).replace("base: floating", "base: floating, sensors: {imu: 3}")})
    options = ("-f", "usd", "--no-verify", "--no-cache", "--json", "-j", "1")
    assert stepbot("batch", "whole.robot.yaml", "-o", "out", *options, cwd=tmp_path).code == 1
    stage = Usd.Stage.Open(str(tmp_path / "out/whole.usda"))
    robot = stage.GetDefaultPrim()
    chosen = robot.GetVariantSet("configuration")
    names = {"default": "whole", "bare": "whole_bare", "strong": "whole_strong", "strong_named": "whole_strong_named"}
    assert set(chosen.GetVariantNames()) == set(names)
    assert chosen.GetVariantSelection() == "default"
    for variant, folder in names.items():
        assert chosen.SetVariantSelection(variant)
        (file,) = (one for one in (tmp_path / "out" / folder).glob("*.usda") if ".scene." not in one.name)
        own = Usd.Stage.Open(str(file))
        alone = own.GetDefaultPrim()
        seen, expected = (
            {_below(top, prim): _values(top, prim) for prim in Usd.PrimRange(top)} for top in (robot, alone)
        )
        assert seen == expected
        assert sum("PhysicsArticulationRootAPI" in prim.GetAppliedSchemas() for prim in Usd.PrimRange(robot)) == 1


def test_variants_of_openusd_have_identifiers(tmp_path: Path) -> None:
    """One that has the name of the robot without a variant is not lost, nor one with a point in its name."""
    from pxr import Usd

    files = {"": "a.usda", "default": "b.usda", "1.5 m": "c.usda"}
    for file in files.values():
        stage = Usd.Stage.CreateNew(str(tmp_path / file))
        stage.SetDefaultPrim(stage.DefinePrim("/robot"))
        stage.Save()
    (tmp_path / "arm.usda").write_bytes(configurations("arm-2", files))
    stage = Usd.Stage.Open(str(tmp_path / "arm.usda"))
    robot = stage.GetDefaultPrim()
    chosen = robot.GetVariantSet("configuration")
    assert robot.GetName() == "arm_2"
    assert chosen.GetVariantSelection() == "default"
    assert sorted(chosen.GetVariantNames()) == ["_1_5_m", "default", "default_"]


def _below(top: Any, prim: Any) -> str:
    return str(prim.GetPath()).removeprefix(str(top.GetPath()))


def _values(top: Any, prim: Any) -> tuple[Any, ...]:
    """Its type, attributes and targets, relative to the robot."""
    targets = {
        one.GetName(): [str(path).replace(str(top.GetPath()), "", 1) for path in one.GetTargets()]
        for one in prim.GetRelationships()
    }
    return prim.GetTypeName(), {one.GetName(): one.Get() for one in prim.GetAttributes()}, targets


def test_motors_of_a_composing_file_are_known_where_it_changes_its_modules(variant: Callable[..., Robot]) -> None:
    """In a description and in a sidecar; a module's own motor of the same name goes before."""
    motors = "motors: {Mine: {kind: servo, source: measured, stall_torque: 3 N*m, no_load_speed: 1.5 rad/s}}"
    whole = """
        version: 1
        robot: whole
        motors: mine.yaml
        modules:
          arm: {file: arm.urdf, prefix: "", set: {actuators: {lift_motor: {joint: lift, motor: Mine}}}}
          hand:
            {file: hand.robot.yaml, at: arm/upper, prefix: "",
             set: {actuators: {grip_motor: {joint: grip, motor: Mine}}}}
          other:
            {file: hand.robot.yaml, at: arm/upper, offset: {xyz: [0, 0, 1]}, prefix: o_,
             set: {motors: {Mine: {kind: servo, source: x, stall_torque: 4, no_load_speed: 1}},
                   actuators: {grip_motor: {joint: grip, motor: Mine}}}}
        """
    hand = HAND.replace("    variants:", "    actuators: {grip_motor: {joint: grip, kind: motor}}\n    variants:")
    files = {**FILES, "hand.robot.yaml": hand, "whole.robot.yaml": whole, "mine.yaml": motors}
    robot = variant("", Diagnostics(), files)
    found = {one.name: one.motor and (one.motor.name, one.motor.figure("effort")) for one in robot.actuators}
    efforts = {name: one and (one[0], one[1] and one[1].value) for name, one in found.items()}
    assert efforts == {"lift_motor": ("Mine", 3.0), "grip_motor": ("Mine", 3.0), "o_grip_motor": ("Mine", 4.0)}


DISC = """
    <robot name="disc"><link name="disc"><inertial><mass value="0.5"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><cylinder radius="0.1" length="0.01"/></geometry></collision></link></robot>
    """
FOR_MJX = """
    version: 1
    robot: whole
    defaults: {collision: {for: mjx}}
    modules: {arm: {file: "library:ur5e", prefix: ""}, disc: {file: disc.urdf, prefix: "", at: arm/tool0}}
    """


@pytest.mark.slow
def test_shapes_for_mjx_are_those_of_all_modules(composed: Callable[..., Robot]) -> None:
    """MJX concerns the whole robot: each link of a sidecar has one shape; a description's are reported, and kept."""
    diagnostics = Diagnostics()
    robot = composed({"whole.robot.yaml": FOR_MJX, "disc.urdf": DISC}, diagnostics)
    assert {len(link.collisions) for link in robot.links} == {0, 1}
    shapes = [one.geometry for link in robot.links for one in link.collisions]
    assert sum(isinstance(one, Cylinder) for one in shapes) == 1
    assert len(shapes) == 8
    assert [one.message for one in diagnostics if one.code == "SB608"] == [
        "`for: mjx` has no effect on module 'disc': 'disc.urdf' has shapes for other engines"
    ]
    plain = FOR_MJX.replace("defaults: {collision: {for: mjx}}", "")
    as_drawn = composed({"whole.robot.yaml": plain, "disc.urdf": DISC}, Diagnostics())
    assert any(isinstance(one.geometry, Cylinder) for link in as_drawn.links for one in link.collisions)


BROKEN = {
    "bracket": "variants:\n  b: {x: [1, 2\n",
    "character": "variants: {b: \x01}\n",
    "depth": f"variants: {'[' * 3000}\n",
}


@pytest.mark.parametrize("text", BROKEN.values(), ids=BROKEN)
@pytest.mark.parametrize("command", ["check", "diff"])
def test_names_of_variants_are_read_from_broken_sidecars(command: str, text: str, tmp_path: Path) -> None:
    """What is wrong is reported where the whole is read: an unclosed bracket, a control character, a depth."""
    path = tmp_path / "broken.robot.yaml"
    path.write_text(f"version: 1\nrobot: broken\n{text}", encoding="utf-8")
    run = stepbot(command, path.name, *([path.name] if command == "diff" else []), cwd=tmp_path)
    assert run.code in (1, 2)
    assert "SB901" not in run.out + run.err
    assert "broken.robot.yaml:" in run.out + run.err
