"""Command line of every robot's build.py: draw, compare with closed forms, write STEP and expected.json."""

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .expected import write_expected
from .moments import Array, Moments
from .step_file import UNITS, Assembly, Part, write_step

_TOLERANCE = 1e-9


def run(
    step: Path,
    draw: Callable[[], Assembly],
    closed_forms: Mapping[str, Moments] | None,
    expected: Callable[[], dict[str, Any]],
) -> None:
    """Draw a robot with the options of the command line.

    Args:
        step: STEP file to write by default; expected.json is written beside it.
        draw: Draws the robot.
        closed_forms: For each part name the integrals at density 1 [mm], in the part's frame; None for a robot without
            closed forms.
        expected: Computes the content of expected.json.

    Raises:
        SystemExit: The mass properties of the drawing differ from the closed forms.
    """
    parser = argparse.ArgumentParser(description=f"Draw {step.name}, and compute its expected.json.")
    parser.add_argument("--unit", choices=UNITS, default="mm", help="length unit of the STEP file (default: mm)")
    parser.add_argument(
        "-o", "--output", type=Path, default=step, help="STEP file to write (default: beside the script)"
    )
    options = parser.parse_args()

    root = draw()
    if closed_forms is not None:
        _compare(root, closed_forms)
    write_step(options.output, root, unit=options.unit, name=step.name)
    if options.output == step:
        write_expected(step.parent / "expected.json", expected())


def _compare(root: Assembly, closed_forms: Mapping[str, Moments]) -> None:
    """Compare volume, com and inertia of each part, relative to its size.

    Raises:
        SystemExit: Parts or mass properties differ.
    """
    parts = _parts(root)
    if parts.keys() != closed_forms.keys():
        raise SystemExit(f"drawn: {sorted(parts)}; known in closed form: {sorted(closed_forms)}")
    for name, part in parts.items():
        exact, (volume, com, inertia) = closed_forms[name], kernel_properties(part.shape)
        size = exact.mass ** (1 / 3)
        deviation = max(
            abs(volume / exact.mass - 1),
            float(np.max(np.abs(com - exact.com))) / size,
            float(np.max(np.abs(inertia - exact.inertia))) / float(np.max(np.abs(exact.inertia))),
        )
        if not deviation < _TOLERANCE:
            raise SystemExit(f"{name}: the drawing deviates from the closed form by {deviation:.1e}")


def _parts(product: Assembly | Part) -> dict[str, Part]:
    if isinstance(product, Part):
        return {product.name: product}
    return {name: part for child in product.children for name, part in _parts(child.product).items()}


def kernel_properties(shape: Any) -> tuple[float, Array, Array]:
    """Volume, com (3,) and inertia (3, 3) about the com of a shape, integrated by the kernel at density 1 [mm]."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    com, matrix = properties.CentreOfMass(), properties.MatrixOfInertia()
    inertia = np.array([[matrix.Value(i, j) for j in (1, 2, 3)] for i in (1, 2, 3)])
    return properties.Mass(), np.array([com.X(), com.Y(), com.Z()]), inertia
