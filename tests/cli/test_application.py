"""Exit codes, output streams and error messages, common to all commands."""

import json
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

import stepbot
from stepbot.diagnostics import Diagnostics, Span, StepbotError
from stepbot.runtime import memory
from stepbot_cli import application, main, schema
from stepbot_cli.reading import limit_options, size


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of a command."""
    code = main(arguments)
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def failing_with(error: BaseException) -> click.Command:
    """Make the command raise an exception."""

    @click.command(cls=type(schema.command))
    @click.option("--json", "as_json", is_flag=True)
    def command(as_json: bool) -> int:
        raise error

    return command


def test_help_lists_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    """`--help` lists all commands and the exit codes on standard output."""
    code, out, err = run(capsys, "--help")
    assert (code, err) == (0, "")
    assert all(f"\n  {name} " in out for name in application.COMMANDS)
    assert "Exit codes: 0 clean, 1 findings, 2 could not run" in out


@pytest.mark.parametrize("name", application.COMMANDS)
def test_every_command_has_help(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Every command has a description in its help."""
    code, out, _ = run(capsys, name, "-h")
    assert code == 0
    assert out.startswith(f"Usage: stepbot {name} ")


def commands(group: click.Group, *above: str) -> Iterator[tuple[str, ...]]:
    """All commands, and those below them."""
    context = click.Context(group)
    for name in group.list_commands(context):
        yield (*above, name)
        below = group.get_command(context, name)
        if isinstance(below, click.Group):
            yield from commands(below, *above, name)


@pytest.mark.parametrize("names", [(), *commands(application.application)], ids=" ".join)
def test_every_help_has_an_example(names: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    """The help of every command has an example that calls this command with valid options on one line."""
    code, out, _ = run(capsys, *names, "--help")
    assert code == 0
    (example,) = [line.strip() for line in out.splitlines() if line.strip().startswith("Example: ")]
    words = shlex.split(example.removeprefix("Example: ").partition(" > ")[0])
    assert tuple(words[: 1 + len(names)]) == ("stepbot", *names)
    group: click.Command = application.application
    context = click.Context(group, info_name="stepbot")
    words = words[1:]
    while isinstance(group, click.Group):
        found = group.get_command(context, words.pop(0))
        assert found is not None
        group = found
    group.make_context("example", words)


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_shell_completion(shell: str) -> None:
    """Each shell has the documented completion script; that of bash completes commands."""
    stepbot_script = Path(sys.executable).with_name("stepbot")
    if not stepbot_script.exists():
        pytest.skip("no console script beside the interpreter")
    if shell == "bash" and shutil.which("bash") is None:
        pytest.skip("no bash, whose version click looks at")
    environment = {**os.environ, "_STEPBOT_COMPLETE": f"{shell}_source"}
    script = subprocess.run([stepbot_script], env=environment, capture_output=True, text=True, check=True).stdout
    assert f"_STEPBOT_COMPLETE={shell}_complete" in script
    if shell == "bash":
        environment |= {"_STEPBOT_COMPLETE": "bash_complete", "COMP_WORDS": "stepbot con", "COMP_CWORD": "1"}
        answer = subprocess.run([stepbot_script], env=environment, capture_output=True, text=True, check=True).stdout
        assert answer.split() == ["plain,convert"]
    page = (Path(__file__).parents[2] / "docs" / "commands.md").read_text(encoding="utf-8")
    assert f"_STEPBOT_COMPLETE={shell}_source stepbot" in page


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    """`--version` prints the version of the library."""
    assert run(capsys, "--version") == (0, f"stepbot, version {stepbot.__version__}\n", "")


@pytest.mark.parametrize(
    "arguments", [[], ["nope"], ["convert"], ["convert", "a.yaml", "--nope"], ["explain", "SB000"]]
)
def test_wrong_usage_is_exit_code_2(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """Invalid arguments end in exit code 2."""
    code, out, err = run(capsys, *arguments)
    assert (code, out) == (2, "")
    assert "Usage: stepbot" in err


@pytest.mark.parametrize(
    "arguments", [["{}"], ["explain", "{}"], ["convert", "a.yaml", "-f", "{}"], ["inspect", "--{}"]]
)
def test_usage_errors_do_not_steer_the_terminal(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """Escape sequences in arguments, and in the names suggested for them, are printed as text."""
    code, out, err = run(capsys, *(argument.format("arm\x1b]0;title\x07\u202e") for argument in arguments))
    assert (code, out) == (2, "")
    assert "arm\\x1b]0;title\\x07\\u202e" in err.replace("\\\\", "\\")
    assert all(c.isprintable() or c == "\n" for c in err)


def test_arguments_default_to_those_of_the_process() -> None:
    """`main` without arguments reads those of the process, whose handlers of signals it sets."""
    code = "import sys; from stepbot_cli import main; sys.exit(main())"
    run = subprocess.run([sys.executable, "-c", code, "--version"], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")
    assert "stepbot, version" in run.stdout


@pytest.mark.parametrize(("arguments", "code"), [(["--version"], 0), (["explain", "SB000"], 2)])
def test_installed_command_ends_at_once(arguments: list[str], code: int) -> None:
    """The installed command writes its output and cleans up; an object that remains is not deleted."""
    lines = (
        "import atexit, sys; from stepbot_cli import command",
        "class Kept: __del__ = lambda self: print('freed')",
        "kept = Kept(); atexit.register(print, 'cleaned up', end=''); command()",
    )
    run = subprocess.run(
        [sys.executable, "-c", "\n".join(lines), *arguments], capture_output=True, text=True, check=False
    )
    assert run.returncode == code
    assert run.stdout.endswith("cleaned up")
    assert ("version" in run.stdout, "Usage: stepbot" in run.stderr) == (code == 0, code == 2)


def test_installed_command_waits_for_threads() -> None:
    """A thread that is not a daemon ends before the process does."""
    code = (
        "import threading, time; from stepbot_cli import command;"
        "threading.Thread(target=lambda: (time.sleep(0.2), print('done'))).start(); command()"
    )
    run = subprocess.run([sys.executable, "-c", code, "--version"], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout.splitlines()[-1]) == (0, "done")


def test_unforeseen_exception_is_sb901(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """An unexpected exception is reported as SB901 with its traceback and exit code 2."""
    monkeypatch.setattr(schema, "command", failing_with(ZeroDivisionError("division by zero")))
    code, out, err = run(capsys, "schema")
    assert (code, out) == (2, "")
    assert "Traceback (most recent call last)" in err
    assert "stepbot: error[SB901]: internal error: ZeroDivisionError: division by zero" in err
    assert "please report a bug" in err


def test_unforeseen_exception_is_json_where_json_was_asked_for(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Standard output is one JSON document, even after an exception."""
    monkeypatch.setattr(schema, "command", failing_with(ZeroDivisionError("division by zero")))
    code, out, err = run(capsys, "schema", "--json")
    document = json.loads(out)
    assert (code, document["exit_code"]) == (2, 2)
    assert [d["code"] for d in document["diagnostics"]] == ["SB901"]
    assert "Traceback" in err


def test_missing_package_is_named(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """A missing package is reported by name with the command that installs it, without a traceback."""
    monkeypatch.setattr(
        schema, "command", failing_with(ModuleNotFoundError("No module named 'lxml.etree'", name="lxml.etree"))
    )
    code, _, err = run(capsys, "schema")
    assert code == 2
    assert "error[SB003]: Python package missing: no module named 'lxml'" in err
    assert "pip install lxml" in err
    assert "Traceback" not in err


def test_findings_that_escape_are_shown_as_findings(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Diagnostics raised as an exception are reported as findings."""
    diagnostics = Diagnostics()
    diagnostics.add("SB004", "disk full", Span("out"))
    monkeypatch.setattr(schema, "command", failing_with(StepbotError(diagnostics)))
    code, _, err = run(capsys, "schema")
    assert code == 2
    assert "out: error[SB004]: disk full" in err
    assert "Traceback" not in err


def test_interrupt_is_exit_code_130(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C ends in exit code 130 without output."""
    monkeypatch.setattr(schema, "command", failing_with(KeyboardInterrupt()))
    code, out, err = run(capsys, "schema")
    assert (code, out) == (130, "")
    assert err.strip() == "interrupted"


def test_explain_prints_the_table_of_codes(capsys: pytest.CaptureFixture[str]) -> None:
    """`explain` lists all codes; with a code, in upper or lower case, it prints the text of that code."""
    code, out, _ = run(capsys, "explain")
    assert code == 0
    assert "SB901  error    internal error" in out
    assert run(capsys, "explain", "sb901") == run(capsys, "explain", "SB901")
    assert "How to fix it:" in run(capsys, "explain", "SB901")[1]


def test_explain_offers_near_codes(capsys: pytest.CaptureFixture[str]) -> None:
    """`explain` suggests similar codes for an unknown one."""
    code, _, err = run(capsys, "explain", "SB90")
    assert code == 2
    assert "SB901" in err


@pytest.mark.parametrize(
    ("text", "number"),
    [("4G", 4 * 2**30), ("500 MB", 500 * 2**20), ("1.5k", 1536), ("1GiB", 2**30), ("123", 123), ("2T", 2**41)],
)
def test_sizes(text: str, number: int) -> None:
    """Memory sizes are accepted with and without units."""
    assert size(text) == number


@pytest.mark.parametrize("text", ["", "G", "4X", "-1G", "1e9"])
def test_no_sizes(text: str) -> None:
    """Invalid memory sizes are rejected."""
    with pytest.raises(click.BadParameter, match="not a size"):
        size(text)


@pytest.mark.parametrize(
    ("arguments", "limit"),
    [([], 12 << 30), (["--memory-limit", "500M"], 500 << 20), (["--memory-limit", "none"], None)],
)
def test_memory_that_a_worker_may_take(
    arguments: list[str], limit: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The default memory limit is three quarters of the available memory; it can be set or switched off."""
    monkeypatch.setattr(memory, "memory_size", lambda: 16 << 30)
    taken: list[int | None] = []

    @click.command()
    @limit_options
    def command(timeout: float, memory_limit: int | None) -> None:
        taken.append(memory_limit)

    command.main(arguments, standalone_mode=False)
    assert taken == [limit]
    with pytest.raises(click.BadParameter, match="less than 1M"):
        command.main(["--memory-limit", "0.2"], standalone_mode=False)
