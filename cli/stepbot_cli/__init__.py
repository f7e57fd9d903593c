"""The ``stepbot`` command."""

try:
    from stepbot.runtime.import_path import restrict_import_path

    restrict_import_path()  # before anything else is imported

    from .application import command, main
except KeyboardInterrupt:  # Ctrl-C while modules are imported
    raise SystemExit(130) from None

__all__ = ["command", "main"]
