"""``stepbot lock``, and what `check`, `check --fix` and `convert` report after a change of the CAD."""

import json
import os
import re
import shlex
import shutil
import stat
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from robot_library.moments import pose
from tests.revisions import LEVER, Revision, lock, write_lever, write_locked_lever
from tests.solids import box

from .conftest import Stepbot

SCHEMA = Path(__file__).parents[2] / "schemas" / "lock-1.schema.json"
OTHERS = ("SB505", "SB512", "SB513")
"""Findings about the lever that do not depend on a revision."""


@pytest.fixture(scope="module")
def locked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with ``lever.step``, its sidecar, its lock, and a cache with the STEP."""
    folder = tmp_path_factory.mktemp("lever")
    write_locked_lever(folder)
    return folder


@pytest.fixture
def lever(locked: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Revision:
    """The current folder, with ``lever.step``, its sidecar and its lock; a revision to edit."""
    for name in ("lever.step", "lever.robot.yaml", "lever.lock.json"):
        shutil.copy(locked / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("STEPBOT_CACHE", str(locked / "cache"))
    return Revision(Path("lever.step"))


def findings(stepbot: Stepbot, *arguments: str) -> list[tuple[str, str]]:
    """Code and message of all findings about the revision."""
    run = stepbot("check", "--step", "--json", "lever.robot.yaml", *arguments)
    found = [(one["code"], one["message"]) for one in json.loads(run.out)["diagnostics"]]
    return [one for one in found if one[0] not in OTHERS]


def rewrite(**replaced: str) -> None:
    """Rewrite the sidecar with some texts replaced, and its lock for the current STEP."""
    text = LEVER
    for old, new in replaced.items():
        assert old in text
        text = text.replace(old, new)
    Path("lever.robot.yaml").write_text(text, encoding="utf-8")
    lock(Path("lever.robot.yaml"))


@pytest.mark.slow
def test_lock_is_valid_and_deterministic(lever: Revision, stepbot: Stepbot) -> None:
    """`lock` writes a valid file with every component and joint; the bytes are deterministic."""
    before = Path("lever.lock.json").read_bytes()
    run = stepbot("lock", "lever.robot.yaml", "--no-cache")
    assert (run.code, run.err) == (0, "")
    assert run.out == "lever.lock.json: 7 components, 1 joint of lever.step\n"
    assert Path("lever.lock.json").read_bytes() == before
    document = json.loads(before)
    jsonschema.validate(document, json.loads(SCHEMA.read_text(encoding="utf-8")))
    parts = {part["path"]: part for part in document["parts"]}
    assert parts["arm/motor"]["mass"] == pytest.approx(0.02 * 0.03 * 0.02 * 4000.0, rel=1e-9)
    assert document["shapes"][parts["arm/motor"]["shape"]]["measure"] == pytest.approx(1.2e-5, rel=1e-9)
    assert parts["base/M3#1"]["shape"] == parts["base/M3#4"]["shape"]
    assert document["joints"][0]["axis"] == [0.0, 0.0, 1.0]


def test_nothing_changes_without_a_lock(lever: Revision, stepbot: Stepbot) -> None:
    """Without a lock, a renamed part is an unknown component."""
    lever.rename({"motor": "XL430", "motor:1": "XL430:1"}).write(Path("lever.step"))
    Path("lever.lock.json").unlink()
    assert {code for code, _ in findings(stepbot)} == {"SB301", "SB304"}


@pytest.mark.slow
def test_export_anew_changes_nothing(lever: Revision, stepbot: Stepbot) -> None:
    """Another export of the same assembly, with other entity numbers and order of faces, has no findings."""
    lever.write(Path("lever.step"))
    with Path("lever.step").open("ab") as file:
        file.write(b"\n")  # the kernel may write the same bytes again
    assert findings(stepbot) == []


SENTENCES: dict[str, tuple[Any, list[tuple[str, str]]]] = {
    "rename": (
        lambda lever: lever.rename({"motor": "XL430", "motor:1": "XL430:1"}),
        [("SB310", "link 'arm': component 'arm/motor' was renamed to 'arm/XL430' (same shape, same pose)")],
    ),
    "move": (
        lambda lever: lever.move("motor:1", pose((0, 3.0, 4.0))),
        [("SB318:pose", "link 'arm': component 'arm/motor' moved by 5 mm")],
    ),
    "add": (
        lambda lever: lever.copy("plate:1", "cover:1", pose((0, 0, 100.0))),
        [("SB316:gained", "link 'base': new component 'base/cover:1' is in the link")],
    ),
    "delete": (
        lambda lever: lever.remove("motor:1"),
        [("SB312", "link 'arm': component 'arm/motor' is no longer in lever.step")],
    ),
    "reshape": (
        lambda lever: lever.reshape("motor", box(20, 30, 21).shape),
        [("SB318:shape", "link 'arm': component 'arm/motor' changed shape: volume 12 -> 12.6 cm^3 (+5 %), "
          "mass 48 -> 50.4 g (+5 %)")],
    ),
    "remove one of four equal screws": (
        lambda lever: lever.remove_number("M3", 2),
        [("SB316:lost", "link 'base': component 'base/M3#2' is no longer in lever.step")],
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", SENTENCES)
def test_one_change_is_one_sentence(name: str, lever: Revision, stepbot: Stepbot) -> None:
    """Each kind of change causes exactly one finding, with the expected code."""
    change, expected = SENTENCES[name]
    change(lever).write(Path("lever.step"))
    found = findings(stepbot)
    assert [one for one in found if one[0] != "SB314"] == expected


def test_whole_assembly_moved(lever: Revision, stepbot: Stepbot) -> None:
    """An assembly moved as a whole is one finding; its parts and axes have none."""
    write_lever(Path("lever.step"), shift=7.0)
    assert findings(stepbot) == [("SB318:pose", "step: the whole assembly moved by 7 mm")]


def test_three_changes_at_once(lever: Revision, stepbot: Stepbot) -> None:
    """A renamed, a moved and a removed part are three findings, and the moved axis is one."""
    lever.rename({"motor": "XL430", "motor:1": "XL430:1"}).remove_number("M3", 4)
    lever.move("plate:1", pose((5.0, 0, 0))).move("beam:1", pose((5.0, 0, 0))).write(Path("lever.step"))
    assert findings(stepbot) == [
        ("SB310", "link 'arm': component 'arm/motor' was renamed to 'arm/XL430' (same shape, same pose)"),
        ("SB316:lost", "link 'base': component 'base/M3#4' is no longer in lever.step"),
        ("SB318:pose", "link 'base': component 'base/plate' moved by 5 mm"),
        ("SB318:pose", "link 'arm': component 'arm/beam' moved by 5 mm"),
        ("SB318:axis", "joint 'hinge': axis moved by 5 mm"),
    ]


def test_removed_reshaped_and_added(lever: Revision, stepbot: Stepbot) -> None:
    """A removed part of a path, a changed shape and an added part are each reported."""
    lever.remove("motor:1").copy("plate:1", "cover:1", pose((0, 0, 100.0)))
    lever.reshape("M3", box(3, 3, 10).at(0, 0, 5).shape).write(Path("lever.step"))
    codes = [(code, message.partition(" changed")[0]) for code, message in findings(stepbot)]
    assert codes == [
        ("SB312", "link 'arm': component 'arm/motor' is no longer in lever.step"),
        ("SB316:gained", "link 'base': new component 'base/cover:1' is in the link"),
        ("SB318:shape", "link 'base': 4 components"),
    ]


@pytest.mark.slow
def test_findings_stand_at_the_line_that_binds(lever: Revision, stepbot: Stepbot) -> None:
    """A moved part is reported at the path that binds it."""
    lever.move("motor:1", pose((0, 5.0, 0))).write(Path("lever.step"))
    run = stepbot("check", "--step", "--concise", "lever.robot.yaml")
    assert "lever.robot.yaml:7:23: warning[SB318:pose]" in run.out
    assert run.code == 0
    assert stepbot("check", "--step", "--strict", "lever.robot.yaml").code == 1


@pytest.mark.slow
def test_changes_can_be_ignored_before_they_come(lever: Revision, stepbot: Stepbot) -> None:
    """A sidecar that ignores moved parts has no findings before or after one moves, and none about an unused rule."""
    rewrite(**{"base: fixed": "base: fixed\nignore_findings: [SB318:pose]"})
    assert findings(stepbot) == []
    lever.move("motor:1", pose((0, 5.0, 0))).write(Path("lever.step"))
    assert findings(stepbot) == []


@pytest.mark.slow
def test_convert_reports_the_same(lever: Revision, stepbot: Stepbot) -> None:
    """`convert` compares with the lock: a moved part is a warning; with a renamed part nothing is written."""
    arguments = ("convert", "--no-verify", "--concise", str(Path("lever.robot.yaml").resolve()), "-o", "out")
    assert "SB31" not in stepbot(*arguments).err
    lever.move("motor:1", pose((0, 5.0, 0))).write(Path("lever.step"))
    run = stepbot(*arguments)
    assert run.code == 0
    assert "warning[SB318:pose]: link 'arm': component 'arm/motor' moved by 5 mm" in run.err
    report = Path("out/report.json").read_text(encoding="utf-8")
    assert "stepbot lock lever.robot.yaml" in report
    assert str(Path.cwd()) not in report
    before = Path("out/lever.urdf").read_bytes()
    lever.rename({"motor": "XL430", "motor:1": "XL430:1"}).write(Path("lever.step"))
    run = stepbot(*arguments)
    assert run.code == 1
    assert "error[SB311]" in run.err
    assert Path("out/lever.urdf").read_bytes() == before


@pytest.mark.slow
def test_a_new_lock_counts_at_once(lever: Revision, stepbot: Stepbot) -> None:
    """A new lock invalidates cached results."""
    lever.move("motor:1", pose((0, 5.0, 0))).write(Path("lever.step"))
    cache = ("--cache", "kept")
    assert [code for code, _ in findings(stepbot, *cache)] == ["SB318:pose"]
    assert [code for code, _ in findings(stepbot, *cache)] == ["SB318:pose"]
    assert stepbot("lock", "lever.robot.yaml", *cache).code == 0
    assert findings(stepbot, *cache) == []


def test_robot_with_errors_is_not_locked(lever: Revision, stepbot: Stepbot) -> None:
    """`lock` of a sidecar with errors fails and keeps the former lock."""
    before = Path("lever.lock.json").read_bytes()
    Path("lever.robot.yaml").write_text(LEVER.replace("motor]", "moter]"), encoding="utf-8")
    run = stepbot("lock", "lever.robot.yaml")
    assert run.code == 1
    assert "SB301" in run.err
    assert Path("lever.lock.json").read_bytes() == before


CART = """
version: 1
robot: cart
base: fixed
modules:
  left: {file: work/lever.robot.yaml}
  right: {file: work/lever.robot.yaml, at: left/base, offset: {xyz: [1, 0, 0]}}
  post: {file: post.urdf, at: left/base, offset: {xyz: [2, 0, 0]}}
"""
POST = """<robot name="post"><link name="post"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


@pytest.mark.slow
def test_modules_are_locked_beside_their_sidecars(lever: Revision, stepbot: Stepbot) -> None:
    """`lock` of a robot of modules locks each sidecar once, at any depth; `check --step` of the whole compares it."""
    Path("work").mkdir()
    for name in ("lever.step", "lever.robot.yaml"):
        Path(name).rename(f"work/{name}")
    Path("cart.robot.yaml").write_text(CART, encoding="utf-8")
    Path("post.urdf").write_text(POST, encoding="utf-8")
    cell = "version: 1\nrobot: cell\nmodules: {cart: {file: cart.robot.yaml, at: world}, me: {file: cell.robot.yaml}}\n"
    Path("cell.robot.yaml").write_text(cell, encoding="utf-8")
    line = "work/lever.lock.json: 7 components, 1 joint of lever.step\n"
    for target in ("cart.robot.yaml", "cell.robot.yaml", "."):
        run = stepbot("lock", target)
        assert (run.code, run.err, run.out) == (0, "", line)
    assert Path("work/lever.lock.json").read_bytes() == Path("lever.lock.json").read_bytes()
    assert not [*Path().glob("c*.lock.json")]
    lever.move("motor:1", pose((0, 5.0, 0))).write(Path("work/lever.step"))
    run = stepbot("check", "--step", "--json", "cart.robot.yaml")
    assert "SB318:pose" in [one["code"] for one in json.loads(run.out)["diagnostics"]]


def test_errors_of_modules_are_reported_by_lock(lever: Revision, stepbot: Stepbot) -> None:
    """A module with errors is not locked; others are. Without a sidecar to lock, `lock` states so."""
    Path("bad.robot.yaml").write_text(LEVER.replace("motor]", "moter]"), encoding="utf-8")
    modules = "modules: {a: {file: bad.robot.yaml}, b: {file: lever.robot.yaml, at: a/base}}"
    Path("pair.robot.yaml").write_text(f"version: 1\nrobot: pair\n{modules}\n", encoding="utf-8")
    run = stepbot("lock", "pair.robot.yaml")
    assert run.code == 1
    assert "bad.robot.yaml" in run.err
    assert "SB301" in run.err
    assert run.out.startswith("1 lock file written: 2 errors\nlever.lock.json: ")
    assert not Path("bad.lock.json").exists()
    Path("post.urdf").write_text(POST, encoding="utf-8")
    text = "version: 1\nrobot: r\nmodules: {a: {file: post.urdf}, b: {file: 'library:2f85', at: a/post}}\n"
    Path("r.robot.yaml").write_text(text, encoding="utf-8")
    run = stepbot("lock", "r.robot.yaml")
    assert (run.code, run.err) == (0, "")
    assert run.out.startswith("nothing to lock")


@pytest.mark.slow
def test_modules_without_a_step(lever: Revision, stepbot: Stepbot) -> None:
    """`check` states that modules are not read; SB150 of `inspect` lists commands that work for them and the whole."""
    hung = "b: {file: post.urdf, at: a/base}, c: {file: 'library:arm2', at: a/base}"
    modules = f"modules: {{a: {{file: lever.robot.yaml}}, {hung}}}"
    Path("post.urdf").write_text(POST, encoding="utf-8")
    Path("r.robot.yaml").write_text(f"version: 1\nrobot: r\nbase: fixed\n{modules}\n", encoding="utf-8")
    run = stepbot("inspect", "r.robot.yaml")
    assert run.code == 1
    assert "r.robot.yaml:4:1: error[SB150]" in run.err
    assert stepbot("check", "r.robot.yaml").out == "ok: modules not read (--step)\n"
    commands = re.findall("`stepbot (.*?)`", run.err)
    assert commands == ["library export arm2", "inspect lever.robot.yaml", "check --step r.robot.yaml"]
    for command in commands:
        assert stepbot(*shlex.split(command)).code == 0, command


def test_lock_in_json(lever: Revision, stepbot: Stepbot) -> None:
    """`lock --json` has files, counts and exit code."""
    run = stepbot("lock", "--json", "lever.robot.yaml")
    document = json.loads(run.out)
    assert document["files"] == [{"lock": "lever.lock.json", "components": 7, "joints": 1}]
    assert document["exit_code"] == run.code == 0


@pytest.mark.slow
def test_fix_rewrites_names_alone(lever: Revision, stepbot: Stepbot) -> None:
    """`--fix` replaces every occurrence of a path and keeps comments, layout, line ends and byte order mark."""
    text = LEVER.replace("motor]}", "  'motor' ]}   # drives it, motor").replace("\n", "\r\n")
    text += 'parts:\r\n  motor:   {mass: 50 g}\r\nframes: {tip: {link: arm, origin: {center: "arm/motor"}}}\r\n'
    Path("lever.robot.yaml").write_bytes(b"\xef\xbb\xbf" + text.encode())
    lock(Path("lever.robot.yaml"))
    Path("lever.robot.yaml").chmod(0o640)
    lever.rename({"motor": "XL 430", "motor:1": "XL 430:1"}).write(Path("lever.step"))
    run = stepbot("check", "--fix", "lever.robot.yaml")
    assert run.code == 0
    expected = text.replace("'motor'", "'XL 430'").replace("  motor: ", "  XL 430: ").replace("arm/motor", "arm/XL 430")
    assert Path("lever.robot.yaml").read_bytes() == b"\xef\xbb\xbf" + expected.encode()
    assert stat.S_IMODE(Path("lever.robot.yaml").stat().st_mode) == 0o640
    assert "-  arm: {parts: [beam,   'motor' ]}   # drives it, motor" in run.out
    assert "+  arm: {parts: [beam,   'XL 430' ]}   # drives it, motor" in run.out
    assert findings(stepbot) == []


def test_the_remedy_of_a_renamed_part_runs_as_printed(lever: Revision, stepbot: Stepbot) -> None:
    """The command names the revised STEP and the sidecar with their folders, and repairs the sidecar."""
    Path("new files").mkdir()
    lever.rename({"motor": "XL430", "motor:1": "XL430:1"}).write(Path("new files/lever.step"))
    sidecar = str(Path("lever.robot.yaml").resolve())
    run = stepbot("check", "--step", "new files/lever.step", sidecar)
    assert (run.code, "SB310" in run.out) == (1, True)
    printed = re.search(r"= help: `stepbot (.*)` replaces the path", run.out)
    assert printed is not None
    assert stepbot(*shlex.split(printed[1])).code == 0
    assert "XL430" in Path("lever.robot.yaml").read_text(encoding="utf-8")


def test_fix_leaves_probable_renamings_alone(lever: Revision, stepbot: Stepbot) -> None:
    """A part that was renamed and moved is not certain, so `--fix` writes nothing."""
    lever.rename({"motor": "XL430", "motor:1": "XL430:1"}).move("XL430:1", pose((0, 5.0, 0)))
    lever.write(Path("lever.step"))
    before = Path("lever.robot.yaml").read_bytes()
    run = stepbot("check", "--fix", "--json", "lever.robot.yaml")
    document = json.loads(run.out)
    assert (run.code, document["fixed"]) == (1, [])
    assert Path("lever.robot.yaml").read_bytes() == before


@pytest.mark.slow
def test_fix_follows_shifted_numbers(lever: Revision, stepbot: Stepbot) -> None:
    """After the first of four nameless screws is removed, paths with #n follow the remaining screws."""
    rewrite(**{"[base]": "[plate, 'M3#1', 'M3#2', 'M3#3']", "motor]": 'motor, "M3#4"]'})
    lever.remove_number("M3", 1).write(Path("lever.step"))
    run = stepbot("check", "--fix", "--json", "lever.robot.yaml")
    document = json.loads(run.out)
    assert document["fixed"][0]["paths"] == {"M3#2": "M3#1", "M3#3": "M3#2", "M3#4": "M3#3"}
    text = Path("lever.robot.yaml").read_text(encoding="utf-8")
    assert "[plate, 'M3#1', 'M3#1', 'M3#2']" in text
    assert '[beam, motor, "M3#3"]' in text


@pytest.mark.slow
@pytest.mark.parametrize(("glob", "becomes"), [("**/mot*", "arm/XL430"), ("**/M*", None)])
def test_fix_rewrites_only_globs_of_one(glob: str, becomes: str | None, lever: Revision, stepbot: Stepbot) -> None:
    """A glob that matched only the renamed part is replaced by its path; one with several matches is kept."""
    names = {"motor": "XL430", "motor:1": "XL430:1"}
    if becomes is None:
        rewrite(**{"[base]": f'[plate, "{glob}"]'})
        names = {"M3": "bolt"}
    else:
        rewrite(**{"motor]": f'"{glob}"]'})
    before = Path("lever.robot.yaml").read_text(encoding="utf-8")
    lever.rename(names).write(Path("lever.step"))
    run = stepbot("check", "--fix", "lever.robot.yaml")
    after = Path("lever.robot.yaml").read_text(encoding="utf-8")
    if becomes is None:
        assert after == before
        assert "SB310" in run.out
    else:
        assert after == before.replace(glob, becomes)
        assert run.code == 0


@pytest.mark.slow
def test_a_glob_that_matched_several_names_all_of_them(lever: Revision, stepbot: Stepbot) -> None:
    """In a list the remedy is a list; a key of `parts` cannot be one, so that each component gets a rule."""
    rewrite(**{"[base]": '[plate, "**/M*"]', "links:": 'parts:\n  "**/M3": {density: 7800}\nlinks:'})
    lever.rename({"M3": "bolt"}).write(Path("lever.step"))
    found = json.loads(stepbot("check", "--step", "--json", "lever.robot.yaml").out)["diagnostics"]
    of_globs = {one["message"].split(": ")[0]: one["help"] for one in found if one["code"] == "SB310"}
    bolts = ", ".join(f'"base/bolt#{n}"' for n in range(1, 5))
    assert f"write {bolts}" in of_globs["link 'base'"]
    assert f"write a rule for each of {bolts}" in of_globs["parts rule '**/M3'"]


def test_fix_follows_a_link(lever: Revision, stepbot: Stepbot) -> None:
    """A symbolic link to a sidecar remains a link; its target is rewritten."""
    if not hasattr(os, "symlink"):
        pytest.skip("no symbolic links here")
    Path("real").mkdir()
    Path("lever.robot.yaml").rename("real/sidecar.yaml")
    Path("lever.robot.yaml").symlink_to("real/sidecar.yaml")
    lever.rename({"motor": "XL430", "motor:1": "XL430:1"}).write(Path("lever.step"))
    assert stepbot("check", "--fix", "lever.robot.yaml").code == 0
    assert Path("lever.robot.yaml").is_symlink()
    assert "XL430" in Path("real/sidecar.yaml").read_text(encoding="utf-8")


@pytest.mark.parametrize("named", [("/",), ("..",), (".",), (), ("below/../..",), ("all.txt",)])
def test_a_home_is_not_locked(
    named: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stepbot: Stepbot
) -> None:
    """A folder that has more than a project below it is refused before it is searched."""
    home = tmp_path / "home"
    (home / "below").mkdir(parents=True)
    monkeypatch.chdir(home)
    monkeypatch.setenv("HOME", str(home))
    Path("all.txt").write_text("more.txt\n", encoding="utf-8")
    Path("more.txt").write_text("all.txt\n/\n", encoding="utf-8")
    monkeypatch.setattr("stepbot.jobs.discovery.find_sidecars", lambda *_: pytest.fail("searched the folder"))
    run = stepbot("lock", *named)
    assert run.code == 2
    assert "name their folder, or the sidecars" in run.err


@pytest.mark.usefixtures("lever")
def test_a_project_in_a_home_is_locked(monkeypatch: pytest.MonkeyPatch, stepbot: Stepbot) -> None:
    """The folder of robots, wherever it is."""
    written = Path("lever.lock.json")
    monkeypatch.setenv("HOME", str(written.resolve().parents[1]))
    written.unlink()
    assert stepbot("lock").code == 0
    assert written.exists()
