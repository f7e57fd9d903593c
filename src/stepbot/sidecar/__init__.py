"""The YAML sidecar: what STEP does not carry. The only package that imports pydantic and ruamel.yaml."""

VERSION = 1
"""The version of the sidecar that this stepbot reads."""
