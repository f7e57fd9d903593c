"""Records results again, or prints one of them: see :mod:`tests.recorded`."""

import sys
from argparse import ArgumentParser

from . import record, text
from .test_recorded import KINDS


def main() -> None:
    """Record or show."""
    parser = ArgumentParser(prog="python -m tests.recorded", description=__doc__)
    parser.add_argument("kinds", nargs="*", default=[*KINDS], help=f"which ({', '.join(KINDS)}); all by default")
    parser.add_argument("--show", metavar="'KIND NAME'", help="print the result behind a digest")
    chosen = parser.parse_args()
    if chosen.show:
        kind, name = chosen.show.split(" ", 1)
        sys.stdout.write(text(KINDS[kind][name](0.0)) + "\n")
        return
    for kind in chosen.kinds:
        record(kind, KINDS[kind])


if __name__ == "__main__":
    main()
