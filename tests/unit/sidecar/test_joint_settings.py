"""Defaults of joints: precedence by pattern, field and type."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepbot.robot.model import JointDynamics, JointKind, Limit
from stepbot.sidecar.document import Document
from stepbot.sidecar.joint_settings import joint_dynamics, joint_limits, joint_settings, position_dimension, settings_of
from stepbot.sidecar.units import ANGLE, LENGTH


def document(joint: dict[str, Any], defaults: dict[str, Any]) -> Document:
    """A robot with one joint, ``left_elbow``."""
    return Document.model_validate(
        {
            "version": 1,
            "robot": "arm",
            "step": "arm.step",
            "links": {"base": {}, "arm": {}},
            "joint_defaults": defaults,
            "joints": {"left_elbow": {"type": "revolute", "parent": "base", "child": "arm", **joint}},
        }
    )


def test_own_value_beats_defaults_and_the_first_pattern_beats_later_ones() -> None:
    """Each field comes from the joint, else from the first pattern in file order that sets it."""
    made = document(
        {"limits": {"lower": "-1 rad", "effort": 5}},
        {
            "right_*": {"limits": {"velocity": 99}},
            "left_*": {"limits": {"velocity": "60 rpm", "effort": 1}, "dynamics": {"damping": 0.1}},
            "*": {"limits": {"velocity": 2, "upper": 3}, "dynamics": {"damping": 9, "friction": 0.2}},
        },
    )
    assert joint_limits(made, "left_elbow") == Limit(-1.0, 3.0, 2 * math.pi, 5.0)
    assert joint_dynamics(made, "left_elbow") == JointDynamics(damping=0.1, friction=0.2)
    settings = joint_settings(made, "left_elbow")
    assert settings["velocity"].keys == ("joint_defaults", "left_*", "limits", "velocity")
    assert settings["effort"].keys == ("joints", "left_elbow", "limits", "effort")


@pytest.mark.parametrize("pattern", ["LEFT_*", "elbow", "left_elbo", "?left_elbow", "[!l]*"])
def test_pattern_matches_the_whole_name_and_its_case(pattern: str) -> None:
    """A pattern must match the whole name, in its case."""
    assert joint_limits(document({}, {pattern: {"limits": {"effort": 1}}}), "left_elbow") == Limit()


@pytest.mark.parametrize("kind", list(JointKind))
def test_defaults_give_only_what_the_type_has(kind: JointKind) -> None:
    """A default sets only fields that the joint's type has."""
    every = {
        "limits": {
            "lower": -1,
            "upper": 1,
            "effort": 2,
            "velocity": 3,
            "acceleration": 4,
            "deceleration": 5,
            "jerk": 6,
        },
        "dynamics": {"damping": 4, "friction": 5, "stiffness": 6, "spring_reference": 0.5, "armature": 7},
    }
    settings = joint_settings(document({"type": kind}, {"*": every}), "left_elbow")
    assert set(settings) == set(settings_of(kind))
    assert ("lower" in settings) == (kind in ("revolute", "prismatic", "screw"))
    assert ("damping" in settings) == (kind not in ("fixed", "planar", "cylindrical", "floating"))


def test_own_values_of_a_joint_are_kept() -> None:
    """A limit that the joint's type does not have is kept, for the check to report."""
    assert "lower" in joint_settings(document({"type": "fixed", "limits": {"lower": 1}}, {}), "left_elbow")


def test_position_dimensions() -> None:
    """Positions of rotating joints are angles, those of sliding ones lengths, others are not one number."""
    assert position_dimension(JointKind.REVOLUTE) == position_dimension(JointKind.SCREW) == ANGLE
    assert position_dimension(JointKind.PRISMATIC) == LENGTH
    assert position_dimension(JointKind.BALL) is position_dimension(JointKind.FIXED) is None


@given(order=st.permutations(["left_*", "*_elbow", "*"]), setters=st.sets(st.sampled_from(["left_*", "*_elbow", "*"])))
def test_first_pattern_in_file_order_wins(order: list[str], setters: set[str]) -> None:
    """Of several matching patterns the first that sets a field applies, however specific the others are."""
    defaults = {p: {"limits": {"effort": float(len(p))} if p in setters else {}} for p in order}
    first = next((float(len(p)) for p in order if p in setters), math.inf)
    assert joint_limits(document({}, defaults), "left_elbow").effort == first
