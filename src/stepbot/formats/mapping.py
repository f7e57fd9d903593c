"""The table of features and formats that people read, made from what the writers declare."""

from stepbot.diagnostics.codes import CODES

from .lowering import Feature, Format, Level

_HEAD = """\
# What each format says

Made by `make generate` from what the writers declare; do not edit.

- **exact**: the format says it, in the way that is named.
- **lowered**: the format says it by other means; a diagnostic says how.
- **reported**: the format has no place for it; it is left out, and a diagnostic names what. With `--strict` a warning
  ends the run. A note does not, since nothing of the robot is lost: whether its base is fixed, and the pose in which it
  starts, whoever loads the file can say.
- **refused**: an error; nothing is written.

`stepbot explain CODE` tells more about a diagnostic.
"""


def mapping_page() -> str:
    """``docs/mapping.md``."""
    from . import FORMATS  # the package looks into this module while it finds its formats

    formats = FORMATS.values()
    lines = ["| | " + " | ".join(written.TITLE for written in formats) + " |", "| --- |" + " --- |" * len(formats)]
    lines += [
        f"| {feature} | " + " | ".join(_cell(written, feature) for written in formats) + " |" for feature in Feature
    ]
    return _HEAD + "\n" + "\n".join(lines) + "\n"


def _cell(written: Format, feature: Feature) -> str:
    support = written.EXPRESSES[feature]
    if support.level is Level.EXACT:
        return f"exact: {support.how}"
    return f"**{support.level}**: {support.how} ({CODES[support.code].severity} {support.code})"
