"""Names of meshes: valid file names on every system, valid names in every format, unique and deterministic."""

import re
import unicodedata
from collections.abc import Iterable

_DEVICE = re.compile(r"(con|prn|aux|nul|conin\$|conout\$|(com|lpt)[0-9¹²³]) *(\..*)?", re.IGNORECASE | re.DOTALL)


def is_device(name: str) -> bool:
    """Whether Windows opens a device by this name, whatever its extension."""
    return _DEVICE.fullmatch(name) is not None


_PORTABLE = re.compile(r"[A-Za-z_][A-Za-z0-9_.-]*")
LONGEST = 60
"""Maximum length [characters] of a name, before a number is added."""
FALLBACK = "part"

_CYRILLIC = "а:a б:b в:v г:g д:d е:e ж:zh з:z и:i й:y к:k л:l м:m н:n о:o п:p р:r с:s т:t у:u ф:f х:kh ц:ts ч:ch ш:sh"
_CYRILLIC_LAST = "щ:shch ъ:_ ы:y ь:_ э:e ю:yu я:ya"
_LATIN = "ß:ss æ:ae ø:o œ:oe đ:d ð:d þ:th ł:l ı:i µ:u ⌀:d"
_LETTERS = dict(pair.split(":") for pair in f"{_CYRILLIC} {_CYRILLIC_LAST} {_LATIN}".split())


def ascii_name(text: str) -> str:
    """A name in ``[A-Za-z0-9_-]`` that resembles ``text``: accents dropped, Cyrillic transliterated, the rest ``_``."""
    plain = "".join(_plain(letter) for letter in text)
    name = re.sub(r"_+", "_", re.sub(r"[^A-Za-z0-9-]", "_", plain)).strip("_-")[:LONGEST].rstrip("_-") or FALLBACK
    return f"{name}_{FALLBACK}" if is_device(name) else name


def portable_name(name: str, kind: str) -> str:
    """A name that every reader takes, resembling ``name``; the name itself if it is one.

    Readers of all formats, ROS, xacro, shells and file systems agree on ASCII letters, digits, ``_``, ``-`` and ``.``,
    without a digit at the beginning. Robots name files, which may begin with a digit.

    Args:
        kind: What it names, to begin a name with: ``link``.
    """
    is_file = kind == "robot"
    if _PORTABLE.fullmatch(f"_{name}" if is_file else name):
        return name
    known = ascii_name(name)
    return f"{kind}_{known}" if known[0].isdigit() and not is_file else known


_INVALID = re.compile(r"""[/<>&"'\x00-\x1f\x7f]+|::""")
_LONGEST_VALID = 200
"""The same [characters] of names that descriptions give, which are changed only where a format cannot hold them."""


def valid_name(name: str, fallback: str) -> str:
    """A name that every format can hold, resembling ``name``."""
    visible = "".join(letter for letter in name if unicodedata.category(letter) not in ("Cf", "Cs"))
    valid = _INVALID.sub("_", visible).strip()[:_LONGEST_VALID].strip() or fallback
    if valid.startswith("__") and valid.endswith("__"):
        valid = valid.strip("_") or fallback
    return "world_link" if valid == "world" else valid


def _plain(letter: str) -> str:
    """A letter without accents, in Latin script if the table has it."""
    if letter in _LETTERS:
        return _LETTERS[letter]
    if letter.lower() in _LETTERS:
        return _LETTERS[letter.lower()].capitalize()
    parts = unicodedata.normalize("NFKD", letter)
    return "".join(c if c == letter else _plain(c) for c in parts if not unicodedata.combining(c))


class UniqueNames:
    """Assigns each name once; names that differ only in case would be the same file on some systems."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = {name.casefold() for name in taken}

    def unique(self, name: str) -> str:
        """``name``, or ``name`` with the lowest number from 2 that makes it unique."""
        candidate, n = name, 1
        while candidate.casefold() in self._taken:
            n += 1
            candidate = f"{name}_{n}"
        self._taken.add(candidate.casefold())
        return candidate


SCOPE = "::"
"""Between the name of an element and those of its parts in a file: no name of a robot contains it.

dm_control rejects a slash in names of MJCF.
"""
MOTOR_LINE = f"{SCOPE}line"
"""End of the name of a tendon of MJCF that has the torque-speed line of an actuator."""


def free_name(name: str, suffix: str, taken: set[str]) -> str:
    """``name``, with as many suffixes as needed to be unique; it is then added to the used names."""
    while name in taken:
        name += suffix
    taken.add(name)
    return name
