"""The tree of a STEP file for the page: one entry per component, in file order."""

from typing import Any

from stepbot.robot.model import Robot
from stepbot.step.assembly import Assembly
from stepbot.step.structure.paths import quoted

Json = dict[str, Any]


def component_documents(assembly: Assembly, robot: Robot) -> list[Json]:
    """Components with their paths as a sidecar writes them, and the links that own their bodies."""
    owner = {path: link.name for link in robot.links for path in link.components}
    return [
        {
            "path": component.path,
            "quoted": quoted(component.path),
            "parent": component.parent,
            "name": component.occurrence or component.product or component.segment,
            "product": component.product,
            "material": component.material,
            "has_body": component.body >= 0,
            "link": owner.get(component.path, ""),
        }
        for component in assembly.components
    ]
