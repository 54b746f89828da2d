"""The line at its static state: the arrays on which elasticity, modes and dynamics work."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.model.build import Model, arm_half_weight, interior_support_nodes
from tautwire.model.mesh import CONTACT, MESSENGER
from tautwire.numerics.system import System, weight_load
from tautwire.results.equilibrium import Equilibrium

Array = NDArray[Any]


def equations(model: Model, shape: Equilibrium) -> System:
    """Return the line with all its supports, at rest in the found shape.

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.

    Returns
    -------
    System
        ``position`` is an equilibrium of this system.
    """
    case, mesh = model.case, model.mesh
    system = model.form.system.with_(
        position=shape.position,
        cable_length=shape.cable_lengths,
        dropper_length=shape.dropper_lengths_unstrained,
        fixed=_fixed(model),
        load=_static_loads(model, shape),
        **_arms(model, shape),
        **_springs(model, shape),
    )
    axial = model.form.dropper_axial_stiffness
    if axial is not None:
        system = system.with_(dropper_stiffness=axial / system.dropper_length)
    half = 0.5 * case.droppers.mass * system.dropper_length
    mass = system.node_mass.copy()
    mass[2 * mesh.dropper_station + CONTACT] += half
    mass[2 * mesh.dropper_station + MESSENGER] += half
    weight = weight_load(system, case.droppers.mass, case.line.gravity)
    return system.with_(node_mass=mass, load=system.load + weight)


def _fixed(model: Model) -> NDArray[np.bool_]:
    """Return the degrees of freedom that never move."""
    case, mesh = model.case, model.mesh
    fixed = np.zeros((mesh.station_count, 2, 6), dtype=bool)
    for station, end in ((0, case.line.ends.left), (-1, case.line.ends.right)):
        fixed[station, :, 1:3] = True
        fixed[station, :, 0] = end == "anchored"
    inner = mesh.support_station[1:-1]
    fixed[inner, MESSENGER, 1] = True
    fixed[inner, MESSENGER, 0] = case.supports.messenger_longitudinal == "fixed"
    if case.supports.closure == "spring":
        fixed[inner, CONTACT, 1] = True
    return fixed.ravel()


def _static_loads(model: Model, shape: Equilibrium) -> Array:
    """Return the loads that do not depend on unstrained lengths."""
    case, mesh = model.case, model.mesh
    load = np.zeros((mesh.station_count, 2, 6))
    load[:, :, 2] -= (model.form.system.node_mass * case.line.gravity).reshape(-1, 2)
    load[0, :, 0] += shape.end_pulls[0]
    load[-1, :, 0] += shape.end_pulls[1]
    inner = mesh.support_station[1:-1]
    if case.supports.closure == "spring":
        load[inner, CONTACT, 2] += shape.contact_preloads
    else:
        load[inner, CONTACT, 2] -= arm_half_weight(case)
    return load.ravel()


def _arms(model: Model, shape: Equilibrium) -> dict[str, Any]:
    count = len(shape.arm_supports)
    spec = model.case.supports.arm
    return {
        "arm_nodes": 2 * model.mesh.support_station[shape.arm_supports - 1] + CONTACT,
        "arm_ends": shape.arm_ends,
        "arm_length": np.full(count, spec.length),
        "arm_stiffness": np.full(count, spec.axial_stiffness / spec.length),
        "arm_mass": np.full(count, spec.mass * spec.length),
    }


def _springs(model: Model, shape: Equilibrium) -> dict[str, Any]:
    """Return the grounded springs: messenger-wire supports, spring supports of the contact wire.

    The preload of the latter is a load; the spring itself counts from the static height, which
    includes springs without stiffness (constant-force supports).
    """
    spec, mesh = model.case.supports, model.mesh
    dofs = [6 * interior_support_nodes(mesh, MESSENGER) + 2]
    stiffness = [np.full(len(dofs[0]), spec.messenger_stiffness)]
    damping = [np.full(len(dofs[0]), spec.messenger_damping)]
    free = [shape.messenger_free_heights]
    if spec.closure == "spring" and spec.spring is not None:
        dofs.append(6 * interior_support_nodes(mesh, CONTACT) + 2)
        stiffness.append(np.full(len(dofs[1]), spec.spring.stiffness))
        damping.append(np.full(len(dofs[1]), spec.spring.damping))
        free.append(shape.support_heights[1:-1])
    return {
        "spring_dofs": np.concatenate(dofs),
        "spring_stiffness": np.concatenate(stiffness),
        "spring_damping": np.concatenate(damping),
        "spring_free": np.concatenate(free),
    }
