"""Drafts a sidecar from a plain STEP: links and joints inferred from contacts, roles and names.

Every result is a guess with evidence: each line of a draft states its source and the strength of the evidence. May be
called by ``pipeline`` and above.
"""

import sys
from types import ModuleType


class _Room(ModuleType):
    """Makes this package callable: once imported, it has the name of the function ``stepbot.draft``."""

    def __call__(self, *given: object, **named: object) -> object:
        import stepbot

        return stepbot.__getattr__("draft")(*given, **named)  # type: ignore[operator]


sys.modules[__name__].__class__ = _Room
