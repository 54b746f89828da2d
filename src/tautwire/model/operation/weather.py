"""Temperature, ice, wind and wear on the arrays of a line.

Lengths are those of the unstrained wires, ``L0 (1 + alpha dT)``; what is told per length of wire
counts its stretched length in the design. A body in the line of a wire grows with the temperature
and meets ice and wind as the wire does, but does not wear.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.formulas.wear import bending_left, height_left
from tautwire.line.fittings import sections
from tautwire.line.pieces import Hanger, Run
from tautwire.model.build import Model
from tautwire.numerics.elements import ancf
from tautwire.numerics.network.parts import Cables, Ties
from tautwire.numerics.network.system import System, weight_load
from tautwire.specs.conditions.condition import Condition

Array = NDArray[Any]


def in_weather(
    model: Model, system: System, condition: Condition, missing: Collection[int] = ()
) -> System:
    """Return a line at the temperature of a condition, iced, worn and in its wind.

    Its weight is still the old one, see :func:`reweighed`.

    Parameters
    ----------
    model
    system
        At rest in its design.
    condition
    missing
        Rows of droppers that are not there.
    """
    cables, wind = _wires(model, system, condition)
    ties, load = _droppers(model, system, condition, missing)
    return system.with_(cables=cables, ties=ties, load=system.load + wind + load)


def reweighed(before: System, after: System, lumps: Array, gravity: float) -> System:
    """Return a changed line with the masses of its nodes and with its weight.

    Parameters
    ----------
    before
        With its weight among the loads.
    after
        With other lengths and masses of wires and droppers.
    lumps : (n_node,) kg
        Added to the nodes.
    gravity
        [m/s2]
    """
    count = before.node_count
    hung = after.ties.hanging_mass(count) - before.ties.hanging_mass(count)
    load = after.load + weight_load(after, gravity) - weight_load(before, gravity)
    load[2::6] -= gravity * lumps
    return after.with_(node_mass=after.node_mass + hung + lumps, load=load)


def _across(model: Model) -> Array:
    """Return the horizontal normal of the track at every node, to the left, ``(n_node, 3)``."""
    t = model.mesh.frames.axes[:, 0]
    level = np.stack([-t[:, 1], t[:, 0], np.zeros(len(t))], axis=1)
    return level / np.linalg.norm(level, axis=1, keepdims=True)


def _wires(model: Model, system: System, condition: Condition) -> tuple[Cables, Array]:
    """Return the wire elements and the wind on them as nodal loads."""
    cables = system.cables
    rows = np.array([_wire_numbers(strand.run, condition) for strand in model.mesh.strands])
    of_cable = np.empty(len(cables), dtype=np.int64)
    is_body = np.empty(len(cables), dtype=bool)
    for number, strand in enumerate(model.mesh.strands):
        of_cable[strand.cables] = number
        is_body[strand.cables] = sections(model.line, strand.run, strand.s).is_body
    growth, left, bending, ice, wind = rows[of_cable].T
    left, bending = (np.where(is_body, 1.0, share) for share in (left, bending))
    r = system.position.reshape(-1, 6)[:, :3]
    ends = r[cables.nodes]
    stretch = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / cables.length
    changed = cables.with_(
        length=cables.length * growth,
        axial=cables.axial * left,
        bending=cables.bending * bending,
        mass=cables.mass * left / growth + ice * stretch,
    )
    across = _across(model)[cables.nodes].mean(axis=1)
    pressure = -ancf.weight(changed.length, wind * stretch, 1.0)
    total = np.zeros(system.dof_count)
    cables.add_forces(total, pressure[:, None] * across.T)
    return changed, total


def _wire_numbers(run: Run, condition: Condition) -> tuple[float, float, float, float, float]:
    """Return growth of length, shares of section and of EI left, ice [kg/m], wind [N/m]."""
    change, wire = condition.of_wire(run.wire_name), run.wire
    growth = 1.0 + (wire.thermal_expansion or 0.0) * condition.warming(change)
    worn = 0.0
    if run.role == "contact":
        worn = condition.wear if change.wear is None else change.wear
    height = (wire.diameter or 0.0) * height_left(worn)
    ice = condition.ice_on(change)
    mass, outer = (0.0, height) if ice is None else ice.around(wire.diameter or 0.0)
    wind = condition.wind_pressure(change) * outer
    return growth, 1.0 - worn, bending_left(worn), mass, wind


def wind_on(run: Run, condition: Condition) -> float:
    """Return the size of the wind's load per length on a wire [N/m]."""
    return abs(_wire_numbers(run, condition)[-1])


def _droppers(
    model: Model, system: System, condition: Condition, missing: Collection[int]
) -> tuple[Ties, Array]:
    """Return the droppers and the wind on them, half of it on either end."""
    ties, line = system.ties, model.line
    numbers = [
        (1.0, 0.0, 0.0) if row in missing else _dropper_numbers(hanger, condition)
        for row, hanger in enumerate(line.hangers)
    ]
    numbers += [(1.0, 0.0, 0.0)] * (len(ties) - len(numbers))  # arms on elastic heels
    growth, ice, wind = np.array(numbers).reshape(-1, 3).T
    length = ties.state(system.position).length
    changed = ties.of_length(ties.length * growth)
    changed = changed.with_(mass=ties.mass / growth + ice)
    half = 0.5 * wind * length
    total = np.zeros((system.node_count, 6))
    across = _across(model)
    for side in (0, 1):
        nodes = ties.nodes[:, side]
        np.add.at(total[:, :3], nodes, half[:, None] * across[nodes])
    return changed, total.ravel()


def _dropper_numbers(hanger: Hanger, condition: Condition) -> tuple[float, float, float]:
    """Return growth of length, ice [kg/m] and wind [N/m] of a dropper."""
    change = condition.droppers
    growth = 1.0 + (hanger.thermal_expansion or 0.0) * condition.warming(change)
    ice = condition.ice_on(change, is_dropper=True)
    diameter = hanger.diameter or 0.0
    mass, outer = (0.0, diameter) if ice is None else ice.around(diameter)
    return growth, mass, condition.wind_pressure(change) * outer
