"""stepbot: one STEP assembly and one small sidecar become URDF, SDFormat and MJCF, proven equal."""

__version__ = "0.1.0"
