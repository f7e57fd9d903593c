"""Gravity in files: its acceleration, and links that it does not act on."""

from collections.abc import Callable
from pathlib import Path

import pytest

from stepbot.engines.observation import EngineRefused, Request
from tests.mutation.siblings import Siblings
from tests.robots import ROBOTS
from tests.simulators.conftest import look, skip_without, write

pytestmark = pytest.mark.mujoco

Changed = Callable[..., str]

LINK = '<link name="upper_arm">'
IN_WORLD = (("<model ", '<world name="w"><gravity>{}</gravity><model '), ("</model>", "</model></world>"))


@pytest.fixture(scope="module")
def siblings(tmp_path_factory: pytest.TempPathFactory) -> Siblings:
    """The two-link arm in three formats."""
    skip_without("mujoco")
    return Siblings(write(ROBOTS["two_link_arm"](), tmp_path_factory.mktemp("arm")))


def changed(siblings: Siblings, written_in: str, *changes: tuple[str, str]) -> Path:
    """A copy of a file in its folder, with some text replaced."""
    path = siblings.files[written_in]
    text = path.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    beside = path.with_name(f"changed_{path.name}")
    beside.write_text(text, encoding="utf-8")
    return beside


def option(text: str) -> tuple[str, str]:
    """A replacement that adds an option to the MJCF."""
    return "<worldbody>", f"<option {text}</option><worldbody>"


def world(gravity: str) -> tuple[tuple[str, str], ...]:
    """A replacement that puts the model into a world with some gravity."""
    return tuple((old, new.format(gravity)) for old, new in IN_WORLD)


WEIGHTLESS = {
    "urdf": ("</robot>", '<gazebo reference="upper_arm"><turnGravityOff>true</turnGravityOff></gazebo></robot>'),
    "sdf": (LINK, f"{LINK}<gravity>false</gravity>"),
    "mjcf": ('<body name="upper_arm"', '<body name="upper_arm" gravcomp="1"'),
}


@pytest.mark.parametrize(
    ("written_in", "changes", "where"),
    [
        pytest.param("mjcf", [option('gravity="0 0 0">')], "acceleration of gravity (0, 0, 0) here", id="none"),
        pytest.param("mjcf", [option('gravity="0 0 -9.9081">')], "(0, 0, -9.9081) here", id="more"),
        pytest.param("mjcf", [option('gravity="0 0 9.81">')], "(0, 0, 9.81) here", id="upwards"),
        pytest.param("mjcf", [option('gravity="0.1 0 -9.81">')], "(0.1, 0, -9.81) here", id="tilted"),
        pytest.param("mjcf", [option('><flag gravity="disable"/>')], "(0, 0, 0) here", id="disabled"),
        pytest.param("sdf", world("0 0 -1.62"), "(0, 0, -1.62) here", id="moon"),
        pytest.param("mjcf", [WEIGHTLESS["mjcf"]], "gravity compensation of link 'upper_arm': 1 ", id="gravcomp"),
        pytest.param(
            "mjcf",
            [('<body name="upper_arm"', '<body name="upper_arm" gravcomp="0.01"')],
            "gravity compensation of link 'upper_arm': 0.01 of its weight off",
            id="a-hundredth",
        ),
        pytest.param("sdf", [WEIGHTLESS["sdf"]], "gravity compensation of link 'upper_arm': 1 ", id="link"),
        pytest.param("urdf", [WEIGHTLESS["urdf"]], "gravity compensation of link 'upper_arm': 1 ", id="gazebo"),
    ],
)
def test_other_gravity_in_one_file_is_noticed(
    written_in: str, changes: list[tuple[str, str]], where: str, siblings: Siblings
) -> None:
    """`verify` reports another gravity in one of three files; gravity forces are compared at standard gravity."""
    assert siblings.by_verify({}) == ""
    path = changed(siblings, written_in, *changes)
    reported = siblings.by_verify({written_in: path})
    assert reported.startswith("SB803")
    assert ": gravity: " in reported
    assert where in reported
    assert ": gravity: " in siblings.by_conversion(written_in, path)


def test_files_that_agree_on_gravity_pass(siblings: Siblings) -> None:
    """Files with one link without gravity, and with Earth's gravity to usual precision, pass."""
    weightless = {name: changed(siblings, name, change) for name, change in WEIGHTLESS.items()}
    assert siblings.by_verify(weightless) == ""
    assert siblings.by_verify({"sdf": changed(siblings, "sdf", *world("0 0 -9.8"))}) == ""
    assert siblings.by_verify({"mjcf": changed(siblings, "mjcf", option('gravity="0 0 -9.80665">'))}) == ""


def test_gravity_that_two_files_give_is_compared(siblings: Siblings) -> None:
    """The gravity of two files is compared to 1e-9, even if either could be Earth's; the URDF has none."""
    both = {
        "sdf": changed(siblings, "sdf", *world("0 0 -9.8")),
        "mjcf": changed(siblings, "mjcf", option('gravity="0 0 -9.8">')),
    }
    assert siblings.by_verify(both) == ""
    both["mjcf"] = changed(siblings, "mjcf", option('gravity="0 0 -9.79">'))
    reported = siblings.by_verify(both)
    assert "acceleration of gravity (0, 0, -9.79) instead of (0, 0, -9.8)" in reported


@pytest.mark.parametrize(
    ("engine", "written_in", "changes", "message"),
    [
        ("reader", "sdf", [(LINK, f"{LINK}<gravity>maybe</gravity>")], "<gravity> is 'maybe', true or false expected"),
        ("reader", "sdf", world("-9.8"), "<gravity> has 1 numbers, 3 expected"),
    ],
)
def test_malformed_gravity_is_rejected(
    engine: str, written_in: str, changes: list[tuple[str, str]], message: str, siblings: Siblings
) -> None:
    """A value that is not a boolean, or not three numbers, is rejected."""
    path = changed(siblings, written_in, *changes)
    with pytest.raises(EngineRefused, match=message):
        look(engine, Request(str(path), written_in))
