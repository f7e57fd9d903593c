"""Standard streams that are closed, as those of daemons, or that lead to a full disk."""

import subprocess
from pathlib import Path

import pytest

from tests.command_line import COMMAND, environment

pytestmark = pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here")
COMMANDS = {"formats": 0, "formats --json": 0, "check nowhere.yaml": 2, "check nowhere.yaml --json": 2, "--help": 0}


def run(words: str, redirection: str, folder: Path) -> subprocess.CompletedProcess[bytes]:
    """Run a command with a redirection of the shell."""
    line = f'"$@" {words} {redirection}'
    command = ["/bin/sh", "-c", line, "sh", *COMMAND]
    return subprocess.run(command, cwd=folder, env=environment(), capture_output=True, check=False)


@pytest.mark.slow
@pytest.mark.parametrize("redirection", [">&-", "2>&-", "<&- >&- 2>&-", "2>/dev/full"])
@pytest.mark.parametrize(
    "words", [pytest.param(words, marks=pytest.mark.long if "-" in words else ()) for words in COMMANDS]
)
def test_closed_streams(tmp_path: Path, words: str, redirection: str) -> None:
    """A command whose output nobody reads does its work, and ends with its own exit code."""
    result = run(words, redirection, tmp_path)
    assert result.returncode == COMMANDS[words]
    assert b"Traceback" not in result.stdout + result.stderr
    assert b"SB901" not in result.stdout + result.stderr


@pytest.mark.slow
@pytest.mark.parametrize("words", [words for words, code in COMMANDS.items() if code == 0])
def test_results_that_cannot_be_printed(tmp_path: Path, words: str) -> None:
    """Results that nobody got are an error, with the system's reason."""
    result = run(words, ">/dev/full", tmp_path)
    assert (result.returncode, result.stdout) == (2, b"")
    assert result.stderr.startswith(
        b"stepbot: error[SB004]: cannot write to standard output: No space left on device\n"
    )
    assert run(words, ">/dev/full 2>/dev/full", tmp_path).returncode == 2


@pytest.mark.slow
def test_files_do_not_take_the_place_of_closed_streams(tmp_path: Path, arm: Path) -> None:
    """With all streams closed, files are those of any other conversion: nothing is printed into them."""
    words = f"convert {arm / 'arm2.robot.yaml'} --no-verify -o"
    assert run(f"{words} closed", "<&- >&- 2>&-", tmp_path).returncode == 0
    assert run(f"{words} open", "", tmp_path).returncode == 0
    names = sorted(path.relative_to(tmp_path / "open") for path in (tmp_path / "open").rglob("*") if path.is_file())
    assert len(names) > 5
    for name in names:
        assert (tmp_path / "closed" / name).read_bytes() == (tmp_path / "open" / name).read_bytes()
