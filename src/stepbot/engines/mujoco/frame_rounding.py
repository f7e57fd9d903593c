"""Undoes a rounding of MuJoCo's compiler, so that a file is compared as it is written.

The compiler treats two frames less than 1e-6 apart, in metres and in components of the quaternion, as one
(``mjtSameFrame``): an inertial frame near the body's, and geoms and sites near either. A body whose inertial frame
counts as the body's may also be "simple", which removes entries from its mass matrix.
https://github.com/google-deepmind/mujoco/blob/main/src/user/user_objects.cc
"""

from collections.abc import Callable
from typing import Any

import numpy as np

_APART = 1.0
"""Displacement [m] of the inertial frame of a rounded body while MuJoCo compiles, beyond any rounding."""
_BODY = ("body_mass", "body_inertia", "body_ipos", "body_iquat")
_FLAGS = ("body_sameframe", "geom_sameframe", "site_sameframe")


def without_rounding(engine: Any, model: Any, spec: Callable[[], Any]) -> tuple[Any, tuple[str, ...]]:
    """A model with every frame where the file has it, and a note on the links that MuJoCo simulates otherwise.

    Args:
        engine: The module ``mujoco``.
        model: A compiled model.
        spec: Returns the specification that it was compiled from; called only if a body was rounded.
    """
    # Bodies whose inertial frame, or its rotation alone, counts as the body's without being it.
    moved = (model.body_ipos != 0.0).any(axis=1)
    turned = (model.body_iquat != (1.0, 0.0, 0.0, 0.0)).any(axis=1)
    whole = model.body_sameframe == int(engine.mjtSameFrame.mjSAMEFRAME_BODY)
    rotation = model.body_sameframe == int(engine.mjtSameFrame.mjSAMEFRAME_BODYROT)
    rounded = np.flatnonzero((whole & moved) | ((whole | rotation) & turned))
    if rounded.size:
        exact = _with_inertials_apart(spec(), model, rounded)
        for name in _BODY:
            getattr(exact, name)[:] = getattr(model, name)
        engine.mj_setConst(exact, engine.MjData(exact))
        model = exact
    for name in _FLAGS:
        getattr(model, name)[:] = int(engine.mjtSameFrame.mjSAMEFRAME_NONE)
    names = [engine.mj_id2name(model, engine.mjtObj.mjOBJ_BODY, body) or f"body {body}" for body in rounded.tolist()]
    words = "compared without MuJoCo's rounding of inertial frames less than 1e-6 from the link's:"
    return model, (f"{words} {', '.join(names)}",) if names else ()


def _with_inertials_apart(spec: Any, model: Any, rounded: Any) -> Any:
    """The model compiled again with the inertial frames of some bodies elsewhere."""
    spec.compile()  # numbers the bodies
    for body in (body for body in spec.bodies if body.id in rounded):
        body.explicitinertial = True
        body.fullinertia = [np.nan] * 6
        body.mass, body.inertia = model.body_mass[body.id], model.body_inertia[body.id]
        body.ipos = model.body_ipos[body.id] + _APART
    return spec.compile()
