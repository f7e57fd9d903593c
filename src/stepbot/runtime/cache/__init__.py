"""Cached results on disk, each under a key of everything that it depends on.

store    entries in files: safe under concurrent runs and kills, bounded in size
folder   where they are on this system
digest   hashes of files and of the parts of a key
sources  what all keys contain: stepbot's own code, versions of packages and programs
codec    data classes and arrays as bytes and back, led by their annotations; a cache of values of one type
by_content  results of many computations, one for equal inputs; not imported here, as a lookup does not need it

Every entry can be computed again, and a damaged entry is treated as missing.
"""

from .codec import TypedCache, Undecodable, codec_of
from .digest import Digest, bytes_digest, content_digest, file_digest, files_digest
from .sources import environment, keep_own_code, own_code
from .store import DEFAULT_LIMIT, Cache, Usage, default_folder

__all__ = [
    "DEFAULT_LIMIT",
    "Cache",
    "Digest",
    "TypedCache",
    "Undecodable",
    "Usage",
    "bytes_digest",
    "codec_of",
    "content_digest",
    "default_folder",
    "environment",
    "file_digest",
    "files_digest",
    "keep_own_code",
    "own_code",
]
