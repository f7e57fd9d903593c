"""Energies of a robot simulated by PyBullet, from mass properties of neither the engine nor its file."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np


class Energies:
    """Energies of a body in PyBullet."""

    def __init__(self, body: int, links: Sequence[Mapping[str, Any]], gravity: Sequence[float]) -> None:
        """Record the current pose of the body.

        Args:
            body: The body in PyBullet, at rest.
            links: Links of report.json: ``name``, ``mass`` [kg], ``com`` [m] and ``inertia`` [kg m^2] about the com,
                along the link's axes.
            gravity: Acceleration of gravity [m/s^2].
        """
        import pybullet

        names = {pybullet.getBodyInfo(body)[0].decode(): -1}
        names |= {pybullet.getJointInfo(body, i)[12].decode(): i for i in range(pybullet.getNumJoints(body))}
        self._body = body
        self._links = [
            (names[link["name"]], link["mass"], np.array(link["com"]), np.array(link["inertia"])) for link in links
        ]
        self._gravity = np.array(gravity)
        self._start = self._weight_times_place()

    def given(self) -> float:
        """Work [J] of gravity on the body since the start."""
        return self._weight_times_place() - self._start

    def kinetic(self) -> float:
        """Kinetic energy [J]."""
        energy = 0.0
        for index, mass, com, inertia in self._links:
            R_WL, p_WC = self._place(index, com)
            p_WE, v_WE, w_WL = self._velocity(index)
            v_WC = v_WE + np.cross(w_WL, p_WC - p_WE)
            w_L = R_WL.T @ w_WL
            energy += 0.5 * mass * float(v_WC @ v_WC) + 0.5 * float(w_L @ inertia @ w_L)
        return energy

    def _weight_times_place(self) -> float:
        return sum(mass * float(self._gravity @ self._place(index, com)[1]) for index, mass, com, _ in self._links)

    def _place(self, index: int, com: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """R_WL of a link, and its centre of mass in the world [m]."""
        import pybullet

        if index >= 0:
            p_WL, q_WL = pybullet.getLinkState(self._body, index, computeForwardKinematics=1)[4:6]
        else:
            # PyBullet returns the base's pose as that of its inertial frame.
            X_WI = pybullet.getBasePositionAndOrientation(self._body)
            X_LI = pybullet.getDynamicsInfo(self._body, -1)[3:5]
            p_WL, q_WL = pybullet.multiplyTransforms(*X_WI, *pybullet.invertTransform(*X_LI))
        R_WL = np.array(pybullet.getMatrixFromQuaternion(q_WL)).reshape(3, 3)
        return R_WL, np.array(p_WL) + R_WL @ com

    def _velocity(self, index: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """A link's centre of mass [m], its velocity [m/s], and the link's angular velocity [rad/s], by the engine."""
        import pybullet

        if index < 0:
            place = pybullet.getBasePositionAndOrientation(self._body)[0]
            linear, angular = pybullet.getBaseVelocity(self._body)
        else:
            state = pybullet.getLinkState(self._body, index, computeLinkVelocity=1, computeForwardKinematics=1)
            place, linear, angular = state[0], state[6], state[7]
        return np.array(place), np.array(linear), np.array(angular)
