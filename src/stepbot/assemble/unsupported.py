"""Reports features that version 1 of the sidecar allows but this stepbot cannot build: an error each."""

from stepbot.sidecar.document import CollisionShape, MergedCollision
from stepbot.sidecar.tree import Keys

from .binder import Binder


def report_unsupported(binder: Binder) -> None:
    """Report everything that is parsed but not built."""
    document = binder.document
    for pattern, rule in document.parts.items():
        if rule.collision is CollisionShape.DECOMPOSE:
            _report_decompose(binder, ("parts", pattern, "collision"))
    for name, link in document.links.items():
        if isinstance(link.collision, MergedCollision) and link.collision.merge is CollisionShape.DECOMPOSE:
            _report_decompose(binder, ("links", name, "collision", "merge"))
        elif link.collision is CollisionShape.DECOMPOSE:
            _report_decompose(binder, ("links", name, "collision"))


def _report_decompose(binder: Binder, keys: Keys) -> None:
    _report(binder, keys, "collision by convex decomposition", "use hull, mesh, or a list of primitive shapes")


def _report(binder: Binder, keys: Keys, what: str, remedy: str) -> None:
    binder.report("SB307", keys, f"{what}: parsed but not yet supported", help=(remedy,))
