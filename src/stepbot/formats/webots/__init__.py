"""Webots, which reads a robot as a PROTO in VRML."""

from ..format import Format
from .vrml import proto_name

FORMAT = Format(
    __name__,
    "webots",
    "Webots",
    suffix=".proto",
    root="",
    order=50,
    scene=".wbt",
    default=False,
    signatures=(b"#VRML_SIM ",),
    stem=proto_name,
)
