"""SB0xx: files, environment, missing extras."""

from .code import Code

CODES = (
    Code(
        "SB001",
        "error",
        "file not found",
        "A named file does not exist or cannot be read.",
        "stepbot needs every input file to convert a robot.",
        "Correct the path. The `step` path of a sidecar is relative to the sidecar's folder.",
        could_not_run=True,
    ),
    Code(
        "SB002",
        "error",
        "system library missing",
        "The geometry kernel failed to load because a shared system library is missing.",
        "The kernel's wheel links to libGL, libX11 and libexpat, although stepbot never opens a window.",
        "On Debian or Ubuntu, run `apt-get install libgl1 libx11-6 libexpat1`.",
        could_not_run=True,
    ),
    Code(
        "SB003",
        "error",
        "Python package missing",
        "The command needs a Python package that is not installed.",
        "The command cannot do its work without the package.",
        "Install the extra named in the message.",
        could_not_run=True,
    ),
    Code(
        "SB004",
        "error",
        "output not writable",
        "The output folder, or a file in it, cannot be written.",
        "Nothing was changed: stepbot writes all files or none.",
        "Choose another folder with `-o`, or grant write permission.",
        could_not_run=True,
    ),
    Code(
        "SB005",
        "error",
        "required engine not available",
        "`--require` names an engine that is not installed or fails to start.",
        "A check that did not run does not count as passed.",
        "Install the engine, or remove the requirement.",
        could_not_run=True,
    ),
    Code(
        "SB006",
        "note",
        "cache not writable",
        "Results could not be stored in the cache folder.",
        "The results are correct, but the next run has to compute them again.",
        "Make the folder writable or free some disk space. `--cache DIR` selects another folder; `--no-cache` "
        "disables the cache.",
    ),
    Code(
        "SB007",
        "error",
        "output out of date",
        "A file in the output folder differs from what stepbot would write now, or the folder is missing. The proof "
        "section of `report.json` is excluded from the comparison because it depends on the installed engines.",
        "The files describe a different robot than the sidecar and the STEP file. Either the output was edited by "
        "hand, or the sidecar, the STEP file or stepbot has changed since.",
        "Convert again and commit the result. Move manual edits into the sidecar.",
    ),
    Code(
        "SB008",
        "error",
        "output folder collision",
        "Two sidecars of a batch would be written to the same folder.",
        "The files of one robot would overwrite those of the other.",
        "Rename one of the sidecars, or the folder that contains it.",
        could_not_run=True,
    ),
    Code(
        "SB009",
        "error",
        "cluster unavailable",
        "The scheduler given by `--scheduler` does not respond, or one of its workers runs a different version of "
        "stepbot.",
        "Robots cannot be converted on this cluster, or the files could differ between workers.",
        "Start the scheduler with `dask scheduler` and the workers with `dask worker tcp://host:8786`. Install the "
        "same version of stepbot on every machine.",
        could_not_run=True,
    ),
    Code(
        "SB010",
        "error",
        "invalid usage",
        "The command line has an unknown command or option, a missing argument, or an invalid option value.",
        "Nothing was done. With `--json`, the error is reported as JSON.",
        "Run `stepbot COMMAND --help` for the arguments and options, with an example.",
        could_not_run=True,
    ),
    Code(
        "SB011",
        "note",
        "output folder not lockable",
        "The file system of the output folder does not support file locks. Some network file systems do not.",
        "Concurrent conversions into this folder do not wait for each other, and the list of written files may become "
        "incomplete. A later run would then leave outdated meshes behind.",
        "Run one conversion per folder at a time, or give each robot its own folder with `-o`.",
    ),
    Code(
        "SB012",
        "error",
        "sidecar already exists",
        "`stepbot init` would overwrite an existing sidecar.",
        "A sidecar contains manual decisions that cannot be recovered. `init` overwrites a file only with `--force`.",
        "Choose another file with `-o`, or overwrite this one with `--force`.",
    ),
)
