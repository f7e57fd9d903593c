"""A PROTO of Webots read back by a parser of stepbot's own, because Webots itself has no library that reads it."""

from ..engine import Engine, always

ENGINE = Engine(__name__, "vrml", formats=("webots",), available=always, order=25, own_parser=True)
