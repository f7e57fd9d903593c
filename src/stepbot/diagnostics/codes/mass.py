"""SB5xx: mass and inertia."""

from .code import Code

CODES = (
    Code(
        "SB501",
        "error",
        "no density",
        "A component has no density: neither the sidecar nor the STEP gives one.",
        "Its mass would have to be invented.",
        "Give it a `density`, a `material` or a measured `mass` in `parts`, or all such components a `defaults`.",
    ),
    Code(
        "SB502",
        "warning",
        "one density for everything",
        "Every part of the STEP carries the same density.",
        "That is the default of the CAD program, not a measurement: Fusion writes steel for plastic, and a 0.35 kg arm "
        "weighs 1.6 kg.",
        "Say `step_density: ignore` and give `defaults: {material: ...}`, with exceptions in `parts`. If it is right, "
        "repeat it as `defaults: {density: ...}` with `step_density: ignore`.",
    ),
    Code(
        "SB503",
        "error",
        "mass on nothing",
        "A `mass` is given to a component that has no volume to put it in.",
        "Where it is and how it resists turning cannot be computed from surfaces.",
        "Give it to a component with solids, or give the link an `inertial` with com and inertia.",
    ),
    Code(
        "SB504",
        "warning",
        "nested masses that contradict each other",
        "A subassembly has a `mass`, parts in it have their own, and these leave nothing, or less than nothing, for "
        "the rest, or do not add up.",
        "The outer mass is the total; the inner ones cannot be kept, and are not used.",
        "Weigh again, or remove one of the rules.",
    ),
    Code(
        "SB505",
        "note",
        "exact mass properties written",
        "Volume, centre of mass or inertia of a mesh differ from those of the exact solid by more than a thousandth, "
        "or its mesh encloses no volume.",
        "The exact values are what is written; the mesh is only drawn.",
        "Nothing needs to be done. A finer `mesh` brings the mesh nearer; `mass: mesh` takes a fine mesh of its own.",
    ),
    Code(
        "SB506",
        "note",
        "surface weighs nothing",
        "A component is a surface without thickness.",
        "It is drawn but has no mass.",
        "Nothing needs to be done if it is a label or an outline. If it stands for something heavy, give the link an "
        "`inertial`, or thicken it in the CAD.",
    ),
    Code(
        "SB507",
        "error",
        "solid without volume",
        "A component should be solid, but neither its exact geometry nor its mesh encloses a volume.",
        "Its mass would be missing from the robot without a word.",
        "Repair it in the CAD, leave it out with `ignore: true`, or give its link an `inertial` with com and inertia.",
    ),
    Code(
        "SB508",
        "error",
        "link without mass",
        "A link that moves has no mass.",
        "Engines cannot accelerate it: they refuse the file, invent 1 kg, or compute infinities.",
        "Give it parts, or an `inertial`; join it with a `fixed` joint if it only marks a place, or make it a frame.",
    ),
    Code(
        "SB509",
        "error",
        "inertia that no body can have",
        "The inertia is not positive definite, or one principal moment is larger than the sum of the other two.",
        "No arrangement of mass has such an inertia; engines diverge or silently change it.",
        "Correct the numbers: about the centre of mass, along the axes of the link, products of inertia with the sign "
        "of the tensor (ixy is minus the integral of x y).",
    ),
    Code(
        "SB510",
        "warning",
        "robot lighter than 1 g",
        "The whole robot weighs less than a gram.",
        "Few robots do; a length unit in the STEP that is not what the CAD meant, or a density in g/cm^3 read as "
        "kg/m^3, makes everything far too light.",
        "Check the unit that the CAD exported, and the densities.",
    ),
    Code(
        "SB511",
        "warning",
        "mesh that does not reach its accuracy",
        "`mass: mesh` is asked for, but volume, centre of mass or inertia of the finest mesh differ from the exact "
        "ones by more than a thousandth.",
        "The mesh's value is written, as asked for, and is that far off.",
        "Use `mass: auto` or `mass: exact`.",
    ),
    Code(
        "SB512",
        "warning",
        "solids that overlap",
        "Solids of one link fill the same space, and together that is a thousandth of the link's mass or more.",
        "What fills it is counted once for each of them. Where two materials meet, the lighter one is taken to give way. "
        "Overlaps below a thousandth of the smaller solid do not count, nor what their meshes have in common "
        "because curved faces that touch are meshed differently; nor does what a `mass` was given for.",
        "Cut one solid out of the other in the CAD, `ignore` a part that is there twice, or say what was weighed: a `mass` "
        "in `parts` or an `inertial` in the link.",
    ),
    Code(
        "SB513",
        "note",
        "solids that overlap a little",
        "Solids of one link fill the same space, but all of that is less than a thousandth of the link's mass.",
        "It is counted twice and changes the mass less than a mesh does. Threads that are drawn as cylinders, and labels, "
        "are often such.",
        "Nothing needs to be done.",
    ),
    Code(
        "SB514",
        "note",
        "overlaps not checked",
        "Whether some solids of a link overlap was not looked at: a mesh is not closed, or there are more pairs with more "
        "faces than can be checked in a few seconds.",
        "Mass that is counted twice would not be noticed there.",
        "Repair solids that do not close. Coarser meshes, by a larger `tolerance` and `angle` under `mesh`, let more "
        "pairs be checked.",
    ),
    Code(
        "SB515",
        "note",
        "material without a density",
        "The STEP names the material of a part, but neither the STEP nor the sidecar's `materials` gives its density, so "
        "that of `defaults` is taken.",
        "A part of steel that weighs as much as one of plastic shows in no picture.",
        "Add the material to `materials` under the name that it has in the STEP, with its density, or give the part a "
        "density in `parts`.",
    ),
    Code(
        "SB516",
        "error",
        "mass properties that do not converge",
        "No two ways to integrate over a solid agree to a thousandth: the kernel's integration, stepbot's own, and ever finer "
        "meshes.",
        "Each of these numbers may be wrong by more than a thousandth, and engines would confirm whichever is written.",
        "Repair the solid in the CAD (faces that cross themselves, gaps between faces), ignore it in `parts`, or give its link "
        "an `inertial` with com and inertia.",
    ),
)
