"""Rules for the repository as a whole."""

import ast
import re
import subprocess
import tomllib
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from stepbot.diagnostics.codes import CODES, PAGE, Code, renamed
from stepbot.robot.joint_types import PAIRS

ROOT = Path(__file__).resolve().parents[2]
OURS = ("src", "cli")

# Assembled from parts, so that this file does not match.
FORBIDDEN = {
    "a path of one machine": re.compile(r"(?<![\w.:-])/(?:work|home|root|Users|tmp)/|C:" + r"\\Users"),
    "a registry's host": re.compile("|".join(["py" + "pi[.]", "python" + "hosted", "index" + "-url"])),
    "an unfinished place": re.compile("|".join(["TO" + "DO", "FIX" + "ME", "X" + "XX"])),
}


def project_files() -> list[Path]:
    """Files of the project: tracked, or new and not ignored."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"]
    try:
        names = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True, encoding="utf-8").stdout
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("not a git checkout: the files of the project are not known")
    return [ROOT / name for name in names.split("\0") if name and (ROOT / name).is_file()]


@pytest.mark.slow
def test_no_forbidden_words() -> None:
    """No file contains local paths, registry hosts or unfinished code."""
    found = []
    for file in project_files():
        if file.suffix in {".step", ".png", ".stl", ".obj"}:
            continue
        for number, line in enumerate(file.read_text(encoding="utf-8", errors="replace").splitlines(), start=1):
            found += [
                f"{file.relative_to(ROOT)}:{number}: {what}" for what, word in FORBIDDEN.items() if word.search(line)
            ]
    assert not found


def test_files_and_functions_stay_small() -> None:
    """No module is over 400 lines."""
    sizes = {
        file.relative_to(ROOT): len(file.read_text(encoding="utf-8").splitlines())
        for root in OURS
        for file in (ROOT / root).rglob("*.py")
    }
    assert {file: size for file, size in sizes.items() if size > 400} == {}


@pytest.fixture(scope="module")
def nodes() -> list[tuple[str, ast.AST]]:
    """All nodes of the modules, each with its file."""
    files = [file for root in OURS for file in sorted((ROOT / root).rglob("*.py"))]
    trees = [(str(file.relative_to(ROOT)), ast.parse(file.read_text(encoding="utf-8"))) for file in files]
    return [(file, node) for file, tree in trees for node in ast.walk(tree)]


@pytest.mark.slow
def test_names_state_what_they_hold(nodes: list[tuple[str, ast.AST]]) -> None:
    """No variable is called `found`: a noun states what was found."""
    names = [(file, node.lineno, node.id) for file, node in nodes if isinstance(node, ast.Name)]
    names += [(file, node.lineno, node.arg) for file, node in nodes if isinstance(node, ast.arg)]
    assert [f"{file}:{line}" for file, line, name in names if name == "found"] == []


@pytest.mark.slow
def test_sets_of_joint_types_are_read_from_their_table(nodes: list[tuple[str, ast.AST]]) -> None:
    """Nobody but engines, for words of their own, lists which types turn or slide: the rows of `JointKind` state it."""
    pairs = {kind.value for kind in PAIRS}
    sets = [(file, node) for file, node in nodes if isinstance(node, ast.Tuple | ast.Set | ast.List)]
    listed = [
        f"{file}:{node.lineno}"
        for file, node in sets
        if len(node.elts) > 1 and {one.value for one in node.elts if isinstance(one, ast.Constant)} <= pairs
        if all(isinstance(one, ast.Constant) for one in node.elts) and not file.startswith("src/stepbot/engines/")
    ]
    assert listed == []


@pytest.mark.slow
def test_docstrings_describe_parameters_that_exist(nodes: list[tuple[str, ast.AST]]) -> None:
    """Each name below ``Args:`` is a parameter of the function."""
    described = 0
    for file, node in nodes:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            _, _, arguments = (ast.get_docstring(node) or "").partition("Args:\n")
            section = re.split(r"^\S", arguments, flags=re.MULTILINE)[0]
            stated = set(re.findall(r"^    \*{0,2}(\w+): ", section, re.MULTILINE))
            known = {one.arg for one in ast.walk(node.args) if isinstance(one, ast.arg)}
            assert stated <= known, f"{file}:{node.lineno} {node.name}: {sorted(stated - known)}"
            described += len(stated)
    assert described > 500


def test_heavy_imports_live_in_one_place() -> None:
    """Each heavy package is imported only by the modules that own it, inside functions."""
    owners = {
        "OCP": r"src/stepbot/step/",
        "fcl": r"src/stepbot/(verification/self_collision/|geometry/mesh_distance\.py)",
        "manifold3d": r"src/stepbot/geometry/solids/",
        "gymnasium": r"src/stepbot/(gym/|formats/learning\.py)",  # there in the text of files that it writes
        "mujoco": r"src/stepbot/((engines/mujoco|gym)/|formats/mjcf/learning\.py)",
        "pybullet": r"src/stepbot/(engines/pybullet/|robot/pybullet_closures\.py)",
        "pydantic": r"src/stepbot/sidecar/",
        "ruamel": r"src/stepbot/sidecar/",
        "click": r"cli/stepbot_cli/",
        "lxml": r"src/stepbot/(formats|engines|verification)/",
        "yourdfpy": r"src/stepbot/engines/yourdfpy/observer\.py",
        "trimesh": r"src/stepbot/geometry/(mass_properties|mesh_files)\.py",
    }
    found = [
        (name, package)
        for root in OURS
        for file in (ROOT / root).rglob("*.py")
        for name in [file.relative_to(ROOT).as_posix()]
        for package in re.findall(r"^\s*(?:import|from) (\w+)", file.read_text(encoding="utf-8"), re.MULTILINE)
        if package in owners and not re.match(owners[package], name)
    ]
    assert not found


@pytest.mark.parametrize("code", CODES.values(), ids=lambda code: code.id)
def test_code_is_explained(code: Code) -> None:
    """Every code has a title, an explanation and a fix in whole sentences."""
    assert not code.title.endswith(".")
    for text in (code.explanation, code.fix):
        assert text.strip().endswith((".", "`", "?")), text


def test_codes_are_unique() -> None:
    """Every section of the page is a code, none twice, each in its range; codes of earlier versions are not reused."""
    page = PAGE.read_text(encoding="utf-8")
    defined = re.findall(r"^### (.{5})", page, re.MULTILINE)
    assert defined == sorted(set(defined)) == list(CODES)
    ranges = [one[:3] for one in re.findall(r"^##+ (SB\d)", page, re.MULTILINE)]
    assert ranges == sorted(ranges)
    assert [heading[:3] for heading in re.findall(r"^## (SB\dxx)", page, re.MULTILINE)] == sorted(set(ranges))
    assert not set(renamed()) & set(defined)
    assert all(one in CODES for codes in renamed().values() for one in codes)
    assert len(renamed()) == page.partition("## Codes of earlier versions\n")[2].count("\n| SB")


def test_codes_in_use_exist() -> None:
    """Every code in the source is in the table."""
    used = {
        code
        for root in OURS
        for file in (ROOT / root).rglob("*.py")
        for code in re.findall(r'"(SB\d{3}(?::[a-z-]+)?)"', file.read_text(encoding="utf-8"))
    }
    assert [code for code in sorted(used) if code not in CODES] == []


@pytest.mark.slow
def test_codes_are_used() -> None:
    """Every code of the table is used in the source, with each feature; formats declare those of SB76x."""
    text = "".join(file.read_text(encoding="utf-8") for root in OURS for file in (ROOT / root).rglob("*.py"))
    wanted = [code for code, one in CODES.items() if not one.features or code.startswith("SB76")]
    wanted += [f"{code}:{word}" for code in CODES if code not in wanted for word in CODES[code].features]
    assert [code for code in wanted if f'"{code}"' not in text] == []


def test_pins_satisfy_the_ranges() -> None:
    """The versions installed by CI are within the version ranges of the package."""
    packaging = pytest.importorskip("packaging.requirements")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    wanted = [*project["dependencies"], *extras["dev"]]
    own = [requirement for requirement in map(packaging.Requirement, wanted) if requirement.name == project["name"]]
    wanted += [requirement for one in own for extra in sorted(one.extras) for requirement in extras[extra]]
    lock = (ROOT / "requirements-ci.txt").read_text(encoding="utf-8")
    pins = dict(re.findall(r"^([\w.-]+)==(\S+) --hash=sha256:[0-9a-f]{64}$", lock, re.MULTILINE))
    for requirement in map(packaging.Requirement, wanted):
        if requirement.name == project["name"]:  # its extras are in the list
            continue
        if requirement.marker is not None and not requirement.marker.evaluate({"python_version": "3.11", "extra": ""}):
            continue
        assert requirement.specifier.contains(pins[requirement.name.lower()]), requirement


def test_hooks_find_their_files() -> None:
    """The hooks run for changed sidecars and STEP files; the one for outputs also for those; and for no other file."""
    hooks = YAML(typ="safe", pure=True).load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
    files = {hook["id"]: re.compile(hook["files"]) for hook in hooks}
    assert list(files) == ["stepbot-check", "stepbot-uptodate"]
    for name in ("robot.yaml", "a/robot.yml", "arm.robot.yaml", "a/b/arm.robot.yml", "arm.step", "a/arm.stp"):
        assert all(pattern.search(name) for pattern in files.values()), name
    for name in ("robots.yaml", "myrobot.yaml", "robot.yaml.orig", "arm.robot.json", "step.py"):
        assert not any(pattern.search(name) for pattern in files.values()), name
    for name in ("arm/arm.urdf", "arm/arm.sdf", "arm/arm.xml", "arm/meshes/a.obj", "arm/report.json"):
        assert files["stepbot-uptodate"].search(name), name
        assert not files["stepbot-check"].search(name), name
