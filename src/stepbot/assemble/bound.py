"""Links, masses and joints of an assembly by its sidecar, as far as the sidecar can be resolved."""

from collections.abc import Mapping, Sequence

from msgspec import Struct

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.spatial import Vector3, tidy
from stepbot.geometry.volume import VolumeProperties
from stepbot.robot.model import ComponentMass
from stepbot.sidecar.located import Sidecar
from stepbot.step.assembly import Assembly

from .binder import UNREVISED, Binder, RevisedComponents
from .claims import Claims, claim
from .frames import Frames, OriginRequest
from .joints import direction_in, tree_order
from .masses import masses
from .material_assignment import assign_materials
from .measured_bodies import measured_bodies


class PlacedJoint(Struct, frozen=True):
    """A joint or closure, as drawn."""

    name: str
    kind: str
    parent: str
    child: str
    origin: Vector3
    """[m] in the assembly's frame."""
    axis: Vector3 | None = None
    """Unit direction in the same frame; None for a joint without one."""


class Bound(Struct, frozen=True):
    """Links, masses and joints of an assembly."""

    claims: Claims
    masses: Mapping[int, ComponentMass]
    """By component."""
    joints: tuple[PlacedJoint, ...]
    """Joints and closures whose place is known, in the sidecar's order."""


def bind(
    assembly: Assembly,
    sidecar: Sidecar,
    measures: Sequence[VolumeProperties | None],
    revised: RevisedComponents = UNREVISED,
) -> Bound:
    """The resolvable parts of a sidecar; errors are reported by :func:`build_robot`.

    Args:
        sidecar: A sidecar whose own check found no error.
        measures: For each of ``assembly.bodies`` what trimesh measures on its mesh.
        revised: Components that a revision of the CAD has changed.
    """
    binder = Binder(assembly, sidecar, Diagnostics(), revised)
    materials = assign_materials(binder)
    claims = claim(binder, materials)
    weighed = masses(binder, materials, measured_bodies(assembly, measures, sidecar.document.mass))
    return Bound(claims, weighed, placed_joints(binder, Frames(binder, claims, tree_order(sidecar.document)[0])))


def placed_joints(binder: Binder, frames: Frames) -> tuple[PlacedJoint, ...]:
    """The joints and closures whose place is known."""
    document = binder.document
    placed = []
    for name, joint in document.joints.items():
        X_WJ = frames.joint(name)
        if X_WJ is not None:
            axis = direction_in(X_WJ, joint.axis) if joint.type.has_axis else None
            placed.append(PlacedJoint(name, joint.type.value, joint.parent, joint.child, tidy(X_WJ).position, axis))
    for name, closure in document.closures.items():
        ends = (closure.link_a, closure.link_b)
        X_WF = frames.resolve(closure.origin, OriginRequest(("closures", name, "origin"), ends))
        if X_WF is not None:
            axis = direction_in(X_WF, closure.axis) if closure.type.has_axis else None
            placed.append(PlacedJoint(name, closure.type.value, *ends, tidy(X_WF).position, axis))
    return tuple(placed)
