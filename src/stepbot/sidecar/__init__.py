"""The YAML sidecar: what STEP does not carry. The only package that imports pydantic and ruamel.yaml."""
