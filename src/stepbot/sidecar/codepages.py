"""Code pages by name: encodings of text that does not declare its own."""

import codecs
from encodings.aliases import aliases

from stepbot.diagnostics import did_you_mean

_ASCII = b"\t\r\n" + bytes(range(32, 92)) + bytes(range(93, 127)) + rb"\n\x41" + b"\x1b$B!!\x1b(B"
"""Text that encodings which are not supersets of ASCII decode differently: escapes, shifts, other letters."""
_COMMON = ("cp1250", "cp1251", "cp1252", "gbk", "gb18030", "cp932", "big5", "cp949", "koi8-r", "latin1", "utf-8")


class UnknownCodePage(ValueError):
    """No code page has this name, or it is not a superset of ASCII.

    Attributes:
        hints: Suggestions.
    """

    def __init__(self, message: str, *hints: str) -> None:
        self.hints = hints
        super().__init__(message)


def code_page(name: str) -> str:
    """The usual name of a code page: ``windows-1251`` is ``cp1251``.

    Raises:
        UnknownCodePage: There is none of this name, or it is not a superset of ASCII.
    """
    possible = f"examples: {', '.join(_COMMON)}"
    try:
        found = codecs.lookup(name.strip())
    except (LookupError, ValueError):  # ValueError: a name with a null character
        near = did_you_mean(name.strip().lower(), [*_COMMON, *aliases.values(), *aliases])
        raise UnknownCodePage(f"unknown code page '{name}'", *near, possible) from None
    try:
        is_superset = _ASCII.decode(found.name) == _ASCII.decode("ascii")
    except (LookupError, ValueError):  # LookupError: not a text encoding, such as base64
        is_superset = False
    if not is_superset:
        raise UnknownCodePage(f"code page '{name}' is not ASCII-compatible, but STEP files are", possible)
    return "utf-8" if found.name == "utf-8-sig" else found.name
