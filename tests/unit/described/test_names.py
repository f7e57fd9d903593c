"""Names of descriptions that formats cannot hold."""

import pytest

from stepbot.described.finding import Finding
from stepbot.described.robot import valid_file_name, valid_name, with_valid_names
from stepbot.robot.model import Joint, JointKind, Link, Mimic, Robot


@pytest.mark.parametrize(
    ("name", "valid"),
    [
        ("upper arm", "upper arm"),
        ("left/arm", "left_arm"),
        ("hand::palm", "hand_palm"),
        ("world", "world_link"),
        ("__model__", "model"),
        ("  ", "link"),
        ("a\u200bb", "ab"),
        ("x" * 300, "x" * 200),
    ],
)
def test_names_of_links(name: str, valid: str) -> None:
    """Characters that a format reserves are replaced; names that all formats hold are kept."""
    assert valid_name(name, "link") == valid


@pytest.mark.parametrize(
    ("name", "valid"),
    [("../../etc", "_.._etc"), ("CON", "CON_robot"), ("a:b*c", "a_b_c"), ("...", "robot"), ("", "robot")],
)
def test_names_of_files(name: str, valid: str) -> None:
    """The robot's name is a file name on every system, and never a path."""
    assert valid_file_name(name) == valid


def test_references_follow_their_names() -> None:
    """Parents, children and leaders are renamed with what they refer to; names stay unique."""
    robot = Robot(
        "r",
        (Link("a/b"), Link("a_b"), Link("c")),
        (
            Joint("j/1", JointKind.PRISMATIC, "a/b", "a_b"),
            Joint("j_1", JointKind.PRISMATIC, "a_b", "c", mimic=Mimic("j/1")),
        ),
    )
    found: list[Finding] = []
    renamed, names = with_valid_names(robot, found)
    assert [link.name for link in renamed.links] == ["a_b", "a_b_link", "c"]
    first, second = renamed.joints
    assert (first.name, first.parent, first.child) == ("j_1", "a_b", "a_b_link")
    assert (second.name, second.parent, second.mimic and second.mimic.joint) == ("j_1_joint", "a_b_link", "j_1")
    assert names.links == {"a/b": "a_b", "a_b": "a_b_link"}
    assert {one.code for one in found} == {"SB864"}
