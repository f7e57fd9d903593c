"""When a flat contact is centred on an axis."""

import numpy as np
import pytest

from stepbot.draft.contacts.concentric import patch_lies_about
from stepbot.draft.contacts.contacts import Patch
from stepbot.draft.parts.axis import Axis


@pytest.mark.parametrize(("offset", "is_centred"), [(0.0, True), (1.0, True), (2.0, False), (4.0, False)])
def test_rectangle_beside_an_axis(offset: float, is_centred: bool) -> None:
    """A rectangular contact of 20 mm x 16 mm may be off its axis by a tenth of its reach, not by a fifth."""
    corners = [(-10.0, -8.0, 0.0), (10.0, -8.0, 0.0), (10.0, 8.0, 0.0), (-10.0, 8.0, 0.0)]
    outline = 1e-3 * (np.array(corners) + np.array([offset, 0.0, 0.0]))
    normal = np.array([0.0, 0.0, 1.0])
    patch = Patch(
        0, 1, outline.mean(axis=0), normal, 3.2e-4, outline, (np.vstack([outline, outline[:1]]),), -normal, 0.0
    )
    assert patch_lies_about(Axis(np.zeros(3), normal), patch) == is_centred
