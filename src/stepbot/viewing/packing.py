"""Triangle meshes as short text: vertices on a grid of 65536 steps along each edge of their bounding box.

A step is a part in 65536 of the size of the mesh: 15 micrometres for a metre. Only drawings use these vertices; joints,
masses and frames are numbers of full precision.
"""

from base64 import b64encode
from typing import Any

import numpy as np

from stepbot.geometry.mesh import TriMesh

STEPS = 65535
_FEW = 65536
"""Number of vertices up to which an index fits in two bytes."""


def packed(mesh: TriMesh) -> dict[str, Any]:
    """A mesh as JSON data: ``low`` and ``size`` [m] of its box, vertices and indices as little-endian base64."""
    vertices = mesh.vertices if len(mesh.vertices) else np.zeros((1, 3))
    low = vertices.min(axis=0)
    size = vertices.max(axis=0) - low
    steps = np.rint((vertices - low) / np.where(size > 0.0, size, 1.0) * STEPS).astype("<u2")
    # Formats such as STL repeat each vertex in every triangle; one of each makes edges known.
    keys = steps.astype(np.uint64) @ np.array([1 << 32, 1 << 16, 1], dtype=np.uint64)
    _, kept, renumbered = np.unique(keys, return_index=True, return_inverse=True)
    steps, faces = steps[kept], renumbered[mesh.faces] if len(mesh.faces) else mesh.faces
    wide = len(steps) > _FEW
    return {
        "low": low.tolist(),
        "size": size.tolist(),
        "vertices": b64encode(steps.tobytes()).decode(),
        "faces": b64encode(faces.astype("<u4" if wide else "<u2").tobytes()).decode(),
        "wide": wide,
    }
