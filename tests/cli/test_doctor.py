"""``stepbot doctor``: what works on a machine, and how to fix what does not."""

import json
import resource
from pathlib import Path

import pytest

from stepbot.engines import engines
from stepbot.jobs import health
from stepbot.runtime.cache import Cache
from stepbot.runtime.worker import Worker
from tests.command_line import stepbot

pytestmark = pytest.mark.xdist_group("doctor")


@pytest.mark.slow
def test_all_engines_and_their_commands_are_listed(tmp_path: Path) -> None:
    """Each engine is there or has the command that installs it; the kernel and MuJoCo work where the tests run."""
    run = stepbot("doctor", "--json", "--cache", tmp_path / "cache", cwd=tmp_path)
    document = json.loads(run.out)
    items = {item["name"]: item for item in document["items"]}
    assert (run.code, document["exit_code"], document["problems"]) == (0, 0, 0), document
    assert {engine.title or engine.name for engine in engines()} <= set(items)
    assert items["MuJoCo"]["state"] == items["geometry kernel"]["state"] == "ok"
    assert items["MuJoCo"]["purpose"] == "proves URDF, MJCF"
    for item in items.values():
        assert item["state"] == "ok" or item["fix"]
    text = stepbot("doctor", "--cache", tmp_path / "cache", cwd=tmp_path)
    assert text.out.rstrip().endswith("no problems")
    for item in items.values():
        assert item["state"] == "ok" or item["fix"] in text.out


def test_a_module_that_does_not_load_is_named(tmp_path: Path) -> None:
    """What cannot be imported says why; a missing library leads to its package."""
    with Worker(f"{health.__name__}:{health.imported.__name__}") as worker:
        assert worker.submit("no_such_module").result(60.0).startswith("ModuleNotFoundError: No module named")
    item = health.Item("engine", "Drake", health.OK, "1", "proves URDF", "pip install drake")
    text = "ImportError: libGL.so.1: cannot open shared object file: No such file or directory"
    broken = health._broken(item, text)
    assert (broken.state, broken.fix) == (health.PROBLEM, "apt-get install libgl1")
    assert health._broken(item, "ImportError: no").fix == "pip install drake"
    assert not list(tmp_path.iterdir())


def test_limits_that_are_too_low_have_a_remedy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Few open files, little memory, a full disk and a cache that cannot be written are problems."""
    monkeypatch.setattr(resource, "getrlimit", lambda _: (64, 64))
    monkeypatch.setattr(health, "memory_size", lambda: 1 << 30)
    monkeypatch.setattr(health, "_LEAST_DISK", 1 << 60)
    monkeypatch.setattr(health.os, "access", lambda *_: False)
    found = {item.name: item for item in health._of_machine(Cache(tmp_path / "cache"))}
    assert {item.state for item in found.values()} == {health.PROBLEM}
    assert found["open files"].fix == "ulimit -n 4096"
    assert all(item.fix for item in found.values())
