"""The mirror images of ports and mimics, for modules that are the mirror image of another one."""

from collections.abc import Mapping
from fnmatch import fnmatchcase

import numpy as np

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.model import Mimic
from stepbot.sidecar.document import Document
from stepbot.sidecar.located import Sidecar

from .mirroring import NORMALS, conjugated
from .parts import Part, image_name, joints_above
from .ports import Port, Ports


def is_root_part(document: Document, module: str) -> bool:
    """Whether a module has neither a port nor a joint: it can only be the root."""
    section = document.modules[module]
    return not (section.at or section.mirror_of or joints_above(document, module))


class Images:
    """Finds what a mirrored module is attached to, and what its joints follow.

    Args:
        sidecar: The composing file.
        parts: Its modules.
        ports: Resolves references.
        diagnostics: Receives SB154.
    """

    def __init__(self, sidecar: Sidecar, parts: Mapping[str, Part], ports: Ports, diagnostics: Diagnostics) -> None:
        self._sidecar, self._parts, self._ports, self._diagnostics = sidecar, parts, ports, diagnostics
        self._document = sidecar.document

    def mimic(self, name: str, above: str) -> Mimic | None:
        """The mimic of the image of a joint: of the leader's image, or of the leader itself if it has none.

        Args:
            name: The mirrored module.
            above: The joint of the composing file whose image is above it.
        """
        mimic = self._document.joints[above].mimic
        if mimic is None:
            return None
        reference, multiplier, modules = mimic.joint, mimic.multiplier.value, self._document.modules
        own = self._document.joints.get(reference)
        module, _, path = (reference if own is None else own.child).partition("/")
        images = self._of(module)
        if own is not None:  # the image of a joint exists where the mirrored module has no other place
            images = [one for one in images if modules[one].at is None and not joints_above(self._document, one)]
        image = name if name in images else self._beside(name, images, ("joints", above, "mimic", "joint"))
        if image:
            part = self._parts[image]
            reference = f"{image}/{path}" if own is None else image_name(reference, module, image)
            leader = part.written(path).removeprefix(part.prefix) if own is None else reference
            if any(fnmatchcase(leader, pattern) for pattern in modules[image].flip):
                multiplier = 0.0 - multiplier
        joint = self._ports.joint(reference, ("joints", above, "mimic", "joint"))
        return None if joint is None else Mimic(joint, multiplier, mimic.offset.value)

    def port(self, name: str, reference: str, keys: tuple[str, ...], offset: Pose, m: Array) -> Port | None:
        """The mirror image of a port: on the mirror image of its module, or in its own link, which is in the middle."""
        port = self._ports.port(reference, keys)
        if port is None:
            return None
        X_LC = port.X_LP @ offset
        module = self._ports.part(port.link)
        images = self._of(module)
        image = self._beside(name, images, keys)
        if image:
            there = self._ports.port(f"{image}/{self._parts[module].local(port.link)}", keys)
            m_there = np.array(NORMALS[self._document.modules[image].mirror or "y"])
            return None if there is None else Port(there.link, conjugated(X_LC, m_there, m))
        if images:
            return None
        if module and not is_root_part(self._document, module):
            original = self._document.modules[name].mirror_of
            message = f"module '{name}': mirror_of: '{original}' is at {reference}, and nothing mirrors '{module}'"
            help = [f"add a module with `mirror_of: {module}`, or give `at`"]
            self._diagnostics.add("SB154", message, self._sidecar.span("modules", name, "mirror_of"), help=help)
            return None
        return Port(port.link, conjugated(X_LC, m))

    def beside(self, name: str, module: str) -> list[str]:
        """The images of a module that another image can be attached to; several if neither planes nor names decide."""
        return self._closest(name, self._of(module))

    def _closest(self, name: str, images: list[str]) -> list[str]:
        modules = self._document.modules
        original = str(modules[name].mirror_of)
        ones = [image for image in images if (modules[image].mirror or "y") == (modules[name].mirror or "y")] or images
        if len(ones) > 1:
            ones = [one for one in ones if image_name(str(modules[one].mirror_of), original, name) == one] or ones
        return ones

    def _of(self, module: str) -> list[str]:
        modules = self._document.modules.items()
        return [name for name, section in modules if module and section.mirror_of == module and name in self._parts]

    def _beside(self, name: str, images: list[str], keys: tuple[str, ...]) -> str | None:
        """The image, among those of one module, that another image is attached to: through the same plane, or by name.

        Args:
            name: The module that is attached.
            images: The images of the module that its original is attached to.
            keys: The place of the reference to that module.
        """
        modules = self._document.modules
        original = str(modules[name].mirror_of)
        ones = self._closest(name, images)
        if len(ones) > 1:
            which = f"'{modules[ones[0]].mirror_of}', which has several images"
            message = f"module '{name}': mirror_of: '{original}' is on {which}"
            help = [f"give `at`: a port of {' or '.join(repr(one) for one in ones)}"]
            notes = [f"the reference at {self._sidecar.span(*keys)}"]
            self._diagnostics.add(
                "SB154", message, self._sidecar.span("modules", name, "mirror_of"), help=help, notes=notes
            )
        return ones[0] if len(ones) == 1 else None
