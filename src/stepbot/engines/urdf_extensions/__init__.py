"""The blocks of a URDF that no engine reads, read back by a parser of stepbot's own."""

from ..engine import Engine, always

ENGINE = Engine(__name__, "extensions", formats=("urdf",), available=always, order=80, own_parser=True)
