"""States that a line cannot have: slack wires, arms that push, wires that cross."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import ModelError
from tautwire.line.labels import named_arms, place
from tautwire.model.build import Model
from tautwire.model.mesh import Strand
from tautwire.numerics.elements import ancf
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.conditions.condition import Condition

Array = NDArray[Any]

SLACK = 0.1
"""Share of its tension below which a wire is called slack: it sags ten times as much as it
should."""


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
        (place(label, at.s), f"would have to push ({force:.1f} N)")
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
            yield (
                f"wire {upper!r} hangs {-1e3 * gap[worst]:.0f} mm below {lower!r}, which it "
                f"carries, in {span}: it sags too much under this load or warmth; give it more "
                "tension or the line more encumbrance (supports.encumbrance)"
            )
