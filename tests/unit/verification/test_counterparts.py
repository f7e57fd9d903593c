"""Links and joints of two files are paired by structure where names differ."""

from itertools import pairwise

from stepbot.engines.observation import Observation, ObservedJoint, ObservedLink
from stepbot.verification.counterparts import counterparts


def _chain(count: int, prefix: str) -> Observation:
    links = tuple(ObservedLink(f"{prefix}{n}", mass=1.0) for n in range(count))
    joints = (ObservedJoint(f"{prefix}j{n}", "revolute", f"{prefix}{n}", f"{prefix}{n + 1}") for n in range(count - 1))
    return Observation(engine="x", version="1", format="urdf", links=links, joints=tuple(joints))


def test_long_chains() -> None:
    """The work does not grow with two to the power of the length: sixty links never ended."""
    assert len(counterparts(_chain(3000, "a"), _chain(3000, "b")).links) == 3000


def test_a_hand_of_another_name_below_links_of_the_same() -> None:
    """What hangs on links of one name is paired, too."""
    names = {"ours": ("base", "arm", "hand", "tip"), "theirs": ("base", "arm", "gripper", "tip")}
    seen = []
    for chain in names.values():
        links = tuple(ObservedLink(name, mass=1.0) for name in chain)
        joints = tuple(ObservedJoint(f"to_{b}", "revolute", a, b) for a, b in pairwise(chain))
        seen.append(Observation(engine="x", version="1", format="urdf", links=links, joints=joints))
    found = counterparts(*seen)
    assert (found.links, found.joints) == ({"gripper": "hand"}, {"to_gripper": "to_hand"})
