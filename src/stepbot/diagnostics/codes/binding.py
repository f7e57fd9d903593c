"""SB3xx: binding the sidecar to the assembly."""

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
)
