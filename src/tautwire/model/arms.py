"""Steady arms with a given far end (closure ``arm``)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import ModelError
from tautwire.model.mesh import CONTACT, Mesh
from tautwire.numerics.network.parts import BOTH_WAYS, Stays
from tautwire.specs.case import Case
from tautwire.specs.line.support import Arm

Array = NDArray[np.float64]


def given_arms(case: Case, mesh: Mesh, height: Array, y: Array) -> Stays:
    """Return the steady arms of the system; none unless far ends are given.

    Parameters
    ----------
    case
        The line.
    mesh
        Its stations.
    height, y : (n_support,) m
        Nominal position of the contact wire at the supports.
    """
    spec = case.supports
    count = len(mesh.support_station) - 2 if spec.closure == "arm" else 0
    stations = mesh.support_station[1:-1][:count]
    ends = _far_ends(case, mesh, height, y) if count else np.empty((0, 3))
    return steady_arms(spec.arm, 2 * stations + CONTACT, ends)


def steady_arms(arm: Arm, nodes: NDArray[np.int64], ends: Array) -> Stays:
    """Return equal steady arms at some nodes, ``(n_arm,)``, with far ends ``(n_arm, 3)`` [m]."""
    count = len(nodes)
    return Stays(
        node=nodes,
        end=ends,
        length=np.full(count, arm.length),
        stiffness=np.full(count, arm.axial_stiffness / arm.length),
        mass=np.full(count, arm.mass * arm.length),
        law=np.full(count, BOTH_WAYS),
    )


def _far_ends(case: Case, mesh: Mesh, height: Array, y: Array) -> Array:
    spec = case.supports
    x = mesh.support_x[1:-1]
    if spec.arm_end_y is not None and spec.arm_end_z is not None:
        given = np.array([spec.arm_end_y[1:-1], spec.arm_end_z[1:-1]], dtype=float)
        return np.column_stack([x, given[0], given[1]])
    angle = float(spec.arm.angle or 0.0)
    side = _pulling_side(mesh.support_x, y)
    reach = spec.arm.length * np.cos(angle)
    rise = spec.arm.length * np.sin(angle)
    return np.column_stack([x, y[1:-1] + side * reach, height[1:-1] + rise])


def _pulling_side(x: Array, y: Array) -> Array:
    """Return +1 or -1: the side to which an arm must pull to hold the stagger."""
    bend = np.diff(np.diff(y) / np.diff(x))
    faults = [
        f"support {i + 2}, x = {x[i + 1]:.2f} m: the contact wire runs straight there, so a steady "
        "arm has nothing to pull; give it stagger (supports.contact_stagger), give the far ends "
        "(arm_end_y, arm_end_z) or use closure 'spring'"
        for i in np.flatnonzero(np.abs(bend) < 1e-6)
    ]
    if faults:
        raise ModelError("\n".join(faults))
    return -np.sign(bend)
