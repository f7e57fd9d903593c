"""An assembly as JSON: everything that ``inspect`` reports, in SI, for scripts."""

from typing import Any

from stepbot.geometry.volume import VolumeProperties
from stepbot.pipeline.stages import Inspection
from stepbot.report.plain import picked
from stepbot.step.assembly import Assembly, Body, Component, Validation
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
        **picked(assembly, "file=source schema originating_system unit unit_scale facts definitions"),
        **picked(sums[0], "solids surfaces volume"),
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
    keys = "path parent product occurrence by_ordinal_only missing definition body"
    return {
        **picked(component, keys, missing=component.missing or None),
        "pose": picked(component.X_WC, "rotation position"),
        **picked(inside, "solids surfaces volume bounds=box size center"),
        **picked(component, "material density color", density=component.density or 0.0),
    }


def _body(body: Body, measured: VolumeProperties | None) -> dict[str, Any]:
    return {
        **picked(body, "kind watertight defect"),
        "vertices": len(body.mesh.vertices),
        "faces": len(body.mesh.faces),
        "colors": body.colors,
        "area": body.area or None,
        "exact": _volume(body.exact),
        "mesh": _volume(measured),
        "axis_faces": [picked(face, "point direction radius low high bore cone") for face in body.axis_faces],
    }


def _validation(assembly: Assembly, validation: Validation) -> dict[str, Any]:
    """A validation property of the file, in SI."""
    path = assembly.components[validation.component].path
    return picked(validation, "component quantity stated read deviation tolerance agrees", component=path)


def _axes(assembly: Assembly, component: Component) -> list[dict[str, Any]]:
    found = lines(axis_faces(assembly, [component.index]))
    return [
        {**_line(line), "origin": f"{{axis_of: {quoted(component.path)}{selector}}}"}
        for line, selector in zip(found, selectors(found), strict=True)
    ]


def _line(line: AxisLine) -> dict[str, Any]:
    return picked(line, "point direction low high radii")


def _volume(properties: VolumeProperties | None) -> dict[str, Any] | None:
    """Volume [m^3], com [m], and inertia [kg m^2] about the com at 1 kg/m^3, in the definition's frame."""
    if properties is None:
        return None
    unit = properties.unit_density
    return {"volume": properties.volume, "com": unit.com, "inertia_at_unit_density": unit.inertia}
