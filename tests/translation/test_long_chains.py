"""Descriptions with many links: what is not needed is not computed."""

from pathlib import Path

import pytest

from stepbot.robot import dynamics
from tests.command_line import stepbot

_INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def chain(links: int) -> str:
    """A URDF of links in a row."""
    bodies = "".join(f'<link name="l{number}">{_INERTIAL}</link>' for number in range(links))
    joints = "".join(
        f'<joint name="j{n}" type="continuous"><parent link="l{n}"/><child link="l{n + 1}"/><axis xyz="0 1 0"/></joint>'
        for n in range(links - 1)
    )
    return f'<robot name="chain">{bodies}{joints}</robot>'


@pytest.mark.parametrize("command", [("convert", "-o", "out", "--no-verify"), ("check",)])
def test_no_equations_of_motion_without_a_proof(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: tuple[str, ...]
) -> None:
    """The joint table needs poses alone: the mass matrix, cubic in the number of links, is not computed."""

    def fail(*_: object, **__: object) -> None:
        raise AssertionError("equations of motion")

    (tmp_path / "chain.urdf").write_text(chain(30), encoding="utf-8")
    for place in ("stepbot.robot.dynamics.equations_at", "stepbot.engines.reference.equations_at"):
        monkeypatch.setattr(place, fail)
    assert dynamics.equations_at is fail
    name, *options = command
    run = stepbot(name, "chain.urdf", *options, "--no-cache", cwd=tmp_path)
    assert run.code == 0, run.err
