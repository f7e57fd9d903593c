"""SB15x and SB16x: robots composed of modules."""

from .code import Code

CODES = (
    Code(
        "SB150",
        "error",
        "module cannot be read",
        "The file of a module is missing, a module names neither a file nor another module, a file contains "
        "itself through its modules, or there are too many.",
        "Correct the path, which is relative to the sidecar, set exactly one of `file` and `mirror_of`, or "
        "remove one of the modules in the listed chain.",
    ),
    Code(
        "SB152",
        "error",
        "unknown reference into a module",
        "No link, frame, joint or module has this name. References are paths: `arm/tool0` is what the file of module "
        "`arm` calls `tool0`, without prefix.",
        "Choose one of the listed names, or add a frame under `frames`.",
    ),
    Code(
        "SB154",
        "error",
        "modules cannot be joined",
        "A robot is one tree, in which each part has one place. The message names the conflict: a part without "
        "a place, or with two; parts attached in a circle, or by a port that moves relative to the root link "
        "of its module; a mirrored module on one that is neither the root nor mirrored; an origin that needs "
        "both links in one assembly; or modules with different integrators.",
        "Give every part but one `at`, or make it the child of a joint; attach it by a link or frame that is "
        "fixed to its root link; move joints that close a loop to `closures`. Between modules, leave out "
        "`origin`: the ports coincide; place frames and sensors with `relative_to`. State one integrator in "
        "the composing file.",
    ),
    Code(
        "SB158",
        "warning",
        "doubtful part of a mirrored module",
        "`thread`: the module has screw joints, and its mirror image a left-handed thread; bought spindles are "
        "right-handed. `side-name`: names in it contain `left` or `right` and stay as they are, so that "
        "`right_arm_left_elbow` is a joint of the right arm.",
        "Describe the joint in the composing file, and name elements without a side: the prefix tells the "
        "sides apart. Otherwise ignore the warning.",
        features="side-name thread",
    ),
    Code(
        "SB160",
        "error",
        "change of a module cannot be applied",
        "`home`, `without`, `flip`, `rename`, `set` or a variant names an element, key or variant that the file does not "
        "have; `without` removes the leader of a mimic; a variant is like itself; or `home` moves a mimic, "
        "leaves the limits of a joint, or opens a loop.",
        "Choose one of the listed names, which are those of the module's own file, without prefix. Leave out "
        "both joints of a mimic. Give `home` for driven joints within their limits; mimics and loops follow.",
    ),
    Code(
        "SB166",
        "warning",
        "part in two modules",
        "A module and what it is fixed to have equal parts at the same place. An adapter or tool changer that is drawn "
        "in both files is there twice, with its mass.",
        "Leave the part out of one of the files, or ignore the warning if there are two.",
    ),
    Code(
        "SB168",
        "note",
        "mirrored module is not a mirror image",
        "`place`: its `at` is not the mirror image of the other module's place. `shape`: parts of it have a "
        "mirror image of another shape, which is written as a mesh; a bought part, such as a servo, exists in "
        "one form only.",
        "Leave out `at`: the place is found. Check whether the listed parts can be made mirrored.",
        features="place shape",
    ),
)
