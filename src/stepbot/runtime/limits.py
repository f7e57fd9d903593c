"""Default time limit of worker processes; imports nothing, so that a cached result is found quickly."""

DEFAULT_TIMEOUT = 600.0
"""Default time limit [s] of one call."""
