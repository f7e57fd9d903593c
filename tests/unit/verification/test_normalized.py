"""Observations of formats that say one thing differently, brought to a common form."""

from msgspec.structs import replace

from stepbot.engines.observation import (
    Observation,
    ObservedClosure,
    ObservedJoint,
    ObservedLink,
    ObservedShape,
    Quantity,
)
from stepbot.robot.model import Mimic
from stepbot.verification.compare import compare
from stepbot.verification.normalized import normalized

BOX = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
LARGER = (0.0, 0.0, 0.0), (1.0, 1.0, 2.0)


def _joint(name: str, parent: str, mimic: Mimic | None = None) -> ObservedJoint:
    return ObservedJoint(name, "revolute", parent, f"{name}_link", (0.0, 0.0, 1.0), mimic=mimic, mimic_read=True)


def _mechanism(follower: Mimic | None, closures: tuple[ObservedClosure, ...], free: Mimic | None = None) -> Observation:
    """A crank, a rocker in a loop with it, and a joint beside the loop."""
    joints = _joint("crank", "base"), _joint("rocker", "base", follower), _joint("flap", "base", free)
    links = tuple(ObservedLink(name) for name in ("base", *(joint.child for joint in joints)))
    return Observation("engine", "1", "urdf", links=links, joints=joints, closures=closures)


def _failed(a: Observation, b: Observation) -> set[Quantity]:
    return {one.quantity for one in compare(*normalized(a, b)) if one.deviations.failures and not one.not_run}


def test_a_mimic_stands_for_a_loop() -> None:
    """In a file without loops a joint of the loop may mimic another; one beside the loop may not."""
    pin = ObservedClosure("pin", "revolute", "crank_link", "rocker_link")
    loop = replace(_mechanism(None, (pin,)), format="sdf")
    tree = _mechanism(Mimic("crank", 0.5), ())
    assert Quantity.MIMIC not in _failed(tree, loop)
    assert Quantity.MIMIC not in _failed(loop, tree)
    assert Quantity.MIMIC in _failed(_mechanism(Mimic("crank", 0.5), (), Mimic("crank", 2.0)), loop)
    assert Quantity.MIMIC in _failed(tree, replace(_mechanism(None, ()), format="sdf"))


def _shown(written_in: str, *shapes: ObservedShape) -> Observation:
    return Observation("engine", "1", written_in, links=(ObservedLink("base", has_visuals=True, visuals=shapes),))


def test_shapes_without_names_are_paired_by_their_boxes() -> None:
    """Their colours and boxes are compared, whatever their order."""
    red, blue = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)
    named = _shown("mjcf", ObservedShape("a", red, bounds=BOX), ObservedShape("b", blue, bounds=LARGER))
    assert not _failed(
        named, _shown("urdf", ObservedShape("", blue, bounds=LARGER), ObservedShape("", red, bounds=BOX))
    )
    swapped = _shown("urdf", ObservedShape("", red, bounds=LARGER), ObservedShape("", blue, bounds=BOX))
    assert _failed(named, swapped) == {Quantity.SHAPES}


def test_a_shape_without_a_box_is_paired_with_another_one() -> None:
    """Such as a plane: it takes no box away from the shape that has nearly the same."""
    red, blue, nearly = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0), tuple(tuple(x + 1e-9 for x in p) for p in BOX)
    named = _shown("mjcf", ObservedShape("a", red, bounds=BOX), ObservedShape("b", blue))
    assert not _failed(named, _shown("urdf", ObservedShape("", blue), ObservedShape("", red, bounds=nearly)))


def test_three_shapes_stand_for_a_capsule() -> None:
    """A cylinder and two spheres are compared with the capsule: colour and box."""
    red, blue = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)
    capsule = _shown("sdf", ObservedShape("arm", red, bounds=LARGER))

    def parts(
        color: tuple[float, ...], bounds: tuple[tuple[float, float, float], tuple[float, float, float]]
    ) -> Observation:
        ends = (ObservedShape(f"arm_{end}", red, bounds=BOX) for end in ("top", "bottom"))
        return _shown("urdf", ObservedShape("arm_middle", color, bounds=bounds), *ends)

    assert not _failed(capsule, parts(red, LARGER))
    assert _failed(capsule, parts(blue, LARGER)) == {Quantity.SHAPES}
    assert _failed(capsule, parts(red, BOX)) == {Quantity.MESHES}
