"""A runner that crashes at the first mutant with an odd number, to test that this is detected."""

import json
import os
import sys

from msgspec.structs import asdict

from .judge import Verdict
from .mutant import Mutant

if __name__ == "__main__":
    for line in sys.stdin:
        if Mutant.named(line.strip()).number % 2:
            os.abort()
        sys.stdout.write(json.dumps(asdict(Verdict("robot"))) + "\n")
        sys.stdout.flush()
