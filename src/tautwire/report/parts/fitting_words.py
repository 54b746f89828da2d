"""Bodies and stays on the wires as rows and marks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tautwire.line.expand import expand
from tautwire.line.fittings import total_mass
from tautwire.line.pieces import Body, WireStay
from tautwire.numerics.network.parts import law_allows
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.case import Case

Array = NDArray[np.float64]
BODY_HEAD = ("body", "wire", "from\n[m]", "to\n[m]", "mass\n[kg]", "height, left\n[m]",
             "height, right\n[m]")  # fmt: skip


def bodies_of(case: Case) -> tuple[Body, ...]:
    """Return the bodies of a case in their places, from left to right."""
    return expand(case).bodies if case.bodies else ()


def body_heights(shape: Equilibrium, body: Body) -> tuple[float, float]:
    """Return how high both ends of a body are above the rails [m]."""
    wire = shape.wires[shape.wire_names.index(body.run)]
    left, right = np.interp((body.start, body.end), wire.position[:, 0], wire.position[:, 2])
    return float(left), float(right)


def body_rows(case: Case, shape: Equilibrium) -> list[tuple[str, ...]]:
    """Return one row per body: name, wire, place, mass and heights of its ends."""
    if not case.bodies:
        return []
    line = expand(case)
    return [
        (
            body.name,
            body.run,
            f"{body.start:.3f}",
            f"{body.end:.3f}",
            f"{total_mass(line, body):.2f}",
            *(f"{height:.4f}" for height in body_heights(shape, body)),
        )
        for body in line.bodies
    ]


STAY_HEAD = ("stay", "wire", "at\n[m]", "length\n[m]", "force\n[N]")


def stay_rows(case: Case, shape: Equilibrium) -> list[tuple[str, ...]]:
    """Return one row per stay: name, wire, place, distance of its ends, force (pull positive)."""
    found = []
    for stay in stays_of(case):
        distance, force = stay_state(shape, stay)
        found.append(
            (stay.name, stay.at.run, f"{stay.at.s:.3f}", f"{distance:.3f}", f"{force:.1f}")
        )
    return found


def stays_of(case: Case) -> tuple[WireStay, ...]:
    """Return the stays of a case in their places, from left to right."""
    return expand(case).stays if case.stays else ()


def stay_state(shape: Equilibrium, stay: WireStay) -> tuple[float, float]:
    """Return the distance of a stay's ends [m] and its axial force, tension positive [N]."""
    design = shape if shape.operated is None else shape.operated.design
    distance = _apart(shape, stay)
    force = stay.stiffness * (distance - stay.length(_apart(design, stay), stay.pull))
    allowed = law_allows(np.array([stay.law]), np.array([force]))
    return distance, float(np.where(allowed, force, 0.0)[0])


def stay_place(shape: Equilibrium, stay: WireStay) -> Array:
    """Return where a stay is on its wire: along the track, lateral, height, ``(3,)`` [m]."""
    wire = shape.wires[shape.wire_names.index(stay.at.run)]
    return wire.position[int(np.abs(wire.s - stay.at.s).argmin())]


def _apart(shape: Equilibrium, stay: WireStay) -> float:
    far = np.array(stay.end) + np.array([stay.at.s, 0.0, 0.0])
    return float(np.linalg.norm(far - stay_place(shape, stay)))
