"""SB6xx: meshes and tessellation."""

from .code import Code

CODES = (
    Code(
        "SB601",
        "warning",
        "faces without triangles",
        "The mesher left faces of a body without triangles, also when asked again in other ways.",
        "The mesh has holes there. Where the exact shape is sound, mass properties come from it and are right.",
        "Repair the faces in CAD, or accept the hole: it shows, and weighs nothing.",
    ),
    Code(
        "SB602",
        "warning",
        "solid with open edges",
        "Faces of a solid do not meet: edges belong to one face only.",
        "It encloses no volume, so there is no mass to compute from it.",
        "Close the solid in CAD, or give its mass in the sidecar.",
    ),
    Code(
        "SB603",
        "warning",
        "mesh coarsened",
        "At the tolerance asked for, the mesh of a body would have more faces than engines load in reasonable time.",
        "It is coarser than asked; mass properties do not suffer, they are checked against the exact shape.",
        "Ask for a larger tolerance or angle under `mesh`, or simplify the body in CAD.",
    ),
    Code(
        "SB604",
        "warning",
        "mesh not watertight",
        "Edges of a body's mesh do not each join two faces.",
        "Its volume cannot be told from the mesh. Where the exact shape is sound, mass properties come from it.",
        "Look at the body in CAD: faces that overlap, edges that more than two faces share.",
    ),
    Code(
        "SB605",
        "warning",
        "mass properties that do not converge",
        "The kernel's integration over a solid, stepbot's own, and ever finer meshes differ by more than a thousandth.",
        "The solid may be invalid, for example a face that crosses itself; its mass properties are not known, and no robot is "
        "built of it (SB516).",
        "Repair the solid in CAD, ignore it, or give its link an `inertial` with com and inertia.",
    ),
    Code(
        "SB606",
        "warning",
        "measuring mesh not fine enough",
        "With `mass: mesh`, the measuring mesh of a body still deviated from the exact shape at the largest size allowed.",
        "The mass properties by mesh are less exact than asked for; the report holds both.",
        "Use `mass: auto` or `mass: exact`.",
    ),
    Code(
        "SB607",
        "warning",
        "solid that passes through itself",
        "The solid closes, but parts of its surface lie within it: lobes that overlap, or shells that cross.",
        "What lies in two lobes is counted twice or subtracted, by the kernel and by any mesh alike, so that mass, com and "
        "inertia are those of no real body.",
        "Repair the solid in CAD, or give its mass in the sidecar. Walls thinner than the mesh is exact cross in the mesh "
        "only: ask for a finer `mesh` then.",
    ),
)
