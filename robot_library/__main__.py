"""``python -m robot_library``: see :mod:`robot_library.making`."""

import sys

from .making import main

if __name__ == "__main__":
    sys.exit(main())
