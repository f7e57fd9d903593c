"""SB2xx: the STEP file."""

from .code import Code

CODES = (
    Code(
        "SB201",
        "error",
        "not a complete STEP file",
        "The file is empty or ends too early, does not start with `ISO-10303-21;`, or its schema does not describe "
        "mechanical products, such as that of a building. stepbot reads the exchange structure of ISO 10303-21. The "
        "missing end of a file may contain any part, or the assembly structure.",
        "Export the assembly as STEP AP203, AP214 or AP242, or download or copy it again. Check the available disk "
        "space.",
    ),
    Code(
        "SB203",
        "error",
        "missing external file",
        "The geometry of a part is in another file, which is missing, is not in the folder of the STEP file or below "
        "it, or is not a STEP file. Absolute paths, `..`, URLs and links that lead out of the folder are not followed. "
        "Missing parts would make every mass property wrong. stepbot does not convert an incomplete assembly.",
        "Put the files of the parts beside the file of the assembly, as they were exported. Or export the assembly as "
        'a single STEP file: CAD programs call the option "external references" or "one file per part".',
    ),
    Code(
        "SB205",
        "error",
        "unreadable STEP file",
        "The geometry kernel rejects the file or cannot build any shape from it. There is nothing to convert.",
        "Open the file in another CAD program, and export it again as AP214 or AP242.",
    ),
    Code(
        "SB206",
        "error",
        "no geometry",
        "The file contains products, but no solids, surfaces or meshes. Without geometry there are no meshes and no "
        "mass properties.",
        "Export the assembly with geometry, as B-rep (AP203, AP214 or AP242).",
    ),
    Code(
        "SB207",
        "error",
        "missing length unit",
        "The file, or a shape in it, does not declare a length unit. A wrong guess of millimetres for metres changes "
        "the mass by a factor of a billion.",
        "Export with a CAD program that writes the unit, or add a LENGTH_UNIT to the geometric context of the file.",
    ),
    Code(
        "SB209",
        "warning",
        "unit size contradicts its name",
        "A length unit has a standard name but a different size than that name stands for. stepbot uses the declared "
        "size. If the name is correct, every length is wrong.",
        "Compare a known dimension with the output of `stepbot inspect`. Export again with the correct unit if they "
        "differ.",
    ),
    Code(
        "SB210",
        "warning",
        "unknown text encoding",
        "Names in the file contain bytes that are neither ASCII nor UTF-8, and the file does not declare an encoding. "
        "The names may differ from those in the CAD program. Paths in the sidecar still match, but are hard to read.",
        "Find the code page that decodes the names correctly, and declare it with `--encoding cp1251`, or with "
        "`step_encoding: cp1251` in the sidecar. Alternatively, export with UTF-8 names or `\\X2\\` escapes.",
    ),
    Code(
        "SB211",
        "warning",
        "invalid density",
        "A density in the file is negative or not a number, or its unit is not mass per volume. The density is "
        "ignored, because any interpretation would be a guess. Files written by Open CASCADE are known to use the unit "
        "`g^3 cm^2`.",
        "Set the density in the sidecar, under `parts` or `defaults`.",
    ),
    Code(
        "SB212",
        "warning",
        "conflicting densities",
        "The file gives several different densities for one part. The file does not define which of them applies, so "
        "all are ignored.",
        "Set the density in the sidecar, under `parts`.",
    ),
    Code(
        "SB213",
        "warning",
        "geometry kernel failed on a body",
        "The geometry kernel crashed or failed on one body of the assembly. The other bodies were read. The body has "
        "no mesh, no axes and no mass. A robot with it is not built (SB507).",
        "Repair or delete the body in CAD, and export again. Otherwise ignore it in `parts`, or give its link an "
        "`inertial`.",
    ),
    Code(
        "SB214",
        "error",
        "placement is not a rigid transform",
        "The placement of an occurrence contains shear or non-uniform scaling. The mass properties of a sheared or "
        "non-uniformly scaled part cannot be derived from its definition.",
        "In CAD, replace the occurrence by a separate part with the actual shape, and export again.",
    ),
    Code(
        "SB215",
        "error",
        "too many components",
        "The expanded assembly tree exceeds the limit on the number of components. Nested subassemblies multiply, and "
        "can exceed any amount of memory.",
        "Export a smaller assembly. Robots have thousands of components, not millions.",
    ),
    Code(
        "SB216",
        "note",
        "components without geometry",
        "Components of the assembly contain no body, neither directly nor in their children. They can be referenced as "
        "frames, but have no mesh and no mass.",
        "No action is needed if they are empty in CAD, too.",
    ),
    Code(
        "SB217",
        "note",
        "faces reoriented",
        "The faces of a solid point inwards, which makes its volume negative, or a void of a solid contains a further "
        "closed shell. The orientation of these faces was reversed: a shell inside a void is solid. The shape is "
        "unchanged. The volume is what the shells enclose, counted as solid and void in turn.",
        "No action is needed. A newer export may write the correct orientation.",
    ),
    Code(
        "SB218",
        "note",
        "curves ignored",
        "A part contains curves or points in addition to its solids or surfaces. Curves and points have no faces and "
        "no volume, so they have no mesh and no mass.",
        "No action is needed.",
    ),
    Code(
        "SB220",
        "warning",
        "solids not read",
        "The file defines more solids than were read for its products. Solids that belong to no product are ignored by "
        "every program. A solid that the kernel failed to build is missing from the robot.",
        "Compare the number of solids in `stepbot inspect` with the CAD program. Export the missing ones again.",
    ),
    Code(
        "SB221",
        "error",
        "damaged STEP file",
        "A statement violates the grammar of ISO 10303-21, two entities have the same number, or an entity that "
        "defines or places a shape refers to one that does not exist or has the wrong type. Readers skip what they "
        "cannot parse: a part is missing, open, or placed at the origin, and mass properties are wrong.",
        "Export or copy the file again. Typical causes are interrupted writes, failing disks, transfers in text mode, "
        "and manual edits.",
    ),
    Code(
        "SB223",
        "warning",
        "dangling reference outside geometry",
        "A style, note, property or other non-geometric entity refers to a missing entity, or a shape contains an item "
        "that the geometry kernel does not support. Colours, names, materials, densities or a body of an unusual type "
        "may be missing.",
        "Compare `stepbot inspect` with the CAD program. Export as AP214 if something is missing.",
    ),
    Code(
        "SB226",
        "warning",
        "validation property mismatch",
        "The CAD program stored volumes, areas or centroids as geometric validation properties (AP214, AP242), and the "
        "geometry as read differs: by more than 0.1 % of a volume, 1 % of an area, or 0.1 % of the radius of gyration "
        "for a centroid. Either the export lost or changed a shape, or the CAD program computed the value differently: "
        "on a coarse mesh, with hidden bodies, or as a centre of mass.",
        "Compare the part's volume in CAD with `stepbot inspect`, which lists each stored value beside the computed "
        "one.",
    ),
    Code(
        "SB227",
        "note",
        "validation properties not compared",
        "Some stored volumes, areas or centroids cannot be compared. Their unit is missing or has the wrong dimension, "
        "they do not refer to a part, or they refer to a triangle mesh, which has no exact volume. The other "
        "validation properties of the file were compared.",
        "No action is needed.",
    ),
    Code(
        "SB228",
        "note",
        "solid sewn",
        "Faces of a solid coincide within the file's precision, but do not share edges. They were sewn together. No "
        "face was moved, and the volume changed by less than a thousandth.",
        "No action is needed. A newer export may write a closed solid.",
    ),
    Code(
        "SB224",
        "error",
        "names not valid in the declared encoding",
        "The names in the file contain bytes that are not defined in the code page given by `--encoding` or "
        "`step_encoding`. Decoding names with the wrong code page changes them, and paths in the sidecar no longer "
        "match.",
        "Declare the code page of the computer that wrote the file. The notes show the names decoded with likely code "
        "pages. UTF-8 needs no declaration.",
    ),
    Code(
        "SB225",
        "warning",
        "declared encoding looks wrong",
        "A code page is declared, but all names are valid UTF-8, which is unlikely for text in a code page. If the "
        "file is encoded in UTF-8, the decoded names differ from those in the CAD program.",
        "Compare the two readings in the notes. Remove `--encoding` or `step_encoding` if UTF-8 is correct.",
    ),
    Code(
        "SB229",
        "error",
        "circular external reference",
        "The files of an assembly refer to each other in a cycle. No part can contain itself.",
        "Export the assembly as a single STEP file, or correct the name of the file in the reference.",
    ),
    Code(
        "SB231",
        "note",
        "external file not needed",
        "The STEP file refers to another file for a part whose geometry it contains, or for which another file was "
        "read before. The other file was not read. The two may differ if one of them is older.",
        "No action is needed if `stepbot inspect` shows the part as it is in CAD.",
    ),
    Code(
        "SB232",
        "error",
        "unreadable compressed file",
        "The gzip or zip archive is damaged or encrypted, contains no STEP file or several, or its content is larger "
        "than 4 GiB or more than a hundred times as large as the archive. stepbot reads archives of one STEP file, as "
        "CAD programs write them (`.stpZ`, `.step.gz`). The limits keep a small archive from filling the disk.",
        "Unpack the archive and pass the STEP file to stepbot.",
    ),
    Code(
        "SB233",
        "warning",
        "partly evaluated geometry",
        "The geometry kernel or stepbot failed on a property that geometry can be read without: axes, faces, area or "
        "mass properties of a body; materials, colors, mechanisms or validation properties of a file. Joints cannot "
        "bind to axes that are missing. A body with a mesh alone has the mass of its mesh, if that encloses a volume "
        "(otherwise SB507), which no second method confirmed.",
        "Repair the named body in CAD and export again, or state in the sidecar what is missing.",
    ),
)
