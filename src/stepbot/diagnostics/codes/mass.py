"""SB5xx: mass and inertia."""

from .code import Code

CODES = (
    Code(
        "SB501",
        "error",
        "missing density",
        "Neither the sidecar nor the STEP file defines a density for a component. Its mass cannot be computed.",
        "Set `density`, `material` or a measured `mass` under `parts`, or a default for all components under "
        "`defaults`.",
    ),
    Code(
        "SB502",
        "warning",
        "same density on every part",
        "Every part of the STEP file has the same density. This is typically the default of the CAD program: Fusion "
        "exports plastic parts with the density of steel, which makes a 0.35 kg arm weigh 1.6 kg.",
        "Set `step_density: ignore` and `defaults: {material: ...}`, with exceptions under `parts`. If the density is "
        "correct, set `defaults: {density: ...}` with `step_density: ignore`.",
    ),
    Code(
        "SB503",
        "error",
        "mass assigned to a component without volume",
        "A `mass` is given for a component that has no volume. The mass distribution cannot be computed from surfaces.",
        "Assign the mass to a component with solids, or give the link an `inertial` with com and inertia.",
    ),
    Code(
        "SB504",
        "warning",
        "inconsistent nested masses",
        "A subassembly and some of its parts have a `mass`, and the masses of the parts do not add up to that of the "
        "subassembly, or leave nothing for the remaining parts. The mass of the subassembly is used, and the masses of "
        "its parts are ignored.",
        "Weigh the parts again, or remove one of the rules.",
    ),
    Code(
        "SB505",
        "note",
        "exact solid's mass properties used",
        "The volume, centre of mass or inertia of a mesh differs from that of the exact solid by more than a "
        "thousandth, or the mesh is not closed. The exact values are written. The mesh is used for display and "
        "collision only.",
        "No action is needed. A finer `mesh` reduces the difference; `mass: mesh` computes mass properties from a "
        "separate fine mesh.",
    ),
    Code(
        "SB506",
        "note",
        "surface body has no mass",
        "A component is a surface without thickness. It is visible but has no mass.",
        "No action is needed for labels and outlines. If the surface stands for a solid part, thicken it in CAD or "
        "give the link an `inertial`.",
    ),
    Code(
        "SB507",
        "error",
        "solid has no volume",
        "Neither the exact geometry nor the mesh of a solid encloses a volume. Its mass would be missing from the "
        "robot.",
        "Repair the solid in CAD, exclude it with `ignore: true`, or give its link an `inertial` with com and inertia.",
    ),
    Code(
        "SB508",
        "error",
        "massless moving link",
        "A moving link has no mass. Engines reject the file, assume 1 kg, or compute infinite accelerations.",
        "Assign components to the link or give it an `inertial`. For a reference frame, use a `fixed` joint or an "
        "entry under `frames`.",
    ),
    Code(
        "SB509",
        "error",
        "unphysical inertia",
        "The inertia is not positive definite, or one principal moment exceeds the sum of the other two. No mass "
        "distribution has such an inertia. Engines diverge or silently change it.",
        "Correct the numbers. They refer to the centre of mass and the axes of the link, and products of inertia have "
        "the sign of the tensor: ixy is the negative integral of x y.",
    ),
    Code(
        "SB510",
        "warning",
        "robot lighter than 1 g",
        "The total mass of the robot is less than a gram, or a robot that stands still has no mass at all. Few robots "
        "are that light. A wrong length unit in the STEP file, or a density in g/cm^3 read as kg/m^3, makes everything "
        "far too light.",
        "Check the unit of the CAD export, and the densities.",
    ),
    Code(
        "SB511",
        "warning",
        "mesh accuracy not reached",
        "`mass: mesh` is set, but the volume, centre of mass or inertia of the finest mesh differs from the "
        "exact value by more than a thousandth. The values of the mesh are written; the report contains both.",
        "Use `mass: auto` or `mass: exact`.",
    ),
    Code(
        "SB512",
        "warning",
        "overlapping solids",
        "Solids of one link overlap, by a thousandth of its mass or more. The overlap counts once per solid; "
        "where two materials overlap, the lighter one is assumed to be displaced. Overlaps below a thousandth "
        "of the smaller solid, overlaps of meshes along touching curved faces, and components with a given "
        "`mass` are not compared.",
        "Subtract one solid from the other in CAD, `ignore` a duplicate part, or give a measured `mass` under "
        "`parts` or an `inertial` on the link.",
    ),
    Code(
        "SB513",
        "note",
        "slightly overlapping solids",
        "Solids of one link overlap, by less than a thousandth of the mass of the link. The overlap is counted twice, "
        "which changes the mass less than meshing does. Threads modelled as cylinders and labels are typical causes.",
        "No action is needed.",
    ),
    Code(
        "SB514",
        "note",
        "overlaps not checked",
        "Some solids of a link were not checked for overlaps, because a mesh is not closed or the number of pairs and "
        "faces is too large to check in a few seconds. Mass that is counted twice would not be detected.",
        "Repair open solids. A larger `tolerance` and `angle` under `mesh` gives coarser meshes, which allows more "
        "pairs to be checked.",
    ),
    Code(
        "SB515",
        "note",
        "material has no density",
        "The STEP file names the material of a part, but neither the STEP file nor `materials` in the sidecar gives "
        "its density. The density of `defaults` is used. A wrong density is not visible in any picture.",
        "Add the material to `materials` under its name in the STEP file, with its density, or give the part a density "
        "under `parts`.",
    ),
    Code(
        "SB516",
        "error",
        "mass properties not determined",
        "The integration of the geometry kernel, that of stepbot, and a sequence of finer meshes differ by "
        "more than a tenth for a solid. Engines would confirm any of the values.",
        "Repair the solid in CAD (self-intersecting faces, gaps between faces), ignore it under `parts`, or "
        "give its link an `inertial` with com and inertia.",
    ),
    Code(
        "SB518",
        "warning",
        "implausible centre of mass or inertia",
        "The `inertial` of a link has values that no body of its geometry and mass has. `large-inertia`: along "
        "the named axis, the mass would have to be outside the geometry. `small-inertia`: a ball of osmium, "
        "the densest element, has more. `com`: the centre of mass is outside the convex hull by more than a "
        "hundredth of its diagonal. Engines accept all of them and simulate another robot.",
        "Give the inertia in kg m^2 about the centre of mass, not about the joint, and `com` in the link's "
        "frame, which is that of the joint above it; or omit `inertia` to compute it from the shape. Keep a "
        "maker's value with `ignore_findings: [{code: SB518, reason: ...}]` on the link.",
        features="com large-inertia small-inertia",
    ),
    Code(
        "SB521",
        "warning",
        "implausible density",
        "A density, or a `mass` for the volume of its components, exceeds 25000 kg/m^3 (osmium, the densest "
        "element, has 22590), or a density is below 5 kg/m^3 (foams for packaging have 10 to 30). The unit is "
        "probably wrong: a number without a unit is in kg or kg/m^3. Or the mass is that of several "
        "components, and each of them gets all of it.",
        "Write the value with its unit: `55 g`, `2.7 g/cm^3`. A mass is that of each component that the path "
        "matches. If a solid stands for something heavier, keep it with `ignore_findings: [{code: SB521, "
        "reason: ...}]` in its rule or link.",
    ),
    Code(
        "SB522",
        "warning",
        "placeholder density",
        "Components have the density of `defaults: {density: todo}`, the placeholder written by `stepbot "
        "init`: 1000 kg/m^3. Steel is eight times as dense. Every check of the files passes, because all have "
        "the same masses.",
        "Replace `todo` by the density of the material, or give densities or weighed masses under `parts`.",
    ),
    Code(
        "SB523",
        "note",
        "values in a turned frame",
        "A link has an `inertial` with com or inertia, or a list of `collision` shapes, and the joint above it "
        "has a `zero`. These values are in the frame of the link, which is that of its joint at q = 0; values "
        "read in the drawn pose, where q is `zero`, are off by it.",
        "Give the values in the frame at q = 0, as a URDF does, or leave out `zero`. `ignore: [SB523]` confirms them.",
    ),
    Code(
        "SB524",
        "warning",
        "part is not like its motor",
        "The bounding box or the mass of the component under `part` differs from that of the actuator's motor. It is "
        "another motor, or another part.",
        "Correct `motor` or `part`; `stepbot motors NAME` shows size and mass with their sources.",
    ),
    Code(
        "SB525",
        "error",
        "not as expected",
        "The sidecar states under `expect` what the robot must be, and a mass, a centre of mass or a reach that is "
        "computed from the CAD differs by more than its tolerance. The CAD, a density or a mass has changed, or the "
        "expected value is of another revision.",
        "Correct the CAD or the masses, or state the new value under `expect`.",
    ),
    Code(
        "SB526",
        "warning",
        "not symmetric",
        "`expect: {symmetry: y}` states that the drawn robot is its own mirror image, but parts have no twin "
        "on the other side, twins differ by more than 20 % in mass, or the centre of mass is off the plane by "
        "more than 0.5 % of the robot's size.",
        "Compare the named parts: one is missing or displaced, or has another material. A rule of `parts` with "
        "a glob gives both the same material. Ignore the finding, with a reason, for a robot that is meant to "
        "be so.",
    ),
)
