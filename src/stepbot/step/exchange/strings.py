r"""Decodes strings of STEP files: escapes of ISO 10303-21 such as ``\X2\0421\X0\``, and raw bytes."""

import re

_DIRECTIVE = re.compile(
    r"\\X2\\((?:[0-9A-Fa-f]{4})*)\\X0\\|\\X4\\((?:[0-9A-Fa-f]{8})*)\\X0\\|\\X\\([0-9A-Fa-f]{2})|\\S\\(.)|\\P([A-I])\\|(\\\\)|('')",
    re.DOTALL,
)
_LINE_BREAK = re.compile(r"[\r\n]")


def decode_string(raw: bytes, encoding: str, errors: str = "strict") -> str:
    """The text of a string between its quotes.

    Args:
        raw: Bytes as in the file.
        encoding: Encoding of bytes above 127.
        errors: Handling of undecodable bytes: ``strict`` or ``replace``.

    Raises:
        UnicodeDecodeError: The bytes are not in this encoding.
    """
    page = 1

    def replacement(match: re.Match[str]) -> str:
        nonlocal page
        two, four, one, shifted, alphabet, backslash, _ = match.groups()
        if two is not None:
            return bytes.fromhex(two).decode("utf-16-be", "replace")
        if four is not None:
            return bytes.fromhex(four).decode("utf-32-be", "replace")
        if one is not None:
            return chr(int(one, 16))
        if shifted is not None:
            return bytes([(ord(shifted) & 0x7F) | 0x80]).decode(f"iso8859-{page}", "replace")
        if alphabet is not None:
            page = ord(alphabet) - ord("A") + 1
            return ""
        return "\\" if backslash else "'"

    return _DIRECTIVE.sub(replacement, _joined(raw.decode(encoding, errors)))


def _joined(text: str) -> str:
    """Without line breaks, and without leading and trailing white space."""
    first, *others = _LINE_BREAK.split(text)
    if not others:
        return text
    *middle, last = others
    return "".join([first.rstrip(), *(line.strip() for line in middle), last.lstrip()])
