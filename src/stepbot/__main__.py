"""``python -m stepbot``: the command line."""

import sys
from importlib import import_module

from stepbot.runtime.import_path import restrict_import_path

if __name__ == "__main__":
    restrict_import_path()  # `python -m` puts the current folder first
    # By name: the library must not import the command line.
    sys.exit(import_module("stepbot_cli").main())
