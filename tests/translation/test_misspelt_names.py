"""Misspelt elements and attributes: each is reported at its place, with the name that was meant."""

from pathlib import Path

import pytest

from stepbot.jobs.incremental import convert
from stepbot.pipeline.conversion import Options

_MASS = "<mass>1</mass><inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia>"
WRONG = {
    "element of URDF": (
        "urdf",
        '<robot name="r"><link name="a"><visual>\n<orgin xyz="1 0 0"/><geometry><sphere radius="1"/></geometry>'
        "</visual></link></robot>",
    ),
    "attribute of URDF": (
        "urdf",
        '<robot name="r"><material name="m">\n<color rgb="1 0 0"/></material><link name="a"/></robot>',
    ),
    "element of SDFormat": (
        "sdf",
        f'<sdf version="1.9"><model name="r"><link name="a"><inertial>{_MASS}</inertial>\n<poze>1 0 0 0 0 0</poze>'
        "</link></model></sdf>",
    ),
    "element of MJCF": ("xml", '<mujoco><worldbody><body name="a">\n<goem size=".1"/></body></worldbody></mujoco>'),
    "attribute of MJCF": (
        "xml",
        '<mujoco><worldbody><body name="a">\n<geom size=".1" rgb="1"/></body></worldbody></mujoco>',
    ),
}
MEANT = {"orgin": "origin", "rgb": "rgba", "poze": "pose", "goem": "geom"}


@pytest.mark.parametrize("case", WRONG)
def test_misspelt_names(case: str, tmp_path: Path) -> None:
    """The line, and the known name that is nearest."""
    suffix, text = WRONG[case]
    (tmp_path / f"robot.{suffix}").write_text(text, encoding="utf-8")
    conversion = convert(tmp_path / f"robot.{suffix}", Options(tmp_path / "out", verify=False, base="fixed"))
    wrong, meant = next((wrong, meant) for wrong, meant in MEANT.items() if wrong in text)
    (found,) = [one for one in conversion.diagnostics if f"did you mean '{meant}'?" in (*one.help, *one.notes)]
    assert found.span is not None
    assert found.span.line == 2
    assert wrong in " ".join((found.message, *found.notes))


def test_names_that_the_format_has_are_not_misspelt(tmp_path: Path) -> None:
    """Names that are known and not converted: no other name is suggested for them."""
    text = (
        '<robot name="r"><link name="a"/><gazebo reference="a"><mu1>1</mu1><mu2>0.5</mu2><kp>1</kp></gazebo></robot>',
        '<mujoco><worldbody><body name="a"><geom size=".1" gap="1"/></body></worldbody></mujoco>',
    )
    for suffix, content in zip(("urdf", "xml"), text, strict=True):
        (tmp_path / f"robot.{suffix}").write_text(content, encoding="utf-8")
        conversion = convert(tmp_path / f"robot.{suffix}", Options(tmp_path / "out", verify=False, base="fixed"))
        lost = [one for one in conversion.diagnostics if one.code == "SB860"]
        assert lost
        assert not [one for one in lost if one.help]
