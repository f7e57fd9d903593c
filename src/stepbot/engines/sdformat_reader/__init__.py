"""SDFormat read back by a parser of stepbot's own."""

from ..engine import Engine, always

ENGINE = Engine(__name__, "reader", formats=("sdf",), available=always, order=20, own_parser=True)
