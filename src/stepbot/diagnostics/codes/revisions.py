"""SB31x: what a revision of the CAD changed, against the lock file of the sidecar."""

from .code import Code

CODES = (
    Code(
        "SB310",
        "error",
        "component renamed",
        "A path of the sidecar no longer names the component that it named when the lock file was written. A component "
        "of the same shape, in the same pose, has another name. The path names nothing, or another component, so a "
        "part of the robot would be missing or wrong.",
        "Run `stepbot check --fix`, which replaces the path and changes nothing else in the sidecar, or replace it by "
        "hand.",
    ),
    Code(
        "SB311",
        "error",
        "component probably renamed",
        "A path of the sidecar no longer names its component. The message names the candidate and the evidence: the "
        "same shape elsewhere, or nearly the same size in the same place. If there are several candidates, all are "
        "listed. The path names nothing, or another component. This evidence is not sufficient to replace the path.",
        "Check the component in CAD. If it is the same part, use its new name. Otherwise remove the path, or replace "
        "it by that of another component.",
    ),
    Code(
        "SB312",
        "error",
        "component removed",
        "A path of the sidecar names a component that is no longer in the STEP file, and no new component has its "
        "shape or pose. The link, joint or rule that names it is incomplete.",
        "Remove the path, or replace it by that of another component.",
    ),
    Code(
        "SB313",
        "error",
        "new component not assigned to any link",
        "The STEP file contains components that are not in the lock file and not assigned to any link. Their mass and "
        "geometry would be missing from the robot.",
        "Add them to the `parts` of a link, or exclude them with `ignore: true` under `parts`.",
    ),
    Code(
        "SB314",
        "note",
        "component renamed, still in its link",
        "A component has another name than in the lock file. A glob, a subassembly or `rest` still assigns it to the "
        "same link. The robot is unchanged. The lock file has the old name.",
        "Update the lock file with `stepbot lock`.",
    ),
    Code(
        "SB315",
        "warning",
        "renamed component in another link",
        "A component has another name than in the lock file, and the new name matches a glob or a subassembly of "
        "another link. Mass and geometry move from one link to another, without an edit of the sidecar.",
        "Correct the `parts` of both links. If the change is intended, accept it with `stepbot lock`, which updates "
        "the lock file.",
    ),
    Code(
        "SB316",
        "warning",
        "link lost a component",
        "A component of a link is no longer in the STEP file. A glob, a subassembly or `rest` assigned it to the link. "
        "The link is lighter than before, without an unmatched path.",
        "Check in CAD that the component was removed on purpose. If the change is intended, accept it with `stepbot "
        "lock`, which updates the lock file.",
    ),
    Code(
        "SB317",
        "warning",
        "link gained a component",
        "A component that is not in the lock file is assigned to a link by a glob, a subassembly or `rest`. The new "
        "component moves with this link, and may belong to another.",
        "List it in the `parts` of the link that it belongs to. If the change is intended, accept it with `stepbot "
        "lock`, which updates the lock file.",
    ),
    Code(
        "SB318",
        "warning",
        "component moved",
        "A component is in another pose than in the lock file. Centre of mass and inertia of its link change. Joints "
        "bound to its faces move with it.",
        "If the change is intended, accept it with `stepbot lock`, which updates the lock file.",
    ),
    Code(
        "SB319",
        "warning",
        "shape of a component changed",
        "Volume, moments or faces of a component differ from those in the lock file. Mass, centre of mass, inertia and "
        "geometry of its link change.",
        "If the change is intended, accept it with `stepbot lock`, which updates the lock file.",
    ),
)
