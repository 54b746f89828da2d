"""When and where the pantographs enter the line, and how long the passage lasts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tautwire.errors import ModelError
from tautwire.model.build import Model
from tautwire.model.irregularity import surface_profile
from tautwire.numerics.motion.pantograph import PantographChain
from tautwire.numerics.motion.stepper import PantographInput, RoofMotion
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.pantograph import Pantograph

LOWERED = 1.0
"""Distance of a lowered pantograph from the wire at the start [m]."""

ROOM_AT_END = 0.1
"""Distance from the far end that no pantograph passes [m]: a weighted end moves by centimetres."""


@dataclass(frozen=True, eq=False)
class Passage:
    """The plan of one passage.

    Attributes
    ----------
    pantographs : tuple of PantographInput
    duration : float s
        Until the leading pantograph has reached the far end of the line.
    latest : float s
        Until when it is on the modelled wire: a last step may not go beyond.
    warnings : tuple of str
    """

    pantographs: tuple[PantographInput, ...]
    duration: float
    latest: float
    warnings: tuple[str, ...] = ()


def plan_passage(model: Model, shape: Equilibrium, forces: Sequence[float]) -> Passage:
    """Plan the passage of all pantographs of the case.

    Each pantograph enters at the same place (``settings.start`` from the anchor), at rest and just
    touching the wire in its static position, when the train has brought it there. One without
    uplift force is lowered and does not touch the wire.

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.
    forces : (n_pantograph,) N
        Uplift force of each pantograph.

    Raises
    ------
    ModelError
        When the line is too short for the last pantograph to cross the analysed section.
    """
    case = model.case
    length = case.line.length()
    sign = 1.0 if case.scenario.direction == "+x" else -1.0
    start_x = case.settings.start if sign > 0 else length - case.settings.start
    duration = (length - 2.0 * case.settings.start) / case.scenario.speed
    _check_length(model, duration)
    wire = shape.contact_position
    height = float(np.interp(start_x, wire[:, 0], wire[:, 2]))
    surface = surface_profile(model.irregularities)
    height += 0.0 if surface is None else float(surface.at(np.array(start_x)))
    heights = [height if force > 0.0 else height - LOWERED for force in forces]
    inputs = tuple(
        PantographInput(
            chain=_chain(spec),
            start_time=spec.behind / case.scenario.speed,
            start_x=start_x,
            start_height=start,
            velocity=sign * case.scenario.speed,
            uplift_force=force,
            ramp=case.settings.ramp,
            roof=_roof(spec),
            surface=surface,
        )
        for spec, force, start in zip(case.pantographs, forces, heights, strict=True)
    )
    latest = (length - case.settings.start - ROOM_AT_END) / case.scenario.speed
    return Passage(inputs, duration, latest)


def _chain(spec: Pantograph) -> PantographChain:
    return PantographChain(
        mass=np.array([s.mass for s in spec.stages]),
        stiffness=np.array([s.stiffness for s in spec.stages]),
        damping=np.array([s.damping for s in spec.stages]),
        force_stage=spec.lifted_stage(),
    )


def _roof(spec: Pantograph) -> RoofMotion | None:
    if spec.roof_motion is None:
        return None
    return RoofMotion(np.array(spec.roof_motion.time), np.array(spec.roof_motion.height))


def _check_length(model: Model, duration: float) -> None:
    """Refuse a line that ends before the last pantograph has crossed the analysed section.

    The last ``settings.start`` of the line, which no passage reaches, is left out.
    """
    case = model.case
    first, last = case.resolved_section()
    x = case.line.support_positions()
    forward = case.scenario.direction == "+x"
    way = x[last] if forward else x[-1] - x[first - 1]
    way = min(way, x[-1] - case.settings.start)
    behind = case.pantographs[-1].behind
    reached = case.settings.start + duration * case.scenario.speed - behind
    if reached < way - 1e-9:
        raise ModelError(
            f"the line is too short: when the leading pantograph reaches its end, pantograph "
            f"{case.pantographs[-1].name!r}, {behind:g} m behind, is still "
            f"{way - reached:.0f} m inside the analysed section (spans {first} to {last}); "
            "add spans (line.spans) or end the section earlier (settings.section)"
        )
