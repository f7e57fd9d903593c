"""SB6xx: meshes and tessellation, collisions between links, and packages for ROS 2."""

from .code import Code

CODES = (
    Code(
        "SB601",
        "warning",
        "defective mesh",
        "The mesher failed on some faces of a body, with all settings tried, or some edges of the mesh do not "
        "join exactly two faces. If the exact shape is valid, mass properties are computed from it and are "
        "correct; display and collision have the defect.",
        "Repair the faces in CAD: overlapping ones, and edges shared by more than two. Or accept the mesh.",
    ),
    Code(
        "SB602",
        "warning",
        "open solid",
        "Some edges of a solid belong to one face only. The solid does not enclose a volume, so its mass cannot be "
        "computed.",
        "Close the solid in CAD, or give its mass in the sidecar.",
    ),
    Code(
        "SB603",
        "warning",
        "mesh coarsened",
        "At the requested tolerance, the mesh of a body would exceed the number of faces that engines load in "
        "reasonable time. The mesh is coarser than requested. Mass properties are not affected: they are checked "
        "against the exact shape.",
        "Set a larger tolerance or angle under `mesh`, or simplify the body in CAD.",
    ),
    Code(
        "SB605",
        "warning",
        "volume integration does not converge",
        "The integration of the geometry kernel, that of stepbot, and a sequence of finer meshes differ by "
        "more than a thousandth. A face may intersect itself. Up to a tenth apart, the value of the exact "
        "solid is used; further apart, no robot is built (SB516).",
        "Repair the solid in CAD, ignore it, or give its link an `inertial` with com and inertia.",
    ),
    Code(
        "SB607",
        "warning",
        "self-intersecting solid",
        "The solid is closed, but its surface intersects itself: lobes overlap, or shells cross. Overlapping "
        "regions are counted twice or subtracted, so the mass properties are wrong.",
        "Repair the solid in CAD, or give its mass in the sidecar. Walls thinner than the mesh tolerance "
        "intersect in the mesh only; in this case use a finer `mesh`.",
    ),
    Code(
        "SB608",
        "warning",
        "collision setting without effect",
        "Parts have a `contact`, and their link lists its collision shapes; or a `collision` sets `max_hulls` "
        "for shapes that are not convex pieces, or `max_vertices` for shapes that are no hulls. The setting is "
        "ignored.",
        "Set `shape: auto` or `shape: decompose`, or remove the budget. Give the listed shapes a `contact`.",
    ),
    Code(
        "SB609",
        "note",
        "coarse collision geometry",
        "A link has as many convex pieces as `max_hulls` allows, and its solids fill less than 0.9 of them (0.95 with "
        "`decompose`). The shapes enclose the link, but reach into hollows: contacts may occur where the parts do not "
        "touch.",
        "Raise `max_hulls`, or accept the shapes. `report.json` has how far they reach beyond the solids.",
    ),
    Code(
        "SB610",
        "warning",
        "triangle budget exceeded",
        "The visual meshes have more triangles than `max_triangles` allows, or more bytes than `max_bytes`, and no "
        "simpler shapes were found: each "
        "part needs some. The meshes are as simple as possible, hardly resemble the parts, and still exceed the "
        "budget.",
        "Raise the budget, or hide small parts with `visual: false` under `parts`.",
    ),
    Code(
        "SB611",
        "note",
        "visual meshes simplified",
        "The visual meshes had more triangles than `max_triangles` allows, or their files more bytes than `max_bytes`. "
        "They deviate from the tessellation by the "
        "stated distance. Masses and collision geometry are not affected.",
        "Raise the budget if parts look too coarse. `report.json` has the number of triangles and the deviation "
        "of every budget.",
    ),
    Code(
        "SB620",
        "warning",
        "links always overlap",
        "The collision shapes of two links without a common joint penetrate each other in every sampled pose. "
        "Contacts of the pair are excluded, because a simulator would push the links apart without end, and a "
        "planner would find no path. That hides an overlap of the parts, or shapes larger than the parts.",
        "Choose a closer `collision` for one of the links: convex hulls fill concave regions. If the parts "
        "overlap, correct the CAD; if both links are one body, connect them with a fixed joint.",
    ),
    Code(
        "SB621",
        "note",
        "fewer poses than requested",
        "The robot has fewer poses in which self-collision can be searched: it cannot move, or its loops jam. What "
        "never happens in a few poses may happen in others.",
        "Check the limits of the joints in the loops, and that the loops can move (SB819).",
    ),
    Code(
        "SB640",
        "warning",
        "package without maintainer or licence",
        "The manifest of a ROS 2 package must state a maintainer and a licence, and the sidecar has none, or "
        "an address in a domain for examples such as example.com. `package.xml` has `unknown` instead: colcon "
        "builds the package, `rosdep` and release tools report it, and nobody may use it without asking.",
        "State both in the sidecar: `metadata: {maintainer: Ada Lovelace <ada@example.com>, license: "
        "Apache-2.0}`, with your own name and address. For a URDF, SDFormat or MJCF, or a sidecar that is not "
        "yours, use the options `--maintainer` and `--license`.",
    ),
    Code(
        "SB641",
        "note",
        "package without controllers",
        "The robot has no actuators, so its ROS 2 package has neither `<ros2_control>` nor `ros2_controllers.yaml`. RViz "
        "moves the joints by sliders and MoveIt plans, but nothing carries a motion out. In Gazebo the joints move "
        "freely.",
        "Add actuators to the sidecar: `actuators: {elbow_motor: {joint: elbow, kind: position, gains: auto}}`.",
    ),
    Code(
        "SB642",
        "note",
        "gripper found by its name",
        "The last joint of an arm, or the link that it moves, is named like a jaw, and its range is at most "
        "2.5 rad or m. In the SRDF it is an end effector with a group of its own, and MoveIt plans for the arm "
        "without this joint.",
        "If the joint is no jaw, rename it, or add it to the arm's group in the SRDF.",
    ),
    Code(
        "SB643",
        "warning",
        "no text of the licence",
        "MuJoCo Menagerie's checks ask for a file LICENSE in each folder. stepbot writes it for Apache-2.0, BSD-2-Clause, "
        "BSD-3-Clause and MIT, the licences that Menagerie recognizes; the texts of all but the first name the holder, "
        "which is the maintainer of the sidecar.",
        "State both in the sidecar: `metadata: {maintainer: Ada Lovelace <ada@example.com>, license: MIT}`, or use "
        "`--maintainer` and `--license`. Put the text of another licence into the folder as LICENSE.",
    ),
    Code(
        "SB644",
        "error",
        "program cannot use the robot",
        "A program of `--for` cannot use a robot of this form. LeRobot's kinematics is of one chain of joints that turn, "
        "with angles in degrees, so that it needs one.",
        "Convert without this program.",
    ),
)
