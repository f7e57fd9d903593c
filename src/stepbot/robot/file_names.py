"""File names that are invalid on some system."""

import re

_DEVICE = re.compile(r"(con|prn|aux|nul|conin\$|conout\$|(com|lpt)[0-9¹²³]) *(\..*)?", re.IGNORECASE | re.DOTALL)


def is_device(name: str) -> bool:
    """Whether Windows opens a device by this name, whatever its extension."""
    return _DEVICE.fullmatch(name) is not None
