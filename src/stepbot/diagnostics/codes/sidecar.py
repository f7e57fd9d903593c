"""SB1xx: YAML, schema and references of the sidecar; SB15x and SB16x: robots composed of modules."""

from .code import Code

CODES = (
    Code(
        "SB102",
        "error",
        "sidecar cannot be read",
        "The file is empty, too large for a sidecar, not UTF-8 text, or not a single YAML mapping that starts "
        "with `version: 1`.",
        "Check that the path names the sidecar and not the STEP file, and that the editor saved it, as UTF-8. "
        "Write `key: value` lines without indentation and without `---` separators; shorten long lists of "
        "parts with a glob, or with `rest: true`. `stepbot docs sidecar` starts with a minimal example.",
    ),
    Code(
        "SB104",
        "error",
        "invalid YAML syntax",
        "The text is not valid YAML at this position. Typical causes are an unclosed bracket or quote, "
        "inconsistent indentation, a tab, an unquoted colon, and a path that starts with `*`, as an alias "
        "does. stepbot skips the enclosing top-level section and checks the rest.",
        'Check the marked position and the line above it. Indent with two spaces. Quote paths (`"**/M3x8*"`), '
        "and text that contains `: ` or ` #` or starts with one of `{}[]&*!|>%@`.",
    ),
    Code(
        "SB107",
        "error",
        "duplicate key",
        "The same key is defined twice in one mapping. Only one of the values can apply. Most YAML parsers silently "
        "keep the last one.",
        "Remove or rename one of the keys. The message gives the position of both.",
    ),
    Code(
        "SB110",
        "error",
        "YAML that a sidecar may not contain",
        "A sidecar is limited to plain YAML 1.2 data, so that every parser reads the same values: no tags such "
        "as `!include`, no directives, no lists or mappings as keys, no merge key of something other than "
        "mappings, no missing value, and no deep nesting or alias expansion. An unquoted `#`, as of a colour, "
        "begins a comment.",
        "Write the value directly, and quote it if it is text. Write `{}` for an empty mapping. Merge an "
        "anchor on a mapping: `<<: *motor`.",
    ),
    Code(
        "SB120",
        "error",
        "unknown key",
        "The sidecar schema does not define this key at this position. If stepbot ignored a misspelled key, the robot "
        "would be silently wrong.",
        "Use the suggestion in the help, or look up the key in `stepbot docs sidecar`. Editors complete and check keys "
        "when they use the output of `stepbot schema`.",
    ),
    Code(
        "SB121",
        "error",
        "missing key",
        "A required key is missing. stepbot does not assume a default for this key.",
        "Add the key. `stepbot docs sidecar` describes it.",
    ),
    Code(
        "SB122",
        "error",
        "wrong type",
        "The value has the wrong type, such as a number in place of a name, or a string in place of a list. YAML "
        "derives the type from the notation: `parent: 7` is a number, and `rest: yes` is a string.",
        "Write the value in the form given in the message.",
    ),
    Code(
        "SB123",
        "error",
        "invalid choice",
        "The value is not one of the choices of this key. stepbot does not guess the intended choice.",
        "Use one of the choices listed in the message or its help.",
    ),
    Code(
        "SB124",
        "error",
        "invalid quantity",
        "The value is not a number with a unit, the unit is unknown, or the unit has the wrong dimension. A mass in mm "
        "or a length in deg is an error, and an unknown unit could change the value by any factor.",
        "Write a number in SI units, or a number with its unit as shown in the help. `stepbot docs sidecar` lists the "
        "units.",
    ),
    Code(
        "SB125",
        "error",
        "number out of range",
        "The number is NaN, infinite, negative or zero where this is not physically possible. Engines accept such "
        "numbers and compute meaningless results.",
        "Correct the number. To exclude a component from the robot, use `ignore: true`.",
    ),
    Code(
        "SB126",
        "error",
        "invalid name",
        "The name is empty or too long, contains characters that an output format does not support, that are "
        "invisible or that change the direction of text, is reserved by a format, or, for a robot, is a device "
        "name on Windows. Names are the same in the sidecar, in every output file and in client code: stepbot "
        "never renames silently.",
        "Use letters, digits, `_`, `-` and `.`. SDFormat reserves `world`, `::` and names such as `__x__`; the "
        "sidecar reserves `assembly`; Windows reserves `CON`, `NUL`, `AUX`, `PRN`, `COM1` and `LPT1`.",
    ),
    Code(
        "SB127",
        "error",
        "unsupported sidecar version",
        "This version of stepbot does not support the `version` of the sidecar. Keys may have a different meaning in "
        "another version.",
        "Write `version: 1`, or upgrade stepbot.",
    ),
    Code(
        "SB128",
        "error",
        "invalid origin",
        "An origin mixes the keys of two forms, or uses a form that is not valid here: `auto` searches for an "
        "axis shared by two links. Or `up` and `forward` of `root` are along the same axis of the assembly.",
        "Keep one of `xyz`, `component`, `center`, `axis_of`, `mate`, `auto`; frames, sensors and the root "
        "belong to a single link and accept every form except `auto`. Choose `forward` among the two axes that "
        "are not `up`, or omit it.",
    ),
    Code(
        "SB129",
        "warning",
        "name that not every reader takes",
        "A name has a space, a letter beyond a to z, or a digit at its beginning (of a robot: a space or such a letter). Formats allow it, and "
        "stepbot writes it; ROS refuses it in topics and parameters, xacro evaluates parts of it, and shells "
        "and simulators split it.",
        "Rename it as the message proposes; the rule is the same for all formats. For one reader alone, ignore "
        "the finding.",
    ),
    Code(
        "SB130",
        "error",
        "unknown name",
        "A link, joint or material is referenced that the sidecar does not define.",
        "Correct the name, or add the element. The help lists similar names.",
        features="joint link material",
    ),
    Code(
        "SB133",
        "warning",
        "unmatched joint pattern",
        "A pattern in `joint_defaults` does not match any joint name. Its limits and dynamics have no effect. A joint "
        "may have been renamed.",
        "Correct or remove the pattern. Patterns are case-sensitive; `*` matches any sequence of characters.",
    ),
    Code(
        "SB134",
        "error",
        "multiple links with `rest: true`",
        "More than one link has `rest: true`. A component that is not listed explicitly can belong to one link only.",
        "Keep `rest: true` on one link, and list the parts of the others.",
    ),
    Code(
        "SB135",
        "error",
        "duplicate name",
        "Two links, joints, closures or frames have the same name, in a composed robot after their prefixes "
        "were added. SDFormat has one namespace for all of them, URDF represents frames as links, and "
        "Pinocchio represents links and joints as frames.",
        "Rename one of them: the link `elbow`, the joint `elbow_joint`. In a composed robot, leave out "
        '`prefix: ""` or choose another prefix.',
    ),
    Code(
        "SB136",
        "error",
        "invalid sensor mount",
        "A sensor has neither `link` nor `joint`, has both, or has one that its type does not support. The position of "
        "the sensor is undefined.",
        "Set `link`. Sensors of type `joint` require `joint`, and `force_torque` sensors accept it.",
    ),
    Code(
        "SB137",
        "error",
        "key not valid for this type",
        "A key is not valid for this type of joint, closure, actuator or sensor, or needs another key. The key would have "
        "no effect.",
        "Remove the key, or choose a type that supports it.",
    ),
    Code(
        "SB138",
        "error",
        "unit does not match joint type",
        "An angular unit is used for a prismatic joint, or a unit of length for a rotating joint. The value would be "
        "interpreted as radians for a prismatic joint, or as metres for a rotating joint.",
        "Use a unit that matches the joint type. If a default applies to rotating and prismatic joints, set the value "
        "on each joint or split the pattern.",
    ),
    Code(
        "SB139",
        "warning",
        "implausible value without a unit",
        "A number without a unit is interpreted in SI units, and is far outside the usual range: 90 rad, 150 m, 1.2 "
        "kg/m^3. If degrees, millimetres or g/cm^3 were intended, the value is wrong by a factor of 57 or 1000.",
        "Write the unit: `90 deg`, `150 mm`, `1.2 g/cm^3`. If the value is correct, write its SI unit to suppress the "
        "warning.",
    ),
    Code(
        "SB140",
        "note",
        "torque in units of mass times length",
        "A torque in kg.cm, g.cm, oz-in or lb-in, as in servo data sheets, is read as kgf*cm, gf*cm, ozf*in or "
        "lbf*in: 1 kgf*cm is 0.0980665 N*m.",
        "Write the unit with the force, as shown in the help, or convert the torque to N*m.",
    ),
    Code(
        "SB141",
        "error",
        "diagnostic cannot be ignored",
        "`ignore_findings` or `--ignore` names a code that does not exist or that is an error. An error means that "
        "files would be wrong or missing. Errors cannot be suppressed.",
        "Use codes of warnings and notes, as listed by `stepbot explain`.",
    ),
    Code(
        "SB142",
        "note",
        "unused ignore",
        "`ignore_findings` or `--ignore` names a code that was not reported at this place or anywhere. The cause may "
        "have been corrected since. An unused rule would hide the next diagnostic with this code.",
        "Remove the entry. A diagnostic that summarizes several places can only be ignored by an entry at the top "
        "level of the sidecar.",
    ),
    Code(
        "SB145",
        "warning",
        "actuator limit beyond the limit of its joint",
        "A limit of an actuator is wider than that of the joint that it drives. The limit of the joint applies.",
        "Raise the limit of the joint if the motor has more, or remove the actuator's: it is meant to narrow "
        "the joint's.",
    ),
    Code(
        "SB146",
        "warning",
        "excluded pair of links without effect",
        "A pair in `excluded_contacts` is one link twice, is listed twice, or is of links that a joint or a closure "
        "connects, directly or through fixed joints. It changes nothing: contacts between these are excluded in any "
        "case.",
        "Remove the pair, or correct its names.",
    ),
    Code(
        "SB147",
        "error",
        "unknown or ambiguous motor",
        "An actuator names a motor that neither the catalogue nor `motors` has, or a family of motors. The figures of "
        "a similar motor may differ by a factor of ten, and members of a family by a factor of two.",
        "Choose a name of the help, or one that `stepbot motors` lists. Describe another motor under `motors`, with "
        "the source of each figure.",
    ),
    Code(
        "SB148",
        "error",
        "motor does not suit its joint",
        "A motor that turns is on a joint that slides and has no `gear`, a linear drive is on a joint that turns, or "
        "no source gives the supply that the figures hold at. Torque and speed of the joint cannot be computed.",
        "Give `gear`, in rad/m where the joint slides, remove `voltage`, or choose another motor.",
    ),
    Code(
        "SB149",
        "note",
        "doubtful figures of a motor",
        "Sources disagree on a figure of a motor that is used, a figure fails a check of the catalogue, or no source "
        "gives it. Effort, speed, inertia or friction of the joint may be wrong.",
        "Read the sources with `stepbot motors NAME`. Measure the figure, and set it in `limits` or `dynamics` of the "
        "joint.",
    ),
    Code(
        "SB150",
        "error",
        "module cannot be read",
        "The file of a module is missing, a module names neither a file nor another module, a file contains "
        "itself through its modules, or there are too many. Or a command shows one STEP, and the sidecar has modules alone.",
        "Correct the path, which is relative to the sidecar, set exactly one of `file` and `mirror_of`, "
        "remove one of the modules in the listed chain, or run a listed command.",
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
