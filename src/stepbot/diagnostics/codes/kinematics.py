"""SB4xx: kinematics: tree, loops, axes, limits."""

from .code import Code

CODES = (
    Code(
        "SB401",
        "error",
        "no axis",
        "There is no line that carries the cylinders that the origin asks for.",
        "Without it stepbot does not know where the joint is.",
        "The notes list lines that nearly coincide: the CAD may have placed a part beside its seat. Correct the CAD, "
        "or write the origin with `axis_of`, `center`, `component` or numbers. `stepbot inspect --between A B` shows "
        "what two components share.",
    ),
    Code(
        "SB402",
        "error",
        "several axes",
        "Several lines fit, and none of them is at least twice as wide as the next.",
        "Bolt circles look like bearings: taking the wrong line would give a joint in the wrong place.",
        "Add `radius` or `near` to the origin; the help has one to paste for each line.",
    ),
    Code(
        "SB403",
        "error",
        "frames that wait for each other",
        "The origin of a joint is relative to a link whose own frame depends on that joint.",
        "None of them can be placed.",
        "Make one of the origins relative to the assembly or to a component.",
    ),
    Code(
        "SB404",
        "error",
        "component without extent",
        "The middle of a component is asked for that has no geometry.",
        "It has no bounding box, so no middle.",
        "Name a component that holds a body.",
    ),
    Code(
        "SB405",
        "error",
        "links that share no parts",
        "`auto` looks for the line that the parts of two links share, and one of the links has no parts.",
        "There is nothing to look at.",
        "Write the origin in another form.",
    ),
    Code(
        "SB406",
        "error",
        "coaxial faces without contact",
        "The two sides have cylinders on common lines, but on none of them is a shaft in a bore that fits, and no faces "
        "overlap or touch along the line.",
        "Parts of an arm that is drawn straight have many lines in common. A joint on such a line may lie in mid-air, and "
        "no engine notices, since every file says the same.",
        "Check which parts carry the axis: often the pin or the bearing belongs to another link. If one of the listed "
        "lines is meant, paste its origin; a line that the sidecar selects is taken whatever gap there is.",
    ),
    Code(
        "SB407",
        "warning",
        "axis on weak evidence",
        "The faces on the axis that was taken overlap or touch but do not fit, or a wider line carries faces that touch.",
        "The axis may be right, as where the CAD leaves out a bearing; it may also be a coincidence.",
        "Look at the axis in the joint table. If it is right, paste its origin, which selects it explicitly; else paste "
        "the origin of the line that is meant.",
    ),
    Code(
        "SB410",
        "error",
        "drawn pose outside the limits",
        "The position in which the CAD drew the joint, 0 or its `zero`, is not within its limits.",
        "The drawn pose is the initial pose of the robot: an engine would throw it back with force.",
        "Correct the limits, or say with `zero` which position the CAD drew.",
    ),
    Code(
        "SB411",
        "error",
        "closure does not close",
        "In the pose that the CAD drew, the two sides of a closure do not meet.",
        "The loop would spring apart or be torn together when the simulation starts.",
        "Check `zero` of the joints in the loop, and the origin of the closure.",
    ),
    Code(
        "SB412",
        "error",
        "not a tree",
        "The joints do not join all links to one root without going in circles, or joints mimic each other.",
        "No format can say it, and joints that follow each other have no position.",
        "Declare the joint that closes a loop under `closures`.",
    ),
    Code(
        "SB413",
        "error",
        "name used twice",
        "Two parts of the robot have the same name.",
        "A format could not tell them apart.",
        "Rename one of them in the sidecar.",
    ),
    Code(
        "SB414",
        "error",
        "number is not finite",
        "A pose, an axis, a mass or a size of the robot is infinite or not a number.",
        "No engine can load it.",
        "Check the numbers of the part of the sidecar that is named; if they are right, please report it.",
    ),
    Code(
        "SB415",
        "error",
        "pose or axis is not proper",
        "An axis is not of length 1, or a rotation is not a rotation.",
        "Engines would scale or skew what hangs on it.",
        "Check the axis in the sidecar; if it is right, please report it.",
    ),
    Code(
        "SB416",
        "error",
        "limits out of order",
        "A lower limit is not below the upper one, or a speed or an effort is negative.",
        "Engines take such a joint as free, as locked, or refuse the file.",
        "Exchange the limits. A joint that does not move is `fixed`.",
    ),
    Code(
        "SB417",
        "error",
        "reference to what is not there",
        "A joint, closure, frame, actuator or shape names something that the robot does not have.",
        "The written files could not be loaded.",
        "Correct the name in the sidecar; if it is right, please report it.",
    ),
    Code(
        "SB418",
        "error",
        "contact sensor that feels nothing",
        "A contact sensor is on a link that has no collision geometry.",
        "Nothing touches such a link in a simulation, and formats name the shapes that such a sensor watches.",
        "Give the link collision geometry, put the sensor on another link, or leave it out.",
    ),
    Code(
        "SB420",
        "warning",
        "robot larger than 20 m",
        "The robot, as drawn, is larger than 20 m.",
        "Few robots are; a length unit in the STEP that is not what the CAD meant makes everything 25 or 1000 times "
        "too large.",
        "Check the unit that the CAD exported. If the robot is that large, nothing needs to be done.",
    ),
)
