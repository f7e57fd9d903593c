"""Reads STEP files; the only package that imports the geometry kernel, and only in a worker process.

May be called by ``assemble``, ``draft`` and everything above them.
"""

KERNEL = "stepbot.step.worker:read"
"""The function that runs in the kernel's process."""
BODY_SECONDS = 120.0
"""Time limit of a body [s]: processor time in a forked process, else wall-clock time. Large ones take a few seconds."""
