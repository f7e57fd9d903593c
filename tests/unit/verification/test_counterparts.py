"""Links and joints of two files are paired by structure where names differ."""

from stepbot.engines.observation import Observation, ObservedJoint, ObservedLink
from stepbot.verification.counterparts import counterparts


def _chain(count: int, prefix: str) -> Observation:
    links = tuple(ObservedLink(f"{prefix}{n}", mass=1.0) for n in range(count))
    joints = (ObservedJoint(f"{prefix}j{n}", "revolute", f"{prefix}{n}", f"{prefix}{n + 1}") for n in range(count - 1))
    return Observation(engine="x", version="1", format="urdf", links=links, joints=tuple(joints))


def test_long_chains() -> None:
    """The work does not grow with two to the power of the length: sixty links never ended."""
    assert len(counterparts(_chain(3000, "a"), _chain(3000, "b")).links) == 3000
