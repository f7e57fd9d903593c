"""``python -m stepbot_cli``."""

import sys

from . import main

sys.exit(main())
