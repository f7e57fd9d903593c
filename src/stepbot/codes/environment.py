"""SB0xx: files, environment, missing extras."""

from ._code import Code

CODES = (
    Code(
        "SB001",
        "error",
        "file not found",
        "A file that was named does not exist or cannot be read.",
        "Without it there is nothing to convert.",
        "Correct the path. A sidecar's `step` is relative to the sidecar itself.",
        could_not_run=True,
    ),
    Code(
        "SB002",
        "error",
        "system library missing",
        "The geometry kernel could not be loaded because a shared library of the system is missing.",
        "The kernel's wheel links to libGL, libX11 and libexpat, even though stepbot never opens a window.",
        "On Debian or Ubuntu: `apt-get install libgl1 libx11-6 libexpat1`.",
        could_not_run=True,
    ),
    Code(
        "SB003",
        "error",
        "package missing",
        "A Python package that this command needs is not installed.",
        "The command cannot do what it was asked to do, and will not pretend that it did.",
        "Install the extra that the message names.",
        could_not_run=True,
    ),
    Code(
        "SB004",
        "error",
        "output cannot be written",
        "The output folder, or a file in it, cannot be written.",
        "Nothing was changed: stepbot writes all files or none.",
        "Choose another folder with `-o`, or give yourself the right to write there.",
        could_not_run=True,
    ),
    Code(
        "SB005",
        "error",
        "required engine not available",
        "`--require` names an engine that is not installed or does not start.",
        "A check that did not run is not a check that passed.",
        "Install the engine, or drop the requirement.",
        could_not_run=True,
    ),
    Code(
        "SB006",
        "note",
        "cache cannot be used",
        "Results could not be kept in the cache folder.",
        "What was computed is right, but the next run computes it again.",
        "Make the folder writable, or free some space; `--cache DIR` names another folder, `--no-cache` uses none.",
    ),
)
