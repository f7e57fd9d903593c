"""Findings for GitHub, GitLab and SARIF, and what is prepared for their pipelines."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest
from ruamel.yaml import YAML

from stepbot.diagnostics import Diagnostic, Span
from stepbot_cli.machine_output import github, gitlab, sarif
from tests.command_line import stepbot

ROOT = Path(__file__).resolve().parents[2]
WRONG = "version: 1\nrobot: a\nstep: a.step\nlinks: {base: {}}\njoins: {}\n"
FOUND = (
    Diagnostic("SB525", "error", "expect: 100 % off", Span("a b/arm.robot.yaml", 7, 3, 9), ("state, or: it",), ("so",)),
    Diagnostic("SB526", "warning", "expect: not", Span("arm.robot.yaml")),
    Diagnostic("SB526", "warning", "expect: not", Span("arm.robot.yaml", 2)),
)


def test_github_commands_are_escaped() -> None:
    """Each finding is one line, with place and title, and line breaks and commas as GitHub reads them."""
    first, second, third = github(FOUND).split("\n")
    assert first == (
        "::error file=a b/arm.robot.yaml,title=SB525 not as expected,line=7,col=3,endColumn=9::"
        "expect: 100 %25 off%0Anote: so%0Ahelp: state, or: it"
    )
    assert second.startswith("::warning file=arm.robot.yaml,title=SB526 not symmetric::")
    assert ",line=2::" in third
    assert github([]) == ""


def test_gitlab_report_has_what_its_schema_requires() -> None:
    """Path, line, severity and a fingerprint of its own for each finding; none is an empty list."""
    issues = json.loads(gitlab(FOUND))
    assert [(one["check_name"], one["severity"], one["location"]["lines"]["begin"]) for one in issues] == [
        ("SB525", "major", 7),
        ("SB526", "minor", 1),
        ("SB526", "minor", 2),
    ]
    assert len({one["fingerprint"] for one in issues}) == 3
    assert json.loads(gitlab([])) == []


def test_sarif_log_has_rules_and_places() -> None:
    """Each result names a rule of the tool; URIs are those of RFC 3986; a whole file has no region."""
    run = json.loads(sarif(FOUND))["runs"][0]
    rules = [rule["id"] for rule in run["tool"]["driver"]["rules"]]
    assert rules == ["SB525", "SB526"]
    places = [result["locations"][0]["physicalLocation"] for result in run["results"]]
    assert places[0] == {
        "artifactLocation": {"uri": "a%20b/arm.robot.yaml"},
        "region": {"startLine": 7, "startColumn": 3, "endColumn": 9},
    }
    assert "region" not in places[1]
    odd = Diagnostic("SB526", "warning", "expect: not", Span("rö/100%20#2?.yaml", 1))
    (result,) = json.loads(sarif([odd]))["runs"][0]["results"]
    uri = result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
    assert uri == "r%C3%B6/100%2520%232%3F.yaml"
    assert unquote(urlsplit(uri).path) == odd.span.file
    assert json.loads(sarif([]))["runs"][0]["results"] == []


@pytest.mark.parametrize("diagnostics", [FOUND, ()])
def test_sarif_log_is_valid_by_the_published_schema(diagnostics: tuple[Diagnostic, ...]) -> None:
    """The classes that `pydantic-sarif` generates of SARIF's schema accept it, and reject another level."""
    model = pytest.importorskip("pydantic_sarif.model")
    schema, text = model.StaticAnalysisResultsFormatSarifVersion210JsonSchema, sarif(diagnostics)
    schema.model_validate_json(text)
    if diagnostics:
        with pytest.raises(ValueError, match="'none', 'note', 'warning' or 'error'"):
            schema.model_validate_json(text.replace('"level": "warning"', '"level": "info"'))


@pytest.mark.parametrize(("format_", "begin"), [("github", "::error "), ("gitlab", "["), ("sarif", "{"), ("json", "{")])
def test_commands_print_nothing_else(tmp_path: Path, format_: str, begin: str) -> None:
    """Standard output is the document alone; the exit code is that of the findings."""
    (tmp_path / "a.robot.yaml").write_text(WRONG, encoding="utf-8")
    run = stepbot("check", "a.robot.yaml", "--output-format", format_, cwd=tmp_path)
    assert run.code == 1
    assert run.out.startswith(begin)
    assert "a.robot.yaml" in run.out
    assert run.err == ""
    if format_ != "github":
        json.loads(run.out)
    again = stepbot("convert", "a.robot.yaml", "--output-format", format_, cwd=tmp_path)
    assert again.code == 1
    assert again.out.startswith(begin)


def test_json_and_another_format_contradict(tmp_path: Path) -> None:
    """Two documents cannot be one output."""
    (tmp_path / "a.robot.yaml").write_text(WRONG, encoding="utf-8")
    assert stepbot("check", "a.robot.yaml", "--json", "--output-format", "sarif", cwd=tmp_path).code == 2


URDF = '<robot name="a"><link name="base"><inertial><mass value="{}"/>{}</inertial></link></robot>'
INERTIA = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'


@pytest.mark.slow
def test_differences_as_markdown_and_annotations(tmp_path: Path) -> None:
    """The table has the old and the new mass; annotations are about the new file."""
    for name, mass in (("old", 1), ("new", 2)):
        (tmp_path / f"{name}.urdf").write_text(URDF.format(mass, INERTIA), encoding="utf-8")
    run = stepbot("diff", "old.urdf", "new.urdf", "--markdown", cwd=tmp_path)
    assert run.code == 1
    heading, _, columns, *rows = run.out.strip().split("\n")
    assert re.fullmatch(r"\*\*\d+ differences?\*\* between `old.urdf` and `new.urdf`", heading)
    assert columns == "| difference | what | old | new | how |"
    assert any("| 1 kg | 2 kg |" in row for row in rows)
    assert all(row.count("|") == 6 for row in rows)
    annotated = stepbot("diff", "old.urdf", "new.urdf", "--output-format", "github", cwd=tmp_path)
    assert annotated.code == 1
    assert all(line.startswith("::warning file=new.urdf,title=SB8") for line in annotated.out.strip().split("\n"))
    assert stepbot("diff", "old.urdf", "old.urdf", "--markdown", cwd=tmp_path).out.startswith("**No differences**")


@pytest.mark.parametrize("file", ["action.yml", ".ci/templates/gitlab.yml"])
def test_pipelines_use_commands_and_options_that_exist(file: str) -> None:
    """Both files are YAML, and each command of stepbot in them has the options that they use."""
    text = (ROOT / file).read_text(encoding="utf-8")
    document: Any = YAML(typ="safe").load(text)
    assert document
    commands = re.findall(
        r"^(?:.*\s)?stepbot (check|batch|diff|render|datasheet) (.*?)(?: [<>|]|;| \|\||$)", text, re.MULTILINE
    )
    assert {name for name, _ in commands} == {"check", "batch", "diff", "render", "datasheet"}
    for name, arguments in commands:
        helped = stepbot(name, "--help", cwd=ROOT).out
        for option in re.findall(r"(?:^|\s)(--?[a-z][a-z-]*)", arguments):
            assert option in helped, (name, option)


def _steps(system: str, base: str, folder: Path) -> tuple[list[str], dict[str, str]]:
    """The scripts of a pipeline but for the installation, and the variables that its program gives to them."""
    yaml = YAML(typ="safe")
    if system == "gitlab":
        document: Any = yaml.load((ROOT / ".ci/templates/gitlab.yml").read_text(encoding="utf-8"))
        _, *lines = document["stepbot"]["script"]
        given = {"ROBOTS": ".", "CI_MERGE_REQUEST_DIFF_BASE_SHA": base, "CI_PROJECT_DIR": str(folder)}
        given |= {"CI_JOB_URL": "https://x/1", "STEPBOT_TOKEN": "t", "CI_API_V4_URL": "https://x/api/v4"}
        return ["\n".join(lines)], given | {"CI_MERGE_REQUEST_PROJECT_ID": "5", "CI_MERGE_REQUEST_IID": "7"}
    document = yaml.load((ROOT / "action.yml").read_text(encoding="utf-8"))
    temporary = str(folder.parent / "runner")
    given = {"inputs.folder": ".", "inputs.output": "build/robots", "inputs.token": "t", "github.event.number": "7"}
    given |= {"github.event.pull_request.base.sha": base, "runner.temp": temporary, "github.server_url": "https://x"}
    given |= {"github.repository": "a/b", "github.run_id": "1"}
    _, *steps = [step for step in document["runs"]["steps"] if "run" in step]
    scripts, variables = [], {"RUNNER_TEMP": temporary, "GITHUB_STEP_SUMMARY": f"{temporary}/summary.md"}
    for step in steps:
        values = {
            key: re.sub(r"\$\{\{ (.*?) \}\}", lambda one: given[one[1]], value) for key, value in step["env"].items()
        }
        scripts.append("".join(f"export {key}='{value}'\n" for key, value in values.items()) + step["run"])
    return scripts, variables


@pytest.mark.long
@pytest.mark.parametrize(("system", "poster"), [("github", "gh"), ("gitlab", "curl")])
def test_pipelines_comment_what_changed(system: str, poster: str, tmp_path: Path, robot_library: Path) -> None:
    """Their scripts run in a repository: the comment has masses and new robots, not equal ones; pictures are kept."""
    folder = tmp_path / "robots"
    for place in ("changed", "equal", "new"):
        (folder / place).mkdir(parents=True)
        text = (robot_library / "stepbot_four_bar" / "four_bar.robot.yaml").read_text(encoding="utf-8")
        (folder / place / f"{place}.robot.yaml").write_text(text, encoding="utf-8")
        step = (robot_library / "stepbot_four_bar" / "four_bar.step").read_bytes()
        (folder / place / "four_bar.step").write_bytes(step)
    programs, log = tmp_path / "programs", tmp_path / "posted.md"
    programs.mkdir()
    take = 'for one; do case "$one" in *.short) cat "$one";; body@*) cat "${one#body@}";; esac; done'
    (programs / poster).write_text(f"#!/bin/sh\n{take} > {log}\n")
    (programs / poster).chmod(0o755)
    path = os.pathsep.join((str(programs), str(Path(sys.executable).parent), os.environ["PATH"]))
    identity = {f"GIT_{who}_{what}": "a@b" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    environment = {**os.environ, **identity, "PATH": path}

    def run(script: str) -> str:
        command = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", script]
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout.strip()

    run("git init -q && git add changed equal && git commit -qm base")
    base = run("git rev-parse HEAD")
    sidecar = folder / "changed" / "changed.robot.yaml"
    sidecar.write_text(sidecar.read_text(encoding="utf-8").replace("2700 kg", "2900 kg"), encoding="utf-8")
    run("git add . && git commit -qm change")
    scripts, variables = _steps(system, base, folder)
    environment |= variables
    (tmp_path / "runner").mkdir()
    for script in scripts:
        run(script)
    first = log.read_text(encoding="utf-8")
    run(f"rm -rf build .base ../runner gl-code-quality-report.json {log} && mkdir ../runner")
    for script in scripts:  # a runner of one's own keeps .git, and with it what git knows of the removed worktree
        run(script)
    posted = log.read_text(encoding="utf-8")
    assert posted == first
    assert "between `base/changed/changed.robot.yaml` and `changed/changed.robot.yaml`" in posted
    assert "| mass | mass of link 'crank' | 0.0363955 kg | 0.0390914 kg |" in posted
    assert "| ground | 2.989 |" in posted
    assert "New: `new/new.robot.yaml`" in posted
    assert "equal" not in posted
    pictures = {one.name for one in folder.glob("build/**/*.png") if one.stat().st_size > 1000}
    assert pictures >= {"changed.before.png", "changed.after.png"}
