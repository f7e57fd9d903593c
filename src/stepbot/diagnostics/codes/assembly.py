"""SB2xx: the STEP file."""

from .code import Code

CODES = (
    Code(
        "SB201",
        "error",
        "not a complete STEP file",
        "The file is empty or ends too early, does not start with `ISO-10303-21;`, or its schema does not "
        "describe mechanical products. Or it is a gzip or zip archive (`.stpZ`, `.step.gz`) that is damaged or "
        "encrypted, does not contain exactly one STEP file, or unpacks to more than 4 GiB or a hundred times "
        "its size.",
        "Export the assembly as STEP AP203, AP214 or AP242, or download or copy it again; unpack an archive first.",
    ),
    Code(
        "SB203",
        "error",
        "external file cannot be read",
        "The geometry of a part is in another file, which is missing, is outside the folder of the STEP file "
        "(absolute paths, `..`, URLs and links that lead out of it are not followed), is not a STEP file, or "
        "refers back to the first file. stepbot does not convert an incomplete assembly.",
        "Put the files of the parts beside the file of the assembly, as they were exported, or export the "
        'assembly as a single STEP file: CAD programs call the option "external references" or "one file per '
        'part".',
    ),
    Code(
        "SB205",
        "error",
        "no geometry in the STEP file",
        "The geometry kernel rejects the file or cannot build any shape from it, or the file contains products "
        "without solids, surfaces or meshes.",
        "Open the file in another CAD program, and export it again with geometry, as a B-rep (AP203, AP214 or AP242).",
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
        "doubtful text encoding",
        "Names in the file are neither ASCII nor UTF-8, and the file declares no encoding; or a code page is "
        "declared, but all names are valid UTF-8. The names may differ from those in the CAD program. Paths in "
        "the sidecar match, but are hard to read.",
        "Find the code page that decodes the names correctly, and declare it with `--encoding cp1251`, or "
        "`step_encoding: cp1251` in the sidecar; remove the declaration if UTF-8 is correct. The notes show "
        "the readings.",
    ),
    Code(
        "SB211",
        "warning",
        "density of the STEP file not used",
        "A density in the file is negative or not a number, its unit is not mass per volume, or the file gives "
        "several densities for one part. Any interpretation would be a guess. Files written by Open CASCADE "
        "are known to use the unit `g^3 cm^2`.",
        "Set the density in the sidecar, under `parts` or `defaults`.",
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
        "The placement of an occurrence contains shear or non-uniform scaling, so that its mass properties do "
        "not follow from the part's.",
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
        "contents without surfaces",
        "Components contain no body, or a part contains curves or points beside its solids or surfaces. They "
        "have no mesh and no mass. Empty components can be referenced as frames.",
        "No action is needed if they are so in CAD.",
    ),
    Code(
        "SB217",
        "note",
        "solid repaired",
        "The faces of a solid point inwards, or a void contains a further closed shell: their orientation was "
        "reversed, and the volume is what the shells enclose, counted as solid and void in turn. Or faces "
        "coincide within the file's precision without shared edges: they were sewn, which changed the volume "
        "by less than a thousandth. No face was moved.",
        "No action is needed. A newer export may write a correct solid.",
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
        "A statement violates the grammar of ISO 10303-21, two entities have the same number, or an entity "
        "that defines or places a shape refers to one that does not exist or has the wrong type. Readers skip "
        "what they cannot parse: a part is missing, open, or at the origin.",
        "Export or copy the file again. Typical causes are interrupted writes, failing disks, transfers in "
        "text mode, and manual edits.",
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
        "Volumes, areas or centroids that the CAD program stored in the file (AP214, AP242) differ from the "
        "geometry as read: by more than 0.1 % of a volume, 1 % of an area, or 0.1 % of the radius of gyration "
        "for a centroid. The export changed a shape, or the CAD program computed the value otherwise: on a "
        "coarse mesh, with hidden bodies, or as a centre of mass.",
        "Compare the part's volume in CAD with `stepbot inspect`, which lists each stored value beside the "
        "computed one.",
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
        "SB231",
        "note",
        "external file not needed",
        "The STEP file refers to another file for a part whose geometry it contains, or for which another file was "
        "read before. The other file was not read. The two may differ if one of them is older.",
        "No action is needed if `stepbot inspect` shows the part as it is in CAD.",
    ),
    Code(
        "SB233",
        "warning",
        "partly evaluated geometry",
        "The geometry kernel or stepbot failed on a property that geometry can be read without: axes, faces, "
        "area or mass properties of a body; materials, colours, mechanisms or validation properties of a file. "
        "Joints cannot bind to missing axes. A body with a mesh alone has the mass of its mesh, if that "
        "encloses a volume (otherwise SB507).",
        "Repair the named body in CAD and export again, or state in the sidecar what is missing.",
    ),
)
