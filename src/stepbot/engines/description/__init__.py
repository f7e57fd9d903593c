"""An existing robot description as data: what it says of links and joints, and the points of their shapes.

Unlike an engine it needs no mesh: a shape whose file is missing, or of a kind that is not read, is listed and left out.
"""

from .description import DescribedShape, Description

__all__ = ["DescribedShape", "Description"]
