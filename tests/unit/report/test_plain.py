"""Records as JSON data, and back."""

from math import inf, nan
from typing import Any

import pytest
from msgspec import Struct

from stepbot.geometry.spatial import Pose
from stepbot.report.plain import Invalid, picked, plain, unpicked
from stepbot.robot.model import Joint, JointKind, Limit, Mimic

KEYS = "name kind pose=X_PC limits=limit mimic"


class Weighed(Struct, frozen=True):
    """A record with a value that may be None, and one that may not."""

    mass: float
    faces: tuple[int, ...] = ()
    density: float | None = None


def test_fields_have_the_stated_keys_in_their_order() -> None:
    """A key may have another name than its field, and another value."""
    joint = Joint("elbow", JointKind.REVOLUTE, "base", "arm", limit=Limit(lower=-1.0), mimic=Mimic("shoulder"))
    document = picked(joint, "parent name=child kind limits axis2", limits="todo", axis2=None)
    assert list(document.items()) == [
        ("parent", "base"),
        ("name", "arm"),
        ("kind", "revolute"),
        ("limits", "todo"),
        ("axis2", None),
    ]


def test_values_that_json_lacks_are_null_or_objects() -> None:
    """Numbers that are not finite, poses, enumerations and records within records."""
    assert plain((inf, nan, 1, True, "x", JointKind.BALL)) == [None, None, 1, True, "x", "ball"]
    assert plain(Mimic("a")) == {"joint": "a", "multiplier": 1.0, "offset": 0.0}
    assert plain({"X": Pose.of(position=(1.0, 2.0, 3.0))}) == {"X": {"xyz": [1.0, 2.0, 3.0], "rpy": [0.0, 0.0, 0.0]}}
    with pytest.raises(TypeError, match="complex has no JSON form"):
        plain(1j)


def test_records_are_read_back() -> None:
    """Null is the default of a field, where that is asked for."""
    X = Pose.from_xyz_rpy((0.1, 0.0, 0.2), (0.0, 0.5, 0.0))
    joint = Joint("elbow", JointKind.REVOLUTE, "base", "arm", X, limit=Limit(lower=-1.0), mimic=Mimic("shoulder", 2.0))
    read = unpicked(Joint, picked(joint, KEYS), KEYS, has_defaults=True, parent="base", child="arm")
    assert read.X_PC.distance_to(X) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert (read.name, read.kind, read.limit, read.mimic) == (joint.name, joint.kind, joint.limit, joint.mimic)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"kind": "elastic"}, "joint.kind: expected one of fixed, "),
        ({"limits": {"lowest": 0.0}}, "joint.limits.lowest: unknown"),
    ],
)
def test_other_words_and_keys_are_errors(changed: dict[str, Any], words: str) -> None:
    """So are values that an enumeration does not have, and keys of a record that are no field."""
    document = picked(Joint("elbow", JointKind.FIXED, "base", "arm"), KEYS) | changed
    with pytest.raises(Invalid, match=words):
        unpicked(Joint, document, KEYS, "joint", has_defaults=True, parent="base", child="arm")


@pytest.mark.parametrize(
    ("document", "words"),
    [
        ([], "parts: expected an object"),
        ({}, "parts.mass: missing"),
        ({"mass": None}, "parts.mass: expected a number"),
        ({"mass": inf}, "parts.mass: expected a number"),
        ({"mass": 1, "faces": [1, "x"]}, "parts.faces[1]: expected a whole number"),
        ({"mass": 1, "faces": [], "density": "2700"}, "parts.density: expected a number"),
    ],
)
def test_other_data_is_an_error_at_its_place(document: Any, words: str) -> None:
    """The message names the value and what it is to be."""
    with pytest.raises(Invalid) as error:
        unpicked(Weighed, document, "mass faces density", "parts")
    assert str(error.value) == words
