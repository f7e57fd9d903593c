"""Sizes in bytes with a unit prefix: ``4G``, ``500 MB``."""

import re

import click

_SIZE = re.compile(r"(?P<number>\d+(?:\.\d+)?)\s*(?P<prefix>[KMGT]?)i?B?", re.IGNORECASE)
_FACTORS = {"": 1, "K": 2**10, "M": 2**20, "G": 2**30, "T": 2**40}


def size(text: str) -> int:
    """Bytes, from a number with an optional binary prefix.

    Raises:
        click.BadParameter: The text is not a size.
    """
    match = _SIZE.fullmatch(text.strip())
    if match is None:
        raise click.BadParameter(f"'{text}' is not a size such as 4G or 500M")
    return int(float(match["number"]) * _FACTORS[match["prefix"].upper()])


def in_words(count: int) -> str:
    """A size with a unit prefix: ``1.4 GiB``."""
    amount, unit = float(count), "B"
    for larger in ("KiB", "MiB", "GiB", "TiB"):
        if amount < 1024.0:
            break
        amount, unit = amount / 1024.0, larger
    return f"{amount:.1f} {unit}" if unit != "B" else f"{count} B"
