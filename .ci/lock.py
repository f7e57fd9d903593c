"""Print the exact versions, with the hashes of their wheels, that pip installs for stepbot and its development tools.

The lock is for Python 3.11 on Linux x86-64 with glibc, which CI uses; elsewhere the ranges of ``pyproject.toml`` apply.
``--fits`` prints nothing; its exit code is 0 if the lock is for this interpreter.
"""

import json
import platform
import subprocess
import sys

HEADER = """\
# What CI installs: Python 3.11, Linux x86-64, glibc. Written by `make lock`; the ranges are in pyproject.toml.
"""


def fits() -> bool:
    """Whether the lock is for the running interpreter."""
    here = (
        platform.python_implementation(),
        sys.version_info[:2],
        sys.platform,
        platform.machine(),
        platform.libc_ver()[0],
    )
    return here == ("CPython", (3, 11), "linux", "x86_64", "glibc")


def locked() -> str:
    """The lock file's text, resolved again."""
    pip = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--dry-run",
        "--ignore-installed",
        "--report",
        "-",
        ".[dev]",
    ]
    report = json.loads(subprocess.run(pip, check=True, stdout=subprocess.PIPE).stdout)
    lines = []
    for package in report["install"]:
        if package["is_direct"]:  # stepbot itself
            continue
        digest = package["download_info"]["archive_info"]["hashes"]["sha256"]
        lines.append(
            f"{package['metadata']['name'].lower()}=={package['metadata']['version']} --hash=sha256:{digest}\n"
        )
    return HEADER + "".join(sorted(lines))


if __name__ == "__main__":
    if sys.argv[1:] == ["--fits"]:
        sys.exit(not fits())
    if not fits():
        sys.exit("the lock is made with CPython 3.11 on Linux x86-64 with glibc")
    print(locked(), end="")
