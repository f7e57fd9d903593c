"""SB9xx: faults of stepbot itself."""

from .code import Code

CODES = (
    Code(
        "SB901",
        "error",
        "internal error",
        "stepbot met a state that it should have prevented or reported earlier.",
        "The result cannot be trusted, so there is none.",
        "Please report it with the sidecar and the STEP file, or the smallest part of them that shows it.",
        could_not_run=True,
    ),
    Code(
        "SB902",
        "error",
        "worker process died",
        "A worker process ended without a result: it crashed, was killed, ran out of memory or out of time.",
        "The geometry kernel and some engines crash on input that they cannot handle; stepbot runs them apart so that "
        "you get this message instead.",
        "Look at the notes for the signal and the last lines that it printed; try the file in another CAD program; "
        "raise `--timeout` or `--memory-limit` if it ran out of them.",
        could_not_run=True,
    ),
)
