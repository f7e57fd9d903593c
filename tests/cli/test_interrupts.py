"""Ctrl-C."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from importlib.machinery import ExtensionFileLoader
from pathlib import Path
from types import ModuleType

import pytest

from stepbot_cli.limits import interruptible
from tests.command_line import COMMAND, LONGEST, environment


def press_ctrl_c() -> None:
    """Send SIGINT, as a terminal does."""
    signal.raise_signal(signal.SIGINT)


def test_interrupt_ends_the_block() -> None:
    """The block ends at Ctrl-C, and the former handler is restored."""
    before = signal.getsignal(signal.SIGINT)
    reached = []

    def interrupted() -> None:
        with interruptible():
            press_ctrl_c()
            reached.append("still running")

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert reached == []
    assert signal.getsignal(signal.SIGINT) is before


def test_swallowed_interrupt_is_not_lost() -> None:
    """An interrupt swallowed by a library is raised at the end of the block."""
    reached = []

    def swallowed() -> None:
        with interruptible():
            with contextlib.suppress(BaseException):
                press_ctrl_c()
            reached.append("still running")

    with pytest.raises(KeyboardInterrupt):
        swallowed()
    assert reached == ["still running"]


def test_swallowed_request_to_end_comes_again_at_the_next_occasion() -> None:
    """A swallowed SIGTERM is raised at the next check, with the exit code of the signal."""
    before = signal.getsignal(signal.SIGTERM)
    reached = []

    def swallowed() -> None:
        with interruptible() as end_if_interrupted:
            end_if_interrupted()
            with contextlib.suppress(BaseException):
                signal.raise_signal(signal.SIGTERM)
            reached.append("still running")
            end_if_interrupted()
            reached.append("still running")

    with pytest.raises(SystemExit) as ended:
        swallowed()
    assert ended.value.code == 128 + signal.SIGTERM
    assert reached == ["still running"]
    assert signal.getsignal(signal.SIGTERM) is before


def test_nothing_pressed_nothing_raised() -> None:
    """Without Ctrl-C the block has no effect, and other threads can use it."""
    with interruptible():
        pass
    done = []

    def elsewhere() -> None:
        with interruptible():
            done.append(os.getpid())

    thread = threading.Thread(target=elsewhere)
    thread.start()
    thread.join()
    assert done


class NativeModule(ExtensionFileLoader):
    """Loads a module whose initialization receives a signal and calls Python code."""

    def __init__(self, reached: list[str]) -> None:
        super().__init__("native", "native.so")
        self.reached = reached

    def exec_module(self, module: ModuleType) -> None:  # noqa: ARG002 - the signature of loaders
        """Receive SIGTERM, and go on for longer than the timer of the handler."""
        signal.raise_signal(signal.SIGTERM)
        time.sleep(0.05)
        self.reached.append("initialized")


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="the system has no timers")
def test_native_module_is_initialized_before_the_block_ends() -> None:
    """Native code need not survive exceptions in its initialization: manifold3d aborted the process."""
    before = signal.getsignal(signal.SIGALRM)
    reached: list[str] = []

    def ended() -> None:
        with interruptible():
            NativeModule(reached).exec_module(ModuleType("native"))
            time.sleep(60.0)
            reached.append("still running")

    with pytest.raises(SystemExit) as found:
        ended()
    assert found.value.code == 128 + signal.SIGTERM
    assert reached == ["initialized"]
    assert signal.getsignal(signal.SIGALRM) is before


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="the system ends processes without a signal")
def test_a_page_that_is_ended_leaves_no_files(tmp_path: Path) -> None:
    """`view` serves its page until a service manager ends it."""
    (tmp_path / "block.urdf").write_text(
        '<robot name="block"><link name="base"><visual><geometry><box size="1 1 1"/></geometry></visual></link></robot>'
    )
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    command = [*COMMAND, "view", "--no-open", "block.urdf"]
    place = environment({"TMPDIR": str(temporary), "PYTHONUNBUFFERED": "1"})
    with subprocess.Popen(command, cwd=tmp_path, env=place, stdout=subprocess.PIPE, text=True) as running:
        assert running.stdout is not None
        printed = running.stdout.readline()
        assert "127.0.0.1" in printed
        running.terminate()
        assert running.wait(LONGEST) == 128 + signal.SIGTERM
    assert not list(temporary.iterdir())


_WHILE_IMPORTING = """
import signal, sys
class Finder:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            signal.raise_signal(signal.SIGINT)
sys.meta_path.insert(0, Finder())
import stepbot_cli
"""


@pytest.mark.parametrize("module", ["stepbot.runtime.import_path", "click", "stepbot_cli.application"])
def test_interrupt_while_modules_are_imported_prints_nothing(module: str) -> None:
    """Python's own handler prints a traceback of whatever is imported."""
    command = [sys.executable, "-c", _WHILE_IMPORTING.format(module=module)]
    run = subprocess.run(command, capture_output=True, check=False)
    assert (run.returncode, run.stdout, run.stderr) == (130, b"", b"")
