"""Sources that could read or write what they must not: the rules of `verify` hold for conversions, too."""

import os
from pathlib import Path

import pytest

from stepbot.jobs.incremental import convert
from stepbot.pipeline.conversion import Options

BARE = "<link name='base'/>"
CASES = {
    "entity": (
        "SB820",
        "robot.urdf",
        f"<!DOCTYPE robot [<!ENTITY x SYSTEM 'file:///etc/passwd'>]><robot name='r'>{BARE}&x;</robot>",
    ),
    "include from above": (
        "SB820",
        "robot.xml",
        "<mujoco><include file='../secret.xml'/><worldbody><body/></worldbody></mujoco>",
    ),
    "pipe": (
        "SB820",
        "robot.sdf",
        "<sdf version='1.9'><model name='r'><link name='a'><visual name='v'><geometry><mesh><uri>pipe.obj</uri></mesh>"
        "</geometry></visual></link></model></sdf>",
    ),
    "broken XML": ("SB814", "robot.urdf", "<robot name='r'>"),
}


@pytest.mark.parametrize("case", CASES)
def test_dangerous_sources_are_refused(case: str, tmp_path: Path) -> None:
    """Entities, includes from above, pipes and broken XML end in a diagnostic; nothing is written."""
    code, name, text = CASES[case]
    source = tmp_path / "in" / name
    source.parent.mkdir()
    source.write_text(text, encoding="utf-8")
    (tmp_path / "secret.xml").write_text("<mujocoinclude/>", encoding="utf-8")
    os.mkfifo(source.parent / "pipe.obj")
    conversion = convert(source, Options(tmp_path / "out", timeout=20.0, verify=False))
    assert [one.code for one in conversion.diagnostics if one.severity == "error"] == [code]
    assert not (tmp_path / "out").exists()


def test_names_of_a_source_are_no_paths(tmp_path: Path) -> None:
    """A robot and a mesh named like paths elsewhere are written into the output folder."""
    source = tmp_path / "in" / "robot.urdf"
    source.parent.mkdir()
    mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    (source.parent / "..part.obj").write_text(mesh, encoding="utf-8")
    visual = "<visual name='../../v'><geometry><mesh filename='..part.obj'/></geometry></visual>"
    source.write_text(f"<robot name='../../evil'><link name='world'>{visual}</link></robot>", encoding="utf-8")
    conversion = convert(source, Options(tmp_path / "out", formats=("urdf", "mjcf"), verify=False))
    assert conversion.diagnostics.exit_code == 0
    assert sorted(conversion.files) == [
        "_.._evil.scene.xml",
        "_.._evil.urdf",
        "_.._evil.xml",
        "meshes/part.obj",
        "report.json",
    ]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["in", "out"]
