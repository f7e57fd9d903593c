"""The ``stepbot`` command."""

from .application import main

__all__ = ["main"]
