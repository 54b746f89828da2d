"""The tension of the wires along the line, span by span."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from tautwire.model.build import Model
from tautwire.model.equations import equations
from tautwire.numerics.elements import ancf
from tautwire.plain import Plain, named
from tautwire.results.equilibrium import Equilibrium


@dataclass(frozen=True)
class TensionProfile(Plain):
    """The tension of one wire along the line.

    Attributes
    ----------
    wire : str
    spans : tuple of int
        From 1.
    x : tuple of float m
        Middles of these spans.
    tension : tuple of float N
        Mean over each span.
    """

    wire: str
    spans: tuple[int, ...]
    x: tuple[float, ...] = field(metadata=named("x_m"))
    tension: tuple[float, ...] = field(metadata=named("tension_n"))


def tension_profiles(model: Model, shape: Equilibrium) -> tuple[TensionProfile, ...]:
    """Return the tension of every wire that runs from anchor to anchor.

    Parameters
    ----------
    model
        With the condition chosen.
    shape
        In this condition.
    """
    system = equations(model, shape)
    cables = system.cables
    force = ancf.axial_force(cables.coordinates(system.position), cables.section)
    masts = np.array(model.line.masts)
    found = []
    for strand in model.mesh.strands:
        if strand.run.start.kind == "clamped":
            continue
        middle, length = 0.5 * (strand.s[1:] + strand.s[:-1]), np.diff(strand.s)
        span = np.searchsorted(masts[1:-1], middle, side="right") + 1
        numbers = np.unique(span)
        means = [
            np.average(force[strand.cables][span == n], weights=length[span == n]) for n in numbers
        ]
        at = 0.5 * (masts[numbers - 1] + masts[numbers])
        found.append(
            TensionProfile(
                strand.run.name,
                tuple(numbers.tolist()),
                tuple(at.tolist()),
                tuple(float(mean) for mean in means),
            )
        )
    return tuple(found)
