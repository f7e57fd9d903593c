"""Who maintains a robot's description, and its licence: what packages state that are published."""

import re

from msgspec import Struct
from msgspec.structs import replace

MAINTAINER = r"^[^<>\s]([^<>\x00-\x1f]*[^<>\s])? <[^<>@\s]+@[^<>@\s]+>$"
"""A name and an address: ``Ada Lovelace <ada@example.com>``."""
_RESERVED = re.compile(r"(^|\.)(example(\.(com|net|org))?|test|invalid|localhost)$", re.IGNORECASE)
"""Domains that belong to nobody, for examples: RFC 2606."""


def is_maintainer(text: str) -> bool:
    """Whether a text is a name and an address, as :data:`MAINTAINER`."""
    return re.match(MAINTAINER, text) is not None


class Metadata(Struct, frozen=True):
    """What the sidecar states about the description; empty where it does not."""

    maintainer: str = ""
    email: str = ""
    license: str = ""
    """Licence of the description, by its SPDX identifier where it has one."""
    version: str = ""
    """Three numbers: ``1.2.3``."""
    description: str = ""

    @property
    def is_placeholder(self) -> bool:
        """Whether no mail reaches the maintainer's address, because its domain is reserved for examples."""
        return _RESERVED.search(self.email.rpartition("@")[2]) is not None

    def stating(self, maintainer: str, license: str) -> "Metadata":
        """The same with another maintainer, as :data:`MAINTAINER`, and licence; empty for those that are stated."""
        name, _, email = maintainer.removesuffix(">").partition(" <")
        stated = replace(self, maintainer=name, email=email) if maintainer else self
        return replace(stated, license=license) if license else stated


NO_METADATA = Metadata()
"""Nothing is stated."""
