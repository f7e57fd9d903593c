"""The version of stepbot; a module of its own because every layer may import it."""

__version__ = "0.1.0"
