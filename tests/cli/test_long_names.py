"""Names that are longer than file systems allow, in every place that names a file: a coded error, no exception."""

from pathlib import Path

import pytest

from .conftest import Stepbot

NAME, PATH = "n" * 300, "m/" * 3000 + "a"
SIDECAR = "version: 1\nrobot: long\nstep: {}\nlinks:\n  body: {{rest: true}}\ndefaults: {{density: 1000}}\n"
MESH = "<robot name='r'><link name='a'><visual><geometry><mesh filename='{}.stl'/></geometry></visual></link></robot>"
COMMANDS = {
    "step": (("check", "long.robot.yaml", "--step"), ("SB001", "SB126")),
    "--step": (("convert", "robot.yaml", "--no-verify", "--step", "{}.step"), ("SB001",)),
    "-o": (("convert", "robot.urdf", "--no-verify", "-o", "{}"), ("SB004",)),
    "mesh, converted": (("convert", "long.urdf", "--strict", "--no-verify", "-o", "out"), ("SB861",)),
    "mesh, verified": (("verify", "long.urdf"), ("SB861",)),
    "diff": (("diff", "{}.urdf", "robot.urdf"), ("SB001",)),
    "init": (("init", "{}.step"), ("SB001",)),
    "init -o": (("init", "robot.step", "-o", "{}.robot.yaml"), ("SB001", "SB004")),
    "verify": (("verify", "{}.urdf"), ("SB001",)),
    "--junit": (("verify", "robot.urdf", "--junit", "{}.xml"), ("SB004",)),
}


@pytest.mark.parametrize("long", [NAME, PATH], ids=["name", "path"])
@pytest.mark.parametrize("place", COMMANDS)
def test_a_name_that_is_too_long_is_a_coded_error(
    place: str, long: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stepbot: Stepbot
) -> None:
    """Exit code 1 or 2 with the code, and nothing is written."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "long.robot.yaml").write_text(SIDECAR.format(f"{long}.step"))
    (tmp_path / "robot.yaml").write_text(SIDECAR.format("robot.step"))
    (tmp_path / "long.urdf").write_text(MESH.format(long))
    (tmp_path / "robot.urdf").write_text("<robot name='r'><link name='a'/></robot>")
    before = sorted(tmp_path.iterdir())
    command, codes = COMMANDS[place]
    run = stepbot(*(word.format(long) for word in command))
    assert run.code in (1, 2), run.err
    text = run.out + run.err
    assert any(code in text for code in codes), text[-500:]
    assert "SB901" not in text
    assert sorted(tmp_path.iterdir()) == before
