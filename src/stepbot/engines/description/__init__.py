"""An existing robot description as data: its links, joints, and the points of its shapes.

Unlike an engine it needs no meshes: a shape whose file is missing, or of an unsupported type, is listed and left out.
"""

from .description import DescribedShape, Description

__all__ = ["DescribedShape", "Description"]
