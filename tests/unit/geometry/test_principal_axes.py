"""Principal moments and axes of inertias."""

import numpy as np
import pytest

from stepbot.geometry.inertia import principal_axes
from stepbot.geometry.spatial import matrix3, rotation_from_rpy


@pytest.mark.parametrize(
    "moments", [(1.0, 2.0, 2.5), (3.0, 3.0, 3.0), (1.0, 1.0, 2.0), (1e-9, 1.0, 1.0), (2e-12, 3e-12, 5e-12), (0, 0, 0)]
)
def test_moments_and_axes_are_those_of_the_matrix(moments: tuple[float, ...]) -> None:
    """They rebuild the matrix to rounding, the axes are right-handed, and the moments those of LAPACK."""
    random = np.random.default_rng(1)
    for rpy in random.uniform(-3.0, 3.0, (50, 3)):
        R = rotation_from_rpy(rpy)
        I = R @ np.diag(moments) @ R.T  # noqa: E741
        I = 0.5 * (I + I.T)  # noqa: E741
        found, axes = principal_axes(matrix3(I))
        A = np.array(axes)
        size = max(moments)
        np.testing.assert_allclose(A @ np.diag(found) @ A.T, I, rtol=0, atol=4e-15 * size)
        np.testing.assert_allclose(sorted(found), np.linalg.eigvalsh(I), rtol=0, atol=4e-15 * size)
        np.testing.assert_allclose(A.T @ A, np.eye(3), atol=2e-15)
        assert np.linalg.det(A) == pytest.approx(1.0, abs=1e-14)


def test_a_diagonal_matrix_is_left_as_it_is() -> None:
    """Bodies along the axes of their link keep their order and the identity."""
    assert principal_axes(((3.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 2.0))) == (
        (3.0, 1.0, 2.0),
        ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    )
