"""SB3xx: binding the sidecar to the assembly."""

from .code import Code

CODES = (
    Code(
        "SB301",
        "error",
        "no such component",
        "A path or glob of the sidecar names nothing in the STEP.",
        "The CAD may have renamed the part, or the path is misspelt; what the line asks for cannot be done.",
        "Take the near match from the help, or look the path up with `stepbot inspect`, which prints every path ready "
        "quoted. A glob matches from the root: `**/M3*` finds screws at any depth.",
    ),
    Code(
        "SB302",
        "error",
        "path names several components",
        "A path that is not complete ends like this in several places, or names equal siblings where one component is "
        "needed.",
        "stepbot does not guess which one is meant.",
        "Write one of the paths in the notes; `#n` tells equal siblings apart.",
    ),
    Code(
        "SB303",
        "error",
        "component in two links",
        "Two links name the same component.",
        "It would be weighed and drawn twice.",
        "Remove it from one of the links. A link may name a part of a subassembly that another link names: the nearer "
        "claim wins.",
    ),
    Code(
        "SB304",
        "error",
        "component in no link",
        "The STEP has components with a body that no link takes.",
        "Their mass and shape would be missing from the robot without a word.",
        "Add them to the `parts` of a link, let one link take what is left with `rest: true`, or leave them out for "
        "good with `ignore: true` in `parts`.",
    ),
    Code(
        "SB305",
        "warning",
        "path that holds by #n alone",
        "Equal siblings without names of their own are told apart by their order in the file.",
        "When the CAD inserts or removes one, `#n` means another part, and nobody notices.",
        "Give the occurrences names in the CAD, or name the whole group if its members need not be told apart.",
    ),
    Code(
        "SB306",
        "warning",
        "path that takes nothing",
        "A link names components of which none is left for it: they are ignored, hold no body, or are taken by nearer "
        "claims.",
        "The line has no effect, which is hardly what it was written for.",
        "Remove the path, or the `ignore` that speaks against it.",
    ),
    Code(
        "SB307",
        "error",
        "parsed but not yet supported",
        "The sidecar asks for something that belongs to version 1 but that this stepbot cannot build.",
        "Leaving it out in silence would give another robot than the one described.",
        "Use a newer stepbot, or the substitute in the help.",
    ),
    Code(
        "SB308",
        "warning",
        "no collision shape",
        "A component is flat, or so thin that it has no hull with a volume.",
        "Engines refuse flat collision geometry, so the component has none and touches nothing.",
        "Say `collision: none` for it in `parts` to silence this, or give the link primitive shapes.",
    ),
)
