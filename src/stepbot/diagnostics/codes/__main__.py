"""``python -m stepbot.diagnostics.codes`` prints ``docs/diagnostics.md``."""

import sys

from .page import diagnostics_page

sys.stdout.write(diagnostics_page())
