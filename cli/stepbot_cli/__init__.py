"""The ``stepbot`` command."""

from stepbot.runtime.import_path import restrict_import_path

restrict_import_path()  # before anything else is imported

from .application import main  # noqa: E402

__all__ = ["main"]
