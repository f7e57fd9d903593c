"""An occurrence with non-uniform scale, which no STEP writer is known to produce."""

import numpy as np

from stepbot.diagnostics import Diagnostics
from stepbot.step.structure.source import BodySource, Child, Definition, StepMaterial
from stepbot.step.structure.tree import grow


def find(diagnostics: Diagnostics) -> None:
    """Ask the library."""
    root = Definition(0, "root", children=[Child(1, "plate:1", np.diag([1.0, 2.0, 1.0, 1.0]))])
    plate = Definition(1, "plate", bodies=[BodySource(None, 1e-5, None, {})])
    grow([root, plate], (0,), [StepMaterial(), StepMaterial()], "robot.step", diagnostics)
