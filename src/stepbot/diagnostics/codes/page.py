"""The page of the documentation that lists every code."""

from itertools import groupby

from . import CODES

RANGES = {
    "0": "Files and environment",
    "1": "The sidecar: YAML and schema",
    "2": "The STEP file",
    "3": "Binding the sidecar to the assembly",
    "4": "Kinematics: tree, loops, axes, limits",
    "5": "Mass and inertia",
    "6": "Meshes and tessellation",
    "7": "What a format cannot say",
    "8": "A simulator disagrees with the model",
    "9": "Faults of stepbot itself",
}
"""Subject of the codes that begin with ``SB`` and this digit."""

INTRODUCTION = """\
# Diagnostics

<!-- Written by `make generate` from src/stepbot/codes: change the texts there. -->

A finding reads `file:line:column: severity[CODE]: message`. An error ends the run with exit code 1, or with 2 where
stepbot could not do its work at all (marked below); warnings and notes leave it at 0 unless `--strict` turns warnings
into errors. `stepbot explain CODE` prints what stands here. Codes are never renumbered and never used again.
"""


def diagnostics_page() -> str:
    """The whole page, Markdown."""
    codes = sorted(CODES.values(), key=lambda code: code.id)
    sections = [INTRODUCTION]
    for digit, group in groupby(codes, key=lambda code: code.id[2]):
        sections.append(f"## SB{digit}xx: {RANGES[digit]}\n")
        for code in group:
            exit_code = ", exit code 2" if code.could_not_run else ""
            sections.append(
                f"### {code.id}: {code.title}\n\n*{code.severity}{exit_code}*\n\n{code.what}\n\n"
                f"**Why it matters.** {code.why}\n\n**How to fix it.** {code.fix}\n"
            )
    return "\n".join(sections)
