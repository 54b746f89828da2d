"""From the words of a case to the pieces of its line.

The only reader of spans, positions and pre-sags.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from itertools import chain
from weakref import finalize

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import InputError
from tautwire.line.alignment import alignment
from tautwire.line.closures import Closure, GivenArm, Height, Lift, Spring
from tautwire.line.defects import marks, misplaced
from tautwire.line.fittings import with_fittings
from tautwire.line.labels import HangerLabel, MastLabel
from tautwire.line.measures import SAME_PLACE
from tautwire.line.pieces import (
    At,
    End,
    GivenHeight,
    GivenLength,
    Hanger,
    Joint,
    Line,
    Registration,
    Run,
    Suspension,
)
from tautwire.line.plan import Plan, plans
from tautwire.line.registration import arm_ends
from tautwire.numerics.track import Track
from tautwire.specs.case import Case
from tautwire.specs.line.catenary import Device, EndWord
from tautwire.specs.line.dropper import Droppers
from tautwire.specs.line.support import Supports
from tautwire.specs.line.wire import Wire

Values = tuple[float, ...]
Array = NDArray[np.float64]


_KNOWN: dict[int, Line] = {}
"""Lines by the identity of their cases, as long as these live: model, checks and statistics of a
run read the same line seven times."""


def expand(case: Case) -> Line:
    """Return the pieces of the line that a case describes.

    Parameters
    ----------
    case
        A validated case.

    Raises
    ------
    InputError
        When defects are where nothing is, or bodies and stays have no place; all are named.
    ModelError
        When steady arms have nothing to pull, or a wire has no room to rise; all are named.
    """
    line = _KNOWN.get(id(case))
    if line is None:
        line = _KNOWN[id(case)] = _expanded(case)
        finalize(case, _KNOWN.pop, id(case), None)
    return line


def _expanded(case: Case) -> Line:
    track = alignment(case.track, case.line)
    whole = plans(case, track)
    parts = [_Expansion(case, plan) for plan in whole]
    runs = [run for part in parts for run in part.runs()]
    hangers = [hanger for part in parts for hanger in part.hangers]
    registrations = [r for part in parts for r in part.registrations(track)]
    suspensions = [s for part in parts for s in part.suspensions()]
    joints = [joint for part in parts for joint in part.joints()]
    carried = len({hanger.lower.run for hanger in hangers})
    line = Line(
        track=track,
        masts=case.line.support_positions(),
        runs=tuple(runs),
        hangers=_numbered(hangers, case.line.support_positions(), carried),
        registrations=tuple(sorted(registrations, key=lambda piece: piece.at.s)),
        suspensions=tuple(sorted(suspensions, key=lambda piece: piece.at.s)),
        joints=tuple(joints),
        marks=tuple(marks(runs, case.line.support_positions(), case.conditions)),
    )
    line, problems = with_fittings(line, case)
    problems += misplaced(line, case.conditions)
    if problems:
        raise InputError(problems)
    return line


class _Expansion:
    """The pieces of one tension length."""

    def __init__(self, case: Case, plan: Plan) -> None:
        self.case, self.plan = case, plan
        self.masts = case.line.support_positions()
        count = len(self.masts)
        spec = case.supports
        self.contact_z = plan.contact_z
        self.messenger_z = _sum(spec.contact_heights(count), spec.encumbrances(count))
        self.contact_y = _sum(spec.contact_staggers(count), plan.shift)
        self.messenger_y = _sum(spec.messenger_staggers(count), plan.shift)
        self.wires = dict(case.wires.named())
        self.mast_places = np.array(self.masts)

    @cached_property
    def levels(self) -> dict[str, Array]:
        """Heights of every wire at all masts, without pre-sag, by its name [m]."""
        running = self.case.supports.contact_heights(len(self.masts))
        return {
            name: np.array(running if wire.role == "contact" else self._place(wire)[1])
            for name, wire in self.wires.items()
        }

    def runs(self) -> Iterator[Run]:
        for name, wire in self.wires.items():
            if wire.role == "stitch":
                yield from self._stitches(name, wire)
                continue
            y, z = self._place(wire)
            assert wire.role is not None
            first, last, ends = self.plan.first, self.plan.last, self.plan.ends
            yield Run(
                self.plan.run(name),
                wire,
                wire.role,
                _end(self.masts[first], y[first], z[first], ends.left),
                _end(self.masts[last], y[last], z[last], ends.right),
                name,
                self.plan.name,
            )

    def _place(self, wire: Wire) -> tuple[Values, Values]:
        """Return lateral position and height of a wire at all masts."""
        if wire.role == "contact":
            return tuple(y + wire.side for y in self.contact_y), self.contact_z
        below = wire.below or 0.0
        return self.messenger_y, tuple(z - below for z in self.messenger_z)

    def _stitched_masts(self) -> list[int]:
        return [mast for mast in self.plan.inner if mast not in self.plan.raised]

    def _stitches(self, name: str, wire: Wire) -> Iterator[Run]:
        host = self.plan.run(wire.clamped_to or "")
        for mast in self._stitched_masts():
            ends = [
                End(
                    s=self.masts[mast] + float(offset or 0.0),
                    y=self._lateral(self.masts[mast] + float(offset or 0.0)),
                    z=self.messenger_z[mast],
                    kind="clamped",
                    host=host,
                )
                for offset in (wire.from_, wire.to)
            ]
            yield Run(
                self._stitch(name, mast), wire, "stitch", ends[0], ends[1], name, self.plan.name
            )

    def _stitch(self, name: str, mast: int) -> str:
        return f"{self.plan.run(name)} {MastLabel.of_index(mast).number}"

    def _lateral(self, s: float) -> float:
        return float(np.interp(s, self.mast_places, self.messenger_y))

    def joints(self) -> Iterator[Joint]:
        for run in self.runs():
            for end in (run.start, run.end):
                if end.kind == "clamped":
                    yield Joint(At(end.host, end.s), At(run.name, end.s), run.wire.clamp)

    @cached_property
    def hangers(self) -> tuple[Hanger, ...]:
        """All hangers, set by set, then those of raised wires."""
        sets = [
            self._about_masts(one) if one.about == "mast" else self._in_spans(one)
            for one in self.case.dropper_sets
            if one.tension_length in (None, self.plan.name)
        ]
        return tuple(chain(*sets, self._raising()))

    def _in_spans(self, one: Droppers) -> Iterator[Hanger]:
        spans = self.case.line.spans
        rows = one.positions_by_span(spans)
        drops, lengths = one.presag_by_span(spans), one.lengths_by_span(spans)
        for span in range(self.plan.first, self.plan.last):
            for index, position in enumerate(rows[span]):
                drop = drops[span][index] if one.mode == "height" else 0.0
                length = lengths[span][index] if one.mode == "length" else 0.0
                s = self.masts[span] + position
                yield from self._hanger(one, s, (drop, length), self._above(one, s))

    def _above(self, one: Droppers, s: float) -> str:
        """Return the run above a place; of stitch wires that of the nearest support with one."""
        if self.wires[one.upper].role != "stitch":
            return self.plan.run(one.upper)
        nearest = min(self._stitched_masts(), key=lambda mast: abs(self.masts[mast] - s))
        return self._stitch(one.upper, nearest)

    def _about_masts(self, one: Droppers) -> Iterator[Hanger]:
        count = self.case.line.spans - 1
        rows = one.positions_by_span(count)
        drops, lengths = one.presag_by_span(count), one.lengths_by_span(count)
        is_stitch = self.wires[one.upper].role == "stitch"
        for mast in self._stitched_masts() if is_stitch else self.plan.inner:
            upper = self._stitch(one.upper, mast) if is_stitch else self.plan.run(one.upper)
            for index, position in enumerate(rows[mast - 1]):
                drop = drops[mast - 1][index] if one.mode == "height" else 0.0
                length = lengths[mast - 1][index] if one.mode == "length" else 0.0
                yield from self._hanger(one, self.masts[mast] + position, (drop, length), upper)

    def _hanger(
        self, one: Droppers, s: float, values: tuple[float, float], upper: str
    ) -> Iterator[Hanger]:
        """Yield a hanger, unless it would hold a contact wire that is raised."""
        low, high = self.plan.droppers.get(one.lower, (s, s))
        if not low - SAME_PLACE <= s <= high + SAME_PLACE:
            return
        given: GivenHeight | GivenLength
        if one.mode == "height":
            level = float(np.interp(s, self.mast_places, self.levels[one.lower]))
            given = GivenHeight(level, values[0])
        else:
            given = GivenLength(values[1], one.length_kind == "stretched")
        yield Hanger(
            label=HangerLabel(0, 0),
            upper=At(upper, s),
            lower=At(self.plan.run(one.lower), s),
            given=given,
            stiffness=one.stiffness,
            mass=one.mass,
            clamps=(one.clamp_messenger, one.clamp_contact),
            diameter=one.diameter,
            thermal_expansion=one.thermal_expansion,
            raises=False,
        )

    def _raising(self) -> Iterator[Hanger]:
        """Yield what a raised contact wire hangs on at its support."""
        if self.case.wires.messenger is None:
            return
        sets = {one.lower: one for one in self.case.dropper_sets}
        for mast in sorted(self.plan.raised):
            for name, _ in self.case.wires.of_role("contact"):
                one = sets[name]
                yield Hanger(
                    label=HangerLabel(0, 0),
                    upper=At(self.plan.run("messenger"), self.masts[mast]),
                    lower=At(self.plan.run(name), self.masts[mast]),
                    given=GivenHeight(self.contact_z[mast], 0.0),
                    stiffness=one.stiffness,
                    mass=one.mass,
                    clamps=(one.clamp_messenger, one.clamp_contact),
                    diameter=one.diameter,
                    thermal_expansion=one.thermal_expansion,
                    raises=True,
                )

    def registrations(self, track: Track) -> Iterator[Registration]:
        spec = self.case.supports
        for name, wire in self.case.wires.of_role("contact"):
            y, _ = self._place(wire)
            masts = range(self.plan.first, self.plan.last + 1)
            ends = arm_ends(spec, masts, track, self.masts, y, self.contact_z)
            for mast in self.plan.inner:
                is_raised = mast in self.plan.raised and self.case.wires.messenger is not None
                own = spec.at(mast)
                yield Registration(
                    label=MastLabel.of_index(mast),
                    at=At(self.plan.run(name), self.masts[mast]),
                    y=y[mast],
                    z=self.contact_z[mast],
                    kind=_closure(own, self._lift(name, wire, mast), is_raised=is_raised),
                    clamp=own.clamp,
                    end=ends.get(mast),
                    is_fixed_along=mast == self.plan.fixed_point,
                    stop=own.stop,
                    heel=None if own.cantilever is None else own.cantilever.arm,
                )

    def _lift(self, name: str, wire: Wire, mast: int) -> float:
        """Return the vertical force of the arm at a mast, given or as a share of the wire [N].

        The whole share is the contact wire from the dropper before to the dropper behind the mast,
        or from the masts beside it where nothing hangs.
        """
        spec, s = self.case.supports.at(mast), self.masts[mast]
        if spec.share is None:
            return spec.lift
        held = self._hung_places[self.plan.run(name)]
        before, behind = bisect_left(held, s), bisect_right(held, s)
        left = max([self.masts[mast - 1], *held[before - 1 : before]])
        right = min([self.masts[mast + 1], *held[behind : behind + 1]])
        return spec.share * wire.mass * self.case.line.gravity * (right - left)

    @cached_property
    def _hung_places(self) -> defaultdict[str, list[float]]:
        """Places at which something hangs on hangers, from left to right, by run [m]."""
        places: defaultdict[str, list[float]] = defaultdict(list)
        for hanger in sorted(self.hangers, key=lambda hanger: hanger.lower.s):
            places[hanger.lower.run].append(hanger.lower.s)
        return places

    def suspensions(self) -> Iterator[Suspension]:
        spec = self.case.supports
        for name, wire in self.case.wires.of_role("messenger"):
            for mast in self.plan.inner:
                is_fixed, own = mast == self.plan.fixed_point, spec.at(mast)
                yield Suspension(
                    label=MastLabel.of_index(mast),
                    at=At(self.plan.run(name), self.masts[mast]),
                    y=self.messenger_y[mast] + wire.side,
                    z=self.messenger_z[mast],
                    stiffness=own.messenger_stiffness,
                    damping=own.messenger_damping,
                    is_fixed_along=is_fixed or own.messenger_longitudinal == "fixed",
                    elastic=None if own.cantilever is None else own.cantilever.messenger,
                )


def _end(s: float, y: float, z: float, how: EndWord | Device) -> End:
    """Return an end of a wire; weights and springs keep the tension of the design."""
    if isinstance(how, Device):
        return End(s, y, z, "weighted", device=how)
    return End(s, y, z, how)


def _sum(values: Values, shift: Values) -> Values:
    return tuple(y + by for y, by in zip(values, shift, strict=True))


def _closure(spec: Supports, lift: float, *, is_raised: bool) -> Closure:
    """Return what is known about a contact wire at a support.

    A raised wire hangs from its messenger wire; its arm only holds it sideways.

    Parameters
    ----------
    spec
    lift
        Vertical force of the arm, where that is what is known [N].
    is_raised
    """
    if spec.closure == "spring" and spec.spring is not None:
        return Spring(spec.spring)
    if is_raised:
        return Lift(spec.arm, 0.0)
    if spec.closure == "lift":
        return Lift(spec.arm, lift)
    return GivenArm(spec.arm) if spec.closure == "arm" else Height(spec.arm)


def _numbered(hangers: list[Hanger], masts: Values, wires: int) -> tuple[Hanger, ...]:
    """Give the hangers their numbers, span by span, those of each wire below apart."""
    inner = np.array(masts[1:-1])
    ordered = sorted(hangers, key=lambda hanger: hanger.lower.s)
    counts: dict[tuple[int, str], int] = {}
    found = []
    for hanger in ordered:
        span = int(np.searchsorted(inner, hanger.lower.s, side="right"))
        lower = hanger.lower.run if wires > 1 else ""
        index = counts.get((span, lower), 0)
        counts[span, lower] = index + 1
        found.append(replace(hanger, label=HangerLabel.of_index(span, index, lower)))
    return tuple(found)
