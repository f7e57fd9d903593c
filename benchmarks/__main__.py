"""``python -m benchmarks``: see :mod:`benchmarks.command`."""

import sys

from .command import main

if __name__ == "__main__":
    sys.exit(main())
