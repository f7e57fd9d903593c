"""Reads the YAML sidecar, which states what STEP lacks; the only package that imports pydantic and ruamel.yaml.

May be called by ``assemble`` and everything above it.
"""

VERSION = 1
"""The version of the sidecar format that this stepbot reads."""
