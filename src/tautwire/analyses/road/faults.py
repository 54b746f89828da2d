"""States that a line cannot have: slack wires, arms that push, wires that cross."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import ModelError
from tautwire.line.closures import Held
from tautwire.line.labels import MastLabel, named_arms, place
from tautwire.line.pieces import At, GivenHeight, Hanger
from tautwire.model.build import Model
from tautwire.model.mesh import Strand
from tautwire.numerics.elements import ancf
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.conditions.condition import Condition

Array = NDArray[Any]

SLACK = 0.1
"""Share of its tension below which a wire is called slack: it sags ten times as much as it
should."""

_BESIDE = 2
"""Spans from a raised support within which its rise may lift a wire off its droppers."""
_SMALLEST_PULL = 10.0
"""Sideways force below which an arm hangs instead of pulling [N]: about its own weight (0.73 kg/m
over 1.22 m)."""


def refuse_pushing_droppers(model: Model, forces: Array) -> None:
    """Raise when a prescribed height asks a dropper to push.

    Parameters
    ----------
    model
    forces : (n_dropper,) N

    Raises
    ------
    ModelError
        With every dropper.
    """
    errors = 1e3 * model.irregularities.dropper_height
    hangers = model.line.hangers
    faults = [
        f"{place(hangers[i].label, hangers[i].lower.s)}, would have to push ({forces[i]:.1f} N); "
        f"{_cure_of_pushing(model, hangers[i])}"
        for i in np.flatnonzero(forces < 0.0)
        if isinstance(hangers[i].given, GivenHeight)
    ]
    if errors.any():
        faults = [
            f"{fault}; the drawn errors of height are {errors.min():.1f} to {errors.max():.1f} mm: "
            "make irregularities.installation smaller, give errors of length, or draw with another "
            "settings.seed"
            for fault in faults
        ]
    if faults:
        raise ModelError("\n".join(faults))


def _cure_of_pushing(model: Model, hanger: Hanger) -> str:
    """Tell what makes a dropper pull that would have to push."""
    line, lower = model.line, hanger.lower
    raised = [one.lower.s for one in line.hangers if one.raises and one.lower.run == lower.run]
    if hanger.raises:
        return (
            "from this support on the wire rises too steeply to its anchor: lower "
            "overlaps.anchor_rise, or raise overlaps.rise"
        )
    assert isinstance(hanger.given, GivenHeight)
    cure = (
        f"raise the contact wire there (droppers.presag, now {1e3 * hanger.given.drop:.1f} mm; a "
        "few millimetres less are usually enough) or use length mode"
    )
    masts = np.array(line.masts)
    apart = [abs(np.searchsorted(masts, s) - np.searchsorted(masts, lower.s)) for s in raised]
    return f"lower overlaps.rise, or {cure}" if apart and min(apart) <= _BESIDE else cure


def refuse_bad_arms(model: Model, held: Held) -> None:
    """Raise when a steady arm would push or has nothing to hold.

    Parameters
    ----------
    model
    held
        What holds the contact wires in the found shape.

    Raises
    ------
    ModelError
        With every arm.
    """
    faults: list[tuple[str, str]] = []
    for i in np.flatnonzero(~np.isnan(held.force)):
        piece, force = model.line.registrations[i], float(held.force[i])
        lateral = abs(force * np.cos(held.angle[i]))
        if force > 0.0 and lateral >= _SMALLEST_PULL:
            continue
        what = (
            f"would have to push ({force:.1f} N)"
            if force < 0.0
            else f"pulls sideways with only {lateral:.1f} N"
        )
        faults.append((_of_wire(model, piece.label, piece.at), what))
    if faults:
        raise ModelError(
            f"{named_arms(faults)}; give the contact wire more stagger there "
            "(supports.contact_stagger), put the arm's far end on the other side, or use closure "
            "'spring'"
        )


def refuse_crossing_wires(model: Model, shape: Equilibrium) -> None:
    """Raise when a wire hangs below one that it carries.

    Parameters
    ----------
    model
    shape

    Raises
    ------
    ModelError
        With the worst place of every pair.
    """
    if faults := list(_crossing_wires(model, shape)):
        raise ModelError("\n".join(faults))


def _of_wire(model: Model, label: MastLabel, at: At) -> str:
    """Name the place of a contact wire at a support, and the wire where there are several."""
    several = len({piece.at.run for piece in model.line.registrations}) > 1
    return f"{place(label, at.s)}{f' (of the wire {at.run!r})' if several else ''}"


def refuse_impossible(model: Model, shape: Equilibrium) -> None:
    """Raise when the state of a line under a condition breaks what the model rests on.

    Parameters
    ----------
    model
    shape
        Under a condition.

    Raises
    ------
    ModelError
        With every place.
    """
    assert shape.operated is not None
    condition = shape.operated.condition
    faults = [
        *_slack_wires(model, shape, condition),
        *_pushing_arms(model, shape),
        *_crossing_wires(model, shape),
    ]
    if faults:
        raise ModelError("\n".join(f"condition {condition.name!r}: {fault}" for fault in faults))


def _slack_wires(model: Model, shape: Equilibrium, condition: Condition) -> Iterator[str]:
    """Name every wire with hardly any tension, where it has least."""
    assert shape.operated is not None
    system = shape.operated.system
    cables = system.cables
    tension = ancf.axial_force(cables.coordinates(system.position), cables.section)
    for strand in model.mesh.strands:
        wire, own = strand.run.wire, tension[strand.cables]
        change = condition.of_wire(strand.run.wire_name)
        usual = change.tension or wire.tension
        least = int(own.argmin())
        if own[least] >= SLACK * usual or not cables.axial[strand.cables].any():
            continue
        reason = ""
        if condition.warming(change) > 0.0 and wire.thermal_expansion:
            limit = usual / (wire.axial_stiffness * wire.thermal_expansion)
            reason = (
                f"; a flat wire between fixed ends loses its {1e-3 * usual:g} kN over "
                f"{limit:.0f} K, and it is {condition.warming(change):.0f} K warmer than in the "
                "design: give the ends weights (line.ends), or look at a smaller warming"
            )
        yield (
            f"wire {strand.run.name!r} is slack in {_span(model, strand, least)}, with "
            f"{max(float(own[least]), 0.0):.0f} N of its {usual:.0f} N{reason}"
        )


def _span(model: Model, strand: Strand, element: int) -> str:
    """Name the span in which an element lies."""
    s = 0.5 * float(strand.s[element] + strand.s[element + 1])
    number = int(np.searchsorted(model.line.masts[1:-1], s, side="right")) + 1
    return f"span {number}, x = {s:.1f} m"


def _pushing_arms(model: Model, shape: Equilibrium) -> Iterator[str]:
    """Name all steady arms in compression, in one sentence: they have one cause."""
    places = model.line.contact_supports
    pushing = [
        (_of_wire(model, label, at), f"would have to push ({force:.1f} N)")
        for row, force in zip(shape.arm_supports - 1, shape.arm_forces, strict=True)
        for label, at in [places[row]]
        if force < 0.0
    ]
    if pushing:
        yield (
            f"{named_arms(pushing)}: the wind or another load takes the wire from it; give the "
            "contact wire more stagger there (supports.contact_stagger), or look at less wind"
        )


def _crossing_wires(model: Model, shape: Equilibrium) -> Iterator[str]:
    """Name the worst place at which a wire hangs below the one that it carries."""
    pairs = {(hanger.upper.run, hanger.lower.run): None for hanger in model.line.hangers}
    for upper, lower in pairs:
        above, below = shape.wire(upper), shape.wire(lower)
        x, z = below.position[:, 0], below.position[:, 2]
        mine = above.position[:, 0]
        inside = (mine >= x[0]) & (mine <= x[-1])
        gap = np.where(inside, above.position[:, 2] - np.interp(mine, x, z), np.inf)
        worst = int(gap.argmin())
        if gap[worst] <= 0.0:
            span = _span(model, model.mesh.strand(upper), min(worst, len(mine) - 2))
            low, high = _carried(model, lower)
            why = (
                "it sags too much; give it more tension or the line more encumbrance "
                "(supports.encumbrance)"
                if low <= mine[worst] <= high
                else "the wire that it carries rises too far; lower overlaps.anchor_rise and "
                "overlaps.rise"
            )
            yield (
                f"wire {upper!r} hangs {-1e3 * gap[worst]:.0f} mm below {lower!r}, which it "
                f"carries, in {span}: {why}"
            )


def _carried(model: Model, run: str) -> tuple[float, float]:
    """Return the first and the last place at which droppers carry a run [m]."""
    places = [h.lower.s for h in model.line.hangers if h.lower.run == run and not h.raises]
    return min(places, default=np.inf), max(places, default=-np.inf)
