"""STEP -> Assembly: the only package that imports the geometry kernel, and only in a worker process."""

KERNEL = "stepbot.step.worker:read"
"""The function that runs in the kernel's process."""
