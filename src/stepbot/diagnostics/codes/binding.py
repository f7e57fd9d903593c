"""SB3xx: binding the sidecar to the assembly, and what a revision of the CAD changed against the lock file."""

from .code import Code

CODES = (
    Code(
        "SB301",
        "error",
        "unknown component",
        "A path or glob in the sidecar does not match any component of the STEP file. The part may have been renamed "
        "in CAD, or the path may be misspelled. The setting has no component to apply to.",
        "Look up the path with `stepbot inspect`, which prints every path ready to paste. A glob is matched from the "
        "root: `**/M3*` matches screws at any depth.",
    ),
    Code(
        "SB302",
        "error",
        "ambiguous component path",
        "A partial path matches several components, or refers to identical siblings where one component is required. "
        "stepbot does not guess the intended component.",
        "Use one of the full paths in the notes. The suffix `#n` selects one of several identical siblings.",
    ),
    Code(
        "SB303",
        "error",
        "component assigned to two links",
        "Two links list the same component. Its mass and geometry would be counted twice.",
        "Remove it from one of the links. A link may list a component inside a subassembly of another link; the more "
        "specific path takes precedence.",
    ),
    Code(
        "SB304",
        "error",
        "component not assigned to any link",
        "The STEP file contains components with geometry that do not belong to any link; with a lock file, the "
        "message tells new ones from old. Their mass and geometry would be missing from the robot.",
        "Add them to the `parts` of a link, assign all remaining components to one link with `rest: true`, or "
        "exclude them with `ignore: true` under `parts`.",
    ),
    Code(
        "SB305",
        "warning",
        "path depends on sibling order",
        "Identical siblings without unique names are distinguished by their order in the file. If the CAD program "
        "inserts or removes a sibling, `#n` silently refers to another part.",
        "Name the occurrences in CAD, or refer to the whole group if its members are interchangeable.",
    ),
    Code(
        "SB306",
        "warning",
        "path or rule without effect",
        "All components that a path matches are ignored, have no geometry, or are assigned by more specific "
        "paths; or rules above one in `parts` set the same field on all of its components to other values, "
        "since the first rule in the file holds.",
        "Remove the path, or the rules that conflict with it. Write specific rules above general ones.",
    ),
    Code(
        "SB308",
        "warning",
        "no collision geometry",
        "A component is flat or too thin for a convex hull with a volume. Engines reject flat collision geometry, so "
        "the component is written without collision geometry and makes no contact.",
        "Set `collision: none` for it under `parts` to suppress the warning, or give the link primitive shapes.",
    ),
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
