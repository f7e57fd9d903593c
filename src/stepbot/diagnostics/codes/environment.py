"""SB0xx: files, environment, missing extras; SB9xx: internal errors."""

from .code import Code

CODES = (
    Code(
        "SB001",
        "error",
        "file not found",
        "A named file does not exist or cannot be read. stepbot needs every input file to convert a robot.",
        "Correct the path. If it is the `step` of a sidecar, it is relative to the sidecar's folder.",
        could_not_run=True,
    ),
    Code(
        "SB002",
        "error",
        "system library missing",
        "The geometry kernel failed to load: its wheel links to libGL, libX11 and libexpat, and one of them is "
        "missing. stepbot opens no window.",
        "On Debian or Ubuntu, run `apt-get install libgl1 libx11-6 libexpat1`. `stepbot doctor` shows what is missing.",
        could_not_run=True,
    ),
    Code(
        "SB003",
        "error",
        "Python package missing",
        "The command needs a Python package that is not installed.",
        "Install the extra that the message names; `stepbot doctor` shows what is installed, and the command "
        "for the rest.",
        could_not_run=True,
    ),
    Code(
        "SB004",
        "error",
        "output not writable",
        "The output folder, or a file in it, cannot be written, or a file that stepbot has not written is in the way. "
        "Nothing was changed: stepbot writes all files or none, and replaces its own files alone.",
        "Grant write permission, move the file away, or choose another folder, with `-o` where the command has it.",
        could_not_run=True,
    ),
    Code(
        "SB005",
        "error",
        "required engine not available",
        "`--require`, or `--engine` of `stepbot drive`, names an engine that is not installed or fails to start; or no "
        "engine is installed that drives the files. A check that did not run does not count as passed.",
        "Install the engine, or remove the requirement; `stepbot doctor` shows which work here, and the command for "
        "the rest.",
        could_not_run=True,
    ),
    Code(
        "SB006",
        "note",
        "cache not writable",
        "Results could not be stored in the cache folder. The results are correct, but the next run has to compute "
        "them again.",
        "Make the folder writable or free some disk space. `--cache DIR` selects another folder; `--no-cache` disables "
        "the cache.",
    ),
    Code(
        "SB007",
        "error",
        "output out of date",
        "A file in the output folder differs from what stepbot would write now, or the folder is missing: the "
        "output was edited by hand, or the sidecar, the STEP file or stepbot has changed since. The proof "
        "section of `report.json` is not compared, because it depends on the installed engines.",
        "Convert again and commit the result. Move manual edits into the sidecar.",
    ),
    Code(
        "SB008",
        "error",
        "output folder collision",
        "Two sidecars of a batch would be written to the same folder. The files of one robot would overwrite those of "
        "the other.",
        "Rename one of the sidecars, or the folder that contains it.",
        could_not_run=True,
    ),
    Code(
        "SB009",
        "error",
        "cluster unavailable",
        "The scheduler given by `--scheduler` does not respond, or one of its workers runs a different version of "
        "stepbot. Robots cannot be converted on this cluster, or the files could differ between workers.",
        "Start the scheduler with `dask scheduler` and the workers with `dask worker tcp://host:8786`. Install the "
        "same version of stepbot on every machine.",
        could_not_run=True,
    ),
    Code(
        "SB010",
        "error",
        "invalid usage",
        "The command line has an unknown command or option, a missing argument, or an invalid option value. Nothing "
        "was done. With `--json`, the error is reported as JSON.",
        "Run `stepbot COMMAND --help` for the arguments and options, with an example.",
        could_not_run=True,
    ),
    Code(
        "SB011",
        "note",
        "output folder not lockable",
        "The file system of the output folder does not support file locks, as some network file systems. "
        "Concurrent conversions into this folder do not wait for each other, and a later run may leave "
        "outdated meshes behind.",
        "Run one conversion per folder at a time, or give each robot its own folder with `-o`.",
    ),
    Code(
        "SB012",
        "error",
        "file would be overwritten",
        "`stepbot init` would overwrite a sidecar, whose manual decisions cannot be recovered, or a conversion "
        "would overwrite the description that it converts, or a mesh of it. Nothing is written.",
        "Choose another file or folder with `-o`. `init --force` overwrites the sidecar.",
    ),
    Code(
        "SB013",
        "error",
        "unusable lock file",
        "The lock file beside the sidecar is not JSON, a value in it is missing or of a wrong type, or a newer "
        "stepbot wrote it; unresolved merge conflicts are a typical cause. Without it, changes of the CAD "
        "cannot be detected.",
        "Restore it from version control, or upgrade stepbot. If the current STEP file is correct, replace it "
        "with `stepbot lock`.",
    ),
    Code(
        "SB015",
        "warning",
        "lock file of another robot",
        "The lock file beside the sidecar was made for a robot of another name. It is ignored. Nothing is compared "
        "with the earlier revision of the CAD.",
        "Replace the lock file with `stepbot lock`, also if the robot was renamed, or delete it.",
    ),
    Code(
        "SB016",
        "note",
        "lock file missing or outdated",
        "`stepbot check --fix` was called for a sidecar without a lock file, or the sidecar has joints or "
        "component paths that are not in it. Their changes cannot be detected.",
        "Run `stepbot lock` while the sidecar and the STEP file agree, and put the lock file under version "
        "control with the sidecar.",
    ),
    Code(
        "SB018",
        "error",
        "paths cannot be rewritten",
        "`stepbot check --fix` found renamed components, but replacing their paths would change other values of the "
        "sidecar. A path that spans several lines, or a new path that another rule already uses, is the cause. The "
        "sidecar was not changed.",
        "Replace the paths by hand, as listed in the help.",
    ),
    Code(
        "SB019",
        "error",
        "port not available",
        "`stepbot view` could not use the port that `--port` names: another program uses it, or the system does not "
        "allow it. The page could not be served.",
        "Leave out `--port` to use any free port, or name another one above 1023.",
        could_not_run=True,
    ),
    Code(
        "SB020",
        "error",
        "nothing to draw",
        "No link of the robot has a visual, or no component of the STEP file has a surface. The picture would be "
        "empty; it was not written.",
        "Look at the contents of the STEP file with `stepbot inspect`. In the sidecar, `visual: false` hides links and "
        "parts.",
    ),
    Code(
        "SB022",
        "warning",
        "report of another robot replaced",
        "The output folder has the files of another robot, and its `report.json`, which `stepbot drive` and "
        "`stepbot.close_loops` read, was replaced.",
        "Convert each robot into a folder of its own.",
    ),
    Code(
        "SB023",
        "note",
        "files of an earlier conversion kept",
        "The output folder has files of the robot in formats that this conversion does not write. "
        "`report.json` is about the new ones alone; the others are of another state if the input has changed "
        "since.",
        "Convert to all formats that are needed in one run, or remove the files.",
    ),
    Code(
        "SB901",
        "error",
        "internal error",
        "stepbot reached a state that earlier checks should have prevented. The result would not be reliable, so none "
        "is written.",
        "Please report a bug with the sidecar and the STEP file, or a minimal part of them that reproduces the error.",
        could_not_run=True,
    ),
    Code(
        "SB902",
        "error",
        "worker process failed",
        "A worker process crashed, was killed, or exceeded its memory or time limit. The geometry kernel and "
        "some engines crash on some input, so stepbot runs them in separate processes.",
        "The notes contain the signal and the last lines of output. Try the file in another CAD program. Raise "
        "`--timeout` or `--memory-limit` if a limit was exceeded.",
        could_not_run=True,
    ),
)
