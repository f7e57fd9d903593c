"""Robots that are far too large or too light, probably because of a wrong length unit."""

from collections.abc import Callable, Iterable, Mapping

import numpy as np

from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.poses import bounds_at
from stepbot.geometry.primitives import half_size
from stepbot.geometry.spatial import Vector3, bounds, box_corners, join_bounds

from .kinematics import initial_configuration, link_poses
from .model import Geometry, MeshRef, Robot

LARGEST = 20.0
"""Size [m] above which the unit is questionable."""
SMALLEST = 1e-3
"""Size [m] of an assembly below which the unit is questionable."""
LIGHTEST = 1e-3
"""Mass [kg] below which the unit is questionable."""

_OTHER_UNIT = "if it was drawn in another unit, export it again with that unit"

_Extent = tuple[Vector3, Vector3]


def check_scale(robot: Robot, report: Callable[..., None], unit: str, *, massless: bool = False) -> None:
    """Report SB420, a robot of tens of metres, and SB510, one of milligrams: drawn in another unit than declared.

    Primitive collision shapes have their dimensions from elsewhere, so that a size due to them is no doubt of the unit.

    Args:
        report: Reports a code, a message, its remedies and what it is about.
        unit: Length unit of the robot's source.
        massless: Whether nothing has a mass, and no error has reported that.
    """
    remedy = f"check the length unit of {robot.source or 'its source'}" + (f" ({unit})" if unit else "")
    total = exact_sum(link.mass_properties.mass for link in robot.links)
    if 0.0 < total < LIGHTEST:
        report(
            "SB510", f"robot '{robot.name}': mass of {total * 1e3:.3g} g; {remedy}", help=(_OTHER_UNIT,), about="step"
        )
    elif massless:
        help = ("give the solids a density or the parts a `mass`; surfaces and open meshes have no mass of their own",)
        report("SB510", f"robot '{robot.name}': no mass in any link", help=help, about="step")
    boxes, primitives = _boxes(robot)
    size = _size([*boxes, *(box for several in primitives.values() for box in several)])
    if size <= LARGEST:
        return
    drawn = _size(boxes)
    if drawn > LARGEST or not boxes:
        report(
            "SB420", f"robot '{robot.name}': size of {size:.3g} m; {remedy}", help=other_units(size, unit), about="step"
        )
        return
    large = [link for link, several in primitives.items() if _size([*boxes, *several]) > LARGEST] or list(primitives)
    links = ", ".join(f"'{link}'" for link in large)
    report(
        "SB420",
        f"robot '{robot.name}': size of {size:.3g} m, {drawn:.3g} m without the collision shapes of {links}",
        help=("check the dimensions and poses of these shapes: numbers without a unit are in m",),
        about=f"link '{large[0]}': collision",
    )


def other_units(size: float, unit: str) -> tuple[str, ...]:
    """The remedy for a size [m] that is doubtful in the unit that its file declares."""
    if unit != "m" or size < LARGEST:
        return (_OTHER_UNIT,)
    return (f"if it was drawn in mm, it is {size * 1e-3:.3g} m large: export it again with that unit",)


def _size(boxes: Iterable[_Extent]) -> float:
    """Longest edge [m] of the box around boxes; 0 without any."""
    several = list(boxes)
    if not several:
        return 0.0
    low, high = join_bounds(several)
    return max(top - bottom for bottom, top in zip(low, high, strict=True))


def _boxes(robot: Robot) -> tuple[list[_Extent], dict[str, list[_Extent]]]:
    """Bounding boxes [m] of the robot as drawn: of visuals and meshes, and of the primitive collisions of each link."""
    poses = link_poses(robot, initial_configuration(robot))
    extents = {asset.name: asset.mesh.bounds for asset in robot.meshes if len(asset.mesh.vertices)}
    drawn: list[_Extent] = []
    primitives: dict[str, list[_Extent]] = {}
    for link in robot.links:
        for shapes, is_collision in ((link.visual_poses, False), (link.collision_poses, True)):
            for geometry, X_LG in shapes.items():
                extent = _extent(geometry, extents)
                if extent is None:
                    continue
                by_hand = is_collision and not isinstance(geometry, MeshRef)
                boxes = primitives.setdefault(link.name, []) if by_hand else drawn
                boxes.append(bounds(np.concatenate(bounds_at(box_corners(*extent), X_LG.seen_from(poses[link.name])))))
    return drawn, primitives


def _extent(geometry: Geometry, of_meshes: Mapping[str, _Extent]) -> _Extent | None:
    """Lowest and highest corner [m] of a geometry in its own frame; None if it is empty."""
    if isinstance(geometry, MeshRef):
        return of_meshes.get(geometry.name)
    x, y, z = half_size(geometry)
    return (-x, -y, -z), (x, y, z)
