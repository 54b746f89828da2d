"""Bodies on the wires as rows and marks."""

from __future__ import annotations

import numpy as np

from tautwire.line.bodies import total_mass
from tautwire.line.expand import expand
from tautwire.line.pieces import Body
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.case import Case

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
