"""SB15x and SB16x: robots composed of modules."""

from .code import Code

CODES = (
    Code(
        "SB150",
        "error",
        "module cannot be read",
        "The file of a module is missing, a module names neither a file nor another module, or there are too many. "
        "Without it the composed robot would lack a part.",
        "Correct the path, which is relative to the sidecar, or set exactly one of `file` and `mirror_of`.",
    ),
    Code(
        "SB151",
        "error",
        "module contains itself",
        "A file names, directly or through other modules, itself as a module. The composed robot would be infinite.",
        "Remove one of the modules in the listed chain.",
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
        "SB153",
        "error",
        "module attached by a moving port",
        "The port that a module is attached by moves relative to its root link. A module hangs on its root link; "
        "turning its tree around would reverse joints, limits and mimics.",
        "Attach it by a link or frame that is fixed to its root link, or add a closure.",
    ),
    Code(
        "SB154",
        "error",
        "composed robot without a single root",
        "Several parts have no place, or parts are attached to each other in a circle. A robot is one tree.",
        "Give every part but one `at`, or make it the child of a joint.",
    ),
    Code(
        "SB155",
        "error",
        "duplicate name in a composed robot",
        "Two elements have the same name after their prefixes were added. Simulators and drivers find elements by "
        "name. stepbot never renames one of them unasked.",
        'Leave out `prefix: ""`, or choose another prefix.',
    ),
    Code(
        "SB156",
        "error",
        "part placed twice",
        "A module has both `at` and a joint, or two joints move the same part. A part has one place; a second "
        "connection closes a loop.",
        "Remove one of them, or move the joint to `closures`.",
    ),
    Code(
        "SB157",
        "error",
        "origin between modules cannot be found",
        "The origin needs both links in one assembly, or an element on a module is placed relative to the assembly. "
        "Each module has an assembly of its own.",
        "Leave out `origin` of a joint: its ports coincide. Place frames and sensors with `relative_to`.",
    ),
    Code(
        "SB158",
        "warning",
        "mirrored thread is left-handed",
        "A mirrored module has screw joints. The mirror image of a right-handed thread is left-handed. Bought spindles "
        "are right-handed.",
        "Describe the joint in the composing file, or ignore the warning if the thread is made left-handed.",
    ),
    Code(
        "SB159",
        "error",
        "nothing mirrors the module below",
        "A mirrored module would hang on a module that is neither the root nor mirrored itself. Its place is the "
        "mirror image of the other one's.",
        "Add a module with `mirror_of` for the one below, or give `at`.",
    ),
    Code(
        "SB160",
        "error",
        "unknown element of a module",
        "`home`, `without`, `flip` or `set` names an element that the file of the module does not have. An override "
        "that matches nothing is a misspelling.",
        "Choose one of the listed names; they are those of the module's own file, without prefix.",
    ),
    Code(
        "SB161",
        "error",
        "leader of a mimic left out",
        "`without` removes a joint that another joint mimics. The other joint would follow nothing.",
        "Leave out both joints.",
    ),
    Code(
        "SB162",
        "error",
        "variant cannot be applied",
        "A variant is unknown, is like itself, or leaves out an element that the sidecar does not have. The robot "
        "would not be the one that is meant.",
        "Choose one of the listed names.",
    ),
    Code(
        "SB163",
        "error",
        "impossible home position",
        "`home` moves a mimic, leaves the limits of a joint, or opens a loop. A simulation that starts there would "
        "jump.",
        "Give positions of driven joints within their limits; mimics and loops follow.",
    ),
    Code(
        "SB164",
        "error",
        "different integrators",
        "Modules state different integrators. A simulation has one.",
        "State one in the composing file: `simulation: {integrator: implicitfast}`.",
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
        "SB167",
        "warning",
        "name of a mirrored module contains a side",
        "Names in a mirrored module contain `left` or `right`. They keep their names, so that `right_arm_left_elbow` "
        "is a joint of the right arm.",
        "Name them without a side in the module's file; the prefix tells the sides apart.",
    ),
    Code(
        "SB168",
        "note",
        "mirrored module at another place",
        "A module with `mirror_of` and `at` is not at the mirror image of the other one's place. Its joints move as "
        "mirror images; of a robot whose sides are turned instead of mirrored, they do not.",
        "Leave out `at`: the place is found. Ignore the note if the robot is not symmetric.",
    ),
    Code(
        "SB169",
        "note",
        "parts are not their own mirror image",
        "A mirrored module has parts whose mirror image is another shape. Their meshes are written mirrored. Parts "
        "that are bought, such as servos, exist in one form only.",
        "Check whether the listed parts can be made mirrored.",
    ),
)
