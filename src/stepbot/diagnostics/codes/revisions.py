"""SB31x: what a revision of the CAD changed, against the lock file of the sidecar."""

from .code import Code

CODES = (
    Code(
        "SB310",
        "error",
        "component renamed",
        "A path of the sidecar no longer names the component that it named when the lock file was written: a "
        "component of the same shape, in the same pose, has another name.",
        "Run `stepbot check --fix`, which replaces the path and changes nothing else in the sidecar, or "
        "replace it by hand.",
    ),
    Code(
        "SB311",
        "error",
        "component probably renamed",
        "A path of the sidecar no longer names its component, and the evidence for another name does not "
        "suffice to replace it: the same shape elsewhere, or nearly the same size in the same place. The "
        "message lists the candidates.",
        "Check the component in CAD. If it is the same part, use its new name. Otherwise remove the path, or "
        "replace it by that of another component.",
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
        "SB314",
        "note",
        "component renamed, still in its link",
        "A component has another name than in the lock file. A glob, a subassembly or `rest` still assigns it to the "
        "same link. The robot is unchanged. The lock file has the old name.",
        "Update the lock file with `stepbot lock`.",
    ),
    Code(
        "SB316",
        "warning",
        "parts of a link changed",
        "A glob, a subassembly or `rest` assigns other components to a link than when the lock file was "
        "written: one is `lost` from the STEP file, one is new and `gained`, or one is `renamed` and matches "
        "another link now. Mass and geometry of the links change without an edit of the sidecar.",
        "Correct the `parts` of the links. If the change is intended, accept it with `stepbot lock`, which "
        "updates the lock file.",
        features="gained lost renamed",
    ),
    Code(
        "SB318",
        "warning",
        "part or joint axis changed",
        "Compared with the lock file, the message names what changed: the `pose` or `shape` of a component, "
        "its `mass` because the STEP file gives it another density or material, or the `axis` or origin of a "
        "joint. Mass properties and kinematics change with it; calibrations, joint limits and motions of the "
        "earlier revision may no longer be valid.",
        "If the change is intended, accept it with `stepbot lock`, which updates the lock file.",
        features="axis mass pose shape",
    ),
)
