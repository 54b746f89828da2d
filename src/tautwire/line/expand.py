"""From the words of a case to the pieces of its line.

The only reader of spans, positions and pre-sags.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from tautwire.errors import ModelError
from tautwire.line.closures import Closure, GivenArm, Height, Lift, Spring
from tautwire.line.labels import HangerLabel, MastLabel, place
from tautwire.line.pieces import (
    At,
    End,
    GivenHeight,
    GivenLength,
    Hanger,
    Line,
    Registration,
    Role,
    Run,
    Suspension,
)
from tautwire.specs.case import Case
from tautwire.specs.line.support import Supports

STRAIGHT = 1e-6
"""Change of direction [rad] below which a wire runs straight past a support."""


def expand(case: Case) -> Line:
    """Return the pieces of the line that a case describes.

    Parameters
    ----------
    case
        A validated case.

    Raises
    ------
    ModelError
        When steady arms have nothing to pull; every one of them is named.
    """
    masts = case.line.support_positions()
    return Line(
        masts=masts,
        runs=tuple(_runs(case, masts)),
        hangers=tuple(_hangers(case, masts)),
        registrations=tuple(_registrations(case, masts)),
        suspensions=tuple(_suspensions(case, masts)),
    )


def _runs(case: Case, masts: tuple[float, ...]) -> Iterator[Run]:
    spec, count, ends = case.supports, len(masts), case.line.ends
    contact_z = spec.contact_heights(count)
    messenger_z = [z + e for z, e in zip(contact_z, spec.encumbrances(count), strict=True)]
    roles: tuple[Role, Role] = ("contact", "messenger")
    heights = (contact_z, messenger_z)
    laterals = (spec.contact_staggers(count), spec.messenger_staggers(count))
    for role, y, z in zip(roles, laterals, heights, strict=True):
        wire = case.wires.contact if role == "contact" else case.wires.messenger
        start = End(masts[0], y[0], z[0], ends.left)
        yield Run(role, wire, role, start, End(masts[-1], y[-1], z[-1], ends.right))


def _hangers(case: Case, masts: tuple[float, ...]) -> Iterator[Hanger]:
    spec, spans = case.droppers, case.line.spans
    positions = spec.positions_by_span(spans)
    heights = case.supports.contact_heights(len(masts))
    drops, lengths = spec.presag_by_span(spans), spec.lengths_by_span(spans)
    for span, in_span in enumerate(positions):
        for index, position in enumerate(in_span):
            s = masts[span] + position
            if spec.mode == "height":
                level = float(np.interp(s, masts, heights))
                given = GivenHeight(level, drops[span][index])
            else:
                given = GivenLength(lengths[span][index], spec.length_kind == "stretched")
            yield Hanger(
                label=HangerLabel.of_index(span, index),
                upper=At("messenger", s),
                lower=At("contact", s),
                given=given,
                stiffness=spec.stiffness,
                mass=spec.mass,
                clamps=(spec.clamp_messenger, spec.clamp_contact),
            )


def _closure(spec: Supports) -> Closure:
    if spec.closure == "spring" and spec.spring is not None:
        return Spring(spec.spring)
    if spec.closure == "lift":
        return Lift(spec.arm, spec.lift)
    return GivenArm(spec.arm) if spec.closure == "arm" else Height(spec.arm)


def _registrations(case: Case, masts: tuple[float, ...]) -> Iterator[Registration]:
    spec, count = case.supports, len(masts)
    y, z = spec.contact_staggers(count), spec.contact_heights(count)
    ends = _arm_ends(spec, masts, y, z) if spec.closure == "arm" else {}
    kind = _closure(spec)
    for mast in range(1, count - 1):
        yield Registration(
            label=MastLabel.of_index(mast),
            at=At("contact", masts[mast]),
            y=y[mast],
            z=z[mast],
            kind=kind,
            clamp=spec.clamp,
            end=ends.get(mast),
        )


def _arm_ends(
    spec: Supports, masts: tuple[float, ...], y: tuple[float, ...], z: tuple[float, ...]
) -> dict[int, tuple[float, float]]:
    """Return the far ends (y, z) of given arms by index of the support [m]."""
    inner = range(1, len(masts) - 1)
    if spec.arm_end_y is not None and spec.arm_end_z is not None:
        given = zip(spec.arm_end_y, spec.arm_end_z, strict=True)
        return {
            mast: (end_y, end_z)
            for mast, (end_y, end_z) in enumerate(given)
            if mast in inner and end_y is not None and end_z is not None
        }
    angle = float(spec.arm.angle or 0.0)
    side = _pulling_sides(masts, y)
    reach, rise = spec.arm.length * np.cos(angle), spec.arm.length * np.sin(angle)
    return {m: (float(y[m] + side[m - 1] * reach), float(z[m] + rise)) for m in inner}


def _pulling_sides(masts: tuple[float, ...], y: tuple[float, ...]) -> list[float]:
    """Return +1 or -1 for each support: the side to which its arm must pull."""
    bend = np.diff(np.diff(y) / np.diff(masts))
    faults = [
        f"{place(MastLabel.of_index(int(i) + 1), masts[i + 1])}: the contact wire runs straight "
        "there, so a steady arm has nothing to pull; give it stagger (supports.contact_stagger), "
        "give the far ends (arm_end_y, arm_end_z) or use closure 'spring'"
        for i in np.flatnonzero(np.abs(bend) < STRAIGHT)
    ]
    if faults:
        raise ModelError("\n".join(faults))
    return list(-np.sign(bend))


def _suspensions(case: Case, masts: tuple[float, ...]) -> Iterator[Suspension]:
    spec, count = case.supports, len(masts)
    y = spec.messenger_staggers(count)
    z = [c + e for c, e in zip(spec.contact_heights(count), spec.encumbrances(count), strict=True)]
    for mast in range(1, count - 1):
        yield Suspension(
            label=MastLabel.of_index(mast),
            at=At("messenger", masts[mast]),
            y=y[mast],
            z=z[mast],
            stiffness=spec.messenger_stiffness,
            damping=spec.messenger_damping,
            is_fixed_along=spec.messenger_longitudinal == "fixed",
        )
