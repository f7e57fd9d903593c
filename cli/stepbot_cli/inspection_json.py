"""An assembly as JSON: everything that ``inspect`` reports, in SI, for scripts."""

from math import isfinite
from typing import Any

from stepbot.geometry.spatial import Pose
from stepbot.geometry.volume import VolumeProperties
from stepbot.pipeline.stages import Inspection
from stepbot.step.assembly import Assembly, AxisFace, Body, Component, Validation
from stepbot.step.features.axes import AxisLine, axis_faces, lines, selectors
from stepbot.step.structure.paths import quoted

from .contents import Contents, contents
from .inspection_rows import SharedAxes


def inspection_document(inspection: Inspection, *, features: bool) -> dict[str, Any]:
    """The file, its components, and its bodies, to which components refer by index.

    Args:
        inspection: The assembly with its mass properties.
        features: Whether to list the axis lines of each component.
    """
    assembly = inspection.assembly
    if assembly is None:
        return {}
    sums = contents(assembly, inspection.measures, inspection.tolerance)
    components = [_component(component, sums[component.index]) for component in assembly.components]
    if features:
        for component, document in zip(assembly.components, components, strict=True):
            document["axes"] = _axes(assembly, component)
    return {
        "file": assembly.source,
        "schema": assembly.schema,
        "originating_system": assembly.originating_system,
        "unit": assembly.unit,
        "unit_scale": assembly.unit_scale,
        "facts": assembly.facts,
        "definitions": assembly.definitions,
        "solids": sums[0].solids,
        "surfaces": sums[0].surfaces,
        "volume": sums[0].volume,
        "validations": [_validation(assembly, validation) for validation in assembly.validations],
        "components": components,
        "bodies": [_body(body, measured) for body, measured in zip(assembly.bodies, inspection.measures, strict=True)],
    }


def shared_axes_document(shared: SharedAxes) -> dict[str, Any]:
    """The axes that two components or links share, or nearly share."""
    return {
        "lines": [
            {**_line(line), "weight": line.weight, "chosen": line is shared.chosen, "origin": snippet}
            for line, snippet in zip(shared.lines, shared.snippets, strict=True)
        ],
        "near_misses": [
            {"distance": miss.distance, "angle": miss.angle, "components": list(places)}
            for miss, places in zip(shared.misses, shared.miss_places, strict=True)
        ],
    }


def _component(component: Component, inside: Contents) -> dict[str, Any]:
    return {
        "path": component.path,
        "parent": component.parent,
        "product": component.product,
        "occurrence": component.occurrence,
        "by_ordinal_only": component.by_ordinal_only,
        "missing": component.missing or None,
        "definition": component.definition,
        "body": component.body,
        "pose": _pose(component.X_WC),
        "solids": inside.solids,
        "surfaces": inside.surfaces,
        "volume": inside.volume,
        "bounds": inside.box,
        "size": inside.size,
        "center": inside.center,
        "material": component.material,
        "density": component.density or 0.0,
        "color": component.color,
    }


def _body(body: Body, measured: VolumeProperties | None) -> dict[str, Any]:
    return {
        "kind": body.kind.value,
        "watertight": body.watertight,
        "defect": body.defect,
        "vertices": len(body.mesh.vertices),
        "faces": len(body.mesh.faces),
        "colors": body.colors,
        "area": body.area or None,
        "exact": _volume(body.exact),
        "mesh": _volume(measured),
        "axis_faces": [_face(face) for face in body.axis_faces],
    }


def _validation(assembly: Assembly, validation: Validation) -> dict[str, Any]:
    """A validation property of the file, in SI."""
    return {
        "component": assembly.components[validation.component].path,
        "quantity": validation.quantity.value,
        "stated": validation.stated,
        "read": validation.read,
        "deviation": validation.deviation if isfinite(validation.deviation) else None,
        "tolerance": validation.tolerance,
        "agrees": validation.agrees,
    }


def _axes(assembly: Assembly, component: Component) -> list[dict[str, Any]]:
    found = lines(axis_faces(assembly, [component.index]))
    return [
        {**_line(line), "origin": f"{{axis_of: {quoted(component.path)}{selector}}}"}
        for line, selector in zip(found, selectors(found), strict=True)
    ]


def _line(line: AxisLine) -> dict[str, Any]:
    return {"point": line.point, "direction": line.direction, "low": line.low, "high": line.high, "radii": line.radii}


def _face(face: AxisFace) -> dict[str, Any]:
    return {
        "point": face.point,
        "direction": face.direction,
        "radius": face.radius,
        "low": face.low,
        "high": face.high,
        "bore": face.bore,
        "cone": face.cone,
    }


def _volume(properties: VolumeProperties | None) -> dict[str, Any] | None:
    """Volume [m^3], com [m], and inertia [kg m^2] about the com at 1 kg/m^3, in the definition's frame."""
    if properties is None:
        return None
    unit = properties.unit_density
    return {"volume": properties.volume, "com": unit.com, "inertia_at_unit_density": unit.inertia}


def _pose(pose: Pose) -> dict[str, Any]:
    return {"rotation": pose.rotation, "position": pose.position}
