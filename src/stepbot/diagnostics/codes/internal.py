"""SB9xx: internal errors."""

from .code import Code

CODES = (
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
        "A worker process ended without a result: it crashed, was killed, or exceeded its memory or time limit. The "
        "geometry kernel and some engines crash on some input. stepbot runs them in separate processes to report such "
        "failures.",
        "The notes contain the signal and the last lines of output. Try the file in another CAD program. Raise "
        "`--timeout` or `--memory-limit` if a limit was exceeded.",
        could_not_run=True,
    ),
)
