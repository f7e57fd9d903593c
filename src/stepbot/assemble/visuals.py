"""Visual geometry of a link: the meshes of its components, in their colours.

The colour is the first of: the ``parts`` rule's, its own or its material's; the STEP's, of the face, then of the
occurrence; the default's, its own or its material's; grey.
"""

from collections.abc import Sequence

from stepbot.robot.model import GREY, Visual

from .assets import MeshAssets
from .binder import Binder
from .collisions import Placed
from .material_assignment import default_color


def visuals(binder: Binder, assets: MeshAssets, link: str, parts: Sequence[Placed]) -> tuple[Visual, ...]:
    """Visual geometry of a link, by component in file order; a component's ``visual`` overrides its link's."""
    assembly = binder.assembly
    drawn = binder.document.links[link].visual is not False
    default = default_color(binder.document) or GREY
    found = []
    for part in parts:
        component = assembly.components[part.index]
        if part.material.visual is False or (part.material.visual is None and not drawn):
            continue
        if not len(assembly.bodies[component.body].mesh.faces):
            continue
        groups = assets.by_color(component.body, component, part.material.color, default)
        found += [(group, part.X_LC, component.path) for group in groups]
    return tuple(
        Visual(f"{link}_visual_{i}", group.geometry, X_LG, group.rgba, path)
        for i, (group, X_LG, path) in enumerate(found, start=1)
    )
