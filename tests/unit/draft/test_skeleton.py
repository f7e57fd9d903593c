"""The tree of a description: which elements become links, joints, frames and closures."""

import numpy as np

from stepbot.draft.from_description.skeleton import skeleton
from stepbot.engines.description import Description
from stepbot.engines.observation import Observation, ObservedClosure, ObservedJoint, ObservedLink
from stepbot.geometry.spatial import IDENTITY, Pose, Vector3
from stepbot.robot.model import JointKind, Limit

MASS = {"mass": 1.0, "com": (0.0, 0.0, 0.0), "inertia": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))}


def described(
    links: tuple[ObservedLink, ...], joints: tuple[ObservedJoint, ...], closures: tuple[ObservedClosure, ...] = ()
) -> Description:
    """A description without shapes, each link 1 m above its parent."""
    seen = Observation("test", "1", "mjcf", links=links, joints=joints, closures=closures)
    return Description(seen, {joint.child: Pose.of(position=(0.0, 0.0, 1.0)) for joint in joints}, ())


def hinge(child: str, parent: str, kind: str = "revolute", anchor: Vector3 = (0.0, 0.0, 0.0)) -> ObservedJoint:
    """A joint about x."""
    return ObservedJoint(
        f"to_{child}", kind, parent, child, axis=(1.0, 0.0, 0.0), anchor=anchor, limit=Limit(-1.0, 1.0)
    )


def test_closures_are_joints_at_their_points() -> None:
    """A point is a ball joint, two points on a line are a hinge; a closure of a link that is left out is none."""
    links = tuple(ObservedLink(name, **MASS) for name in ("base", "a", "b"))
    point = (0.1, 0.2, 0.3)
    closures = (
        ObservedClosure("one_point", "connect", "a", "b", points=(point, point)),
        ObservedClosure("no_length", "connect", "a", "b", points=(point, point), axes=((0.0, 0.0, 0.0),) * 2),
        ObservedClosure(
            "two_points", "connect", "a", "b", points=(point, point), axes=((0.0, 0.5, 0.0), (0.0, 0.0, 0.5))
        ),
        ObservedClosure("slide", "prismatic", "a", "b", points=(point, point), axes=((0.0, 0.0, 1.0),) * 2),
        ObservedClosure("weld", "weld", "a", "b"),
        ObservedClosure("elsewhere", "connect", "a", "nobody", points=(point, point)),
    )
    found = skeleton(described(links, (hinge("a", "base", anchor=(0.0, 0.1, 0.0)), hinge("b", "base")), closures))
    assert found is not None
    kinds = {closure.name: closure.kind for closure in found.closures}
    assert kinds == {
        "one_point": JointKind.BALL,
        "no_length": JointKind.BALL,
        "two_points": JointKind.REVOLUTE,
        "slide": JointKind.PRISMATIC,
    }
    assert [None if one.axis is None else one.axis.tolist() for one in found.closures][2:] == [[0, 0.5, 0], [0, 0, 1]]
    for closure in found.closures:  # the frame of link a is at its joint
        assert np.allclose(closure.point, (0.1, 0.1, 0.3), atol=1e-15)


def test_empty_links_at_fixed_joints_are_frames() -> None:
    """Empty links below a fixed joint are frames of the link above; one that carries a link with mass stays."""
    links = tuple(
        ObservedLink(name, **(MASS if name in ("base", "hand") else {}))
        for name in ("world", "base", "flange", "tool", "holder", "hand", "loose")
    )
    joints = (
        hinge("base", "world", "fixed"),
        hinge("flange", "base", "fixed"),
        hinge("tool", "flange", "fixed"),
        hinge("holder", "base", "fixed"),
        hinge("hand", "holder"),
        hinge("loose", "hand"),
    )
    found = skeleton(described(links, joints))
    assert found is not None
    assert list(found.links) == ["base", "holder", "hand", "loose"]
    assert [(frame.name, frame.link, frame.X_LF.position) for frame in found.frames] == [
        ("flange", "base", (0.0, 0.0, 1.0)),
        ("tool", "base", (0.0, 0.0, 2.0)),
    ]
    assert found.rigid_groups() == {"base": "base", "holder": "base", "hand": "hand", "loose": "loose"}
    lifted = found.poses(IDENTITY, {"hand": np.pi / 2})
    assert np.allclose(lifted["loose"].p, (0.0, -1.0, 2.0), atol=1e-15)


def test_elements_that_are_left_out_are_noted() -> None:
    """The larger of two trees is taken, and the first of two joints of one link."""
    links = tuple(ObservedLink(name, **MASS) for name in ("table", "base", "arm"))
    second = ObservedJoint("again", "revolute", "table", "arm")
    found = skeleton(described(links, (hinge("arm", "base"), second)))
    assert found is not None
    assert list(found.links) == ["base", "arm"]
    assert [joint.name for joint in found.joints.values()] == ["to_arm"]
    assert found.notes == (
        "joint 'again' is one of several of link 'arm': only the first is taken",
        "bodies beside the robot are left out: table",
    )
    assert skeleton(described((), ())) is None
