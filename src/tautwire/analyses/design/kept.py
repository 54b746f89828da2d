"""Whether a state of a line keeps what is required of arms and of distances to structures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from tautwire.analyses.design.supports import SupportForce
from tautwire.model.build import Model
from tautwire.plain import Plain, named
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.requirements import Structure


@dataclass(frozen=True)
class Clearance(Plain):
    """The distance of the wires from a structure over them, with passing pantographs.

    Attributes
    ----------
    structure : str
    x : float m
        Place of the highest wire under it.
    wire : str
    height : float m
        Of this wire at rest.
    left_over : float m
        Distance from the lifted wire to the structure.
    required : float m
    is_kept : bool
    """

    structure: str
    x: float = field(metadata=named("x_m"))
    wire: str
    height: float = field(metadata=named("height_m"))
    left_over: float = field(metadata=named("clearance_m"))
    required: float = field(metadata=named("required_m"))
    is_kept: bool


_STEP = 0.25
"""Distance of the places at which heights under a structure are taken [m]: a wire of 10 kN and
1 kg/m bends by 0.03 mm from the chord between them."""


def clearances(model: Model, shape: Equilibrium) -> tuple[Clearance, ...]:
    """Return the distances of the wires from the structures over the line.

    ``height of the structure - (height of the wire + uplift)``, for the wire that is highest there;
    in the frame of the track.

    Parameters
    ----------
    model
        With the condition chosen.
    shape
        In this condition.
    """
    return tuple(_clearance(shape, one) for one in model.case.requirements.structures)


def _clearance(shape: Equilibrium, one: Structure) -> Clearance:
    x = np.linspace(one.at, one.at + one.length, int(np.ceil(one.length / _STEP)) + 1)
    heights = np.array(
        [
            np.interp(x, wire.position[:, 0], wire.position[:, 2], left=-np.inf, right=-np.inf)
            for wire in shape.wires
        ]
    )
    wire, place = np.unravel_index(int(heights.argmax()), heights.shape)
    height = float(heights[wire, place])
    left = one.height - height - one.uplift
    return Clearance(
        structure=one.name,
        x=float(x[place]),
        wire=shape.wire_names[int(wire)],
        height=height,
        left_over=left,
        required=one.clearance,
        is_kept=left >= one.clearance,
    )


def exceeded(
    model: Model, forces: Sequence[SupportForce], distances: Sequence[Clearance]
) -> tuple[str, ...]:
    """Name every arm and structure whose requirement is not kept.

    Parameters
    ----------
    model
        The line.
    forces
        Of a state, see :func:`support_forces`.
    distances
        Of the same state, see :func:`clearances`.
    """
    return (*_arms(model, forces), *_structures(distances))


def _arms(model: Model, forces: Sequence[SupportForce]) -> Iterator[str]:
    required = model.case.requirements.arm_pull
    if required is None or model.case.supports.closure == "spring":
        return
    for one in forces:
        if one.held_by != "registration":
            continue
        pull, (least, most) = abs(one.lateral), required.limits(one.support)
        where = f"the steady arm of {one.wire!r} at support {one.support}, x = {one.x:g} m,"
        if most is not None and pull > most:
            yield f"{where} pulls {pull:.0f} N, more than {most:g} N"
        if least is not None and pull < least:
            yield f"{where} pulls {pull:.0f} N, less than {least:g} N"


def _structures(distances: Sequence[Clearance]) -> Iterator[str]:
    for one in distances:
        if not one.is_kept:
            yield (
                f"{one.structure}: {1e3 * one.left_over:.0f} mm are left above {one.wire!r} at "
                f"x = {one.x:.1f} m, less than {1e3 * one.required:.0f} mm"
            )
