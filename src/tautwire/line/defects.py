"""Where defects are: from the places that people name to the pieces of a line."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace

from tautwire.line.pieces import At, Line, Run
from tautwire.specs.conditions.condition import Condition
from tautwire.specs.conditions.defect import Defect


class MisplacedError(ValueError):
    """A defect names a place that the line does not have."""


@dataclass(frozen=True)
class Placed:
    """The defects of a condition, by the rows of the pieces that they change.

    Attributes
    ----------
    missing, slack : frozenset of int
        Hangers that are gone with their clamps, or hang without carrying.
    changes : tuple of (int, float m)
        Hangers, and what their unstrained length is longer.
    swaps : tuple of (int, int)
        Hangers that have each other's unstrained length.
    stitches : frozenset of str
        Broken runs.
    arms : frozenset of int
        Registrations without their arm.
    shifts : tuple of (int, float m, float m)
        Numbers of supports, and how far they are moved to the left and upwards.
    masses : tuple of (At, float kg)
    seized : frozenset of (str, str)
        Runs and the end, left or right, that does not move.
    """

    missing: frozenset[int] = frozenset()
    slack: frozenset[int] = frozenset()
    changes: tuple[tuple[int, float], ...] = ()
    swaps: tuple[tuple[int, int], ...] = ()
    stitches: frozenset[str] = frozenset()
    arms: frozenset[int] = frozenset()
    shifts: tuple[tuple[int, float, float], ...] = ()
    masses: tuple[tuple[At, float], ...] = field(default=())
    seized: frozenset[tuple[str, str]] = frozenset()


def placed(line: Line, condition: Condition) -> Placed:
    """Return the defects of a condition as rows of the pieces of a line.

    Raises
    ------
    MisplacedError
        For the first defect whose place is not there; :func:`misplaced` tells all.
    """
    found = Placed()
    for defect in condition.defects:
        found = _PLACES[defect.kind](line, defect, found)
    return found


def misplaced(line: Line, conditions: Iterable[Condition]) -> list[str]:
    """Return one sentence for every defect whose place the line does not have."""
    problems = []
    for number, condition in enumerate(conditions, 1):
        for index, defect in enumerate(condition.defects, 1):
            try:
                _PLACES[defect.kind](line, defect, Placed())
            except MisplacedError as error:
                problems.append(f"conditions[{number}].defects[{index}]: {error}")
    return problems


def marks(
    runs: Iterable[Run], masts: tuple[float, ...], conditions: Iterable[Condition]
) -> list[At]:
    """Return where conditions put masses on wires, so that the wires have a node there."""
    every = tuple(runs)
    found = []
    for condition in conditions:
        for defect in condition.defects:
            if defect.mass is not None:
                s = masts[(defect.span or 1) - 1] + (defect.at or 0.0)
                found += [At(run.name, s) for run in _runs_at(every, defect, s)]
    return found


def _runs_at(runs: Iterable[Run], defect: Defect, s: float) -> list[Run]:
    return [
        run
        for run in runs
        if run.wire_name == defect.wire
        and run.tension_length == (defect.tension_length or run.tension_length)
        and run.start.s <= s <= run.end.s
    ]


def _hanger(line: Line, defect: Defect, number: int | None) -> int:
    """Return the row of a dropper."""
    in_span = [
        (row, hanger)
        for row, hanger in enumerate(line.hangers)
        if hanger.label.span == defect.span
        and (defect.wire is None or line.by_name[hanger.lower.run].wire_name == defect.wire)
    ]
    rows = [row for row, hanger in in_span if hanger.label.number == number]
    if len(rows) == 1:
        return rows[0]
    of = f" of the wire {defect.wire!r}" if defect.wire else ""
    if rows:
        wires = sorted({line.by_name[line.hangers[row].lower.run].wire_name for row in rows})
        raise MisplacedError(
            f"there are several droppers {number} in span {defect.span}; say which wire they "
            f"carry, wire: {' or '.join(wires)}"
        )
    numbers = sorted(hanger.label.number for _, hanger in in_span)
    known = f"1 to {numbers[-1]}" if numbers else "none"
    raise MisplacedError(f"got dropper {number}{of}; span {defect.span} has {known}")


def _missing(line: Line, defect: Defect, found: Placed) -> Placed:
    return replace(found, missing=found.missing | {_hanger(line, defect, defect.dropper)})


def _slack(line: Line, defect: Defect, found: Placed) -> Placed:
    return replace(found, slack=found.slack | {_hanger(line, defect, defect.dropper)})


def _changed(line: Line, defect: Defect, found: Placed) -> Placed:
    row = _hanger(line, defect, defect.dropper)
    return replace(found, changes=(*found.changes, (row, defect.change or 0.0)))


def _swapped(line: Line, defect: Defect, found: Placed) -> Placed:
    pair = (_hanger(line, defect, defect.dropper), _hanger(line, defect, defect.other))
    if pair[0] == pair[1]:
        raise MisplacedError(f"dropper {defect.dropper} cannot be swapped with itself")
    return replace(found, swaps=(*found.swaps, pair))


def _broken_stitch(line: Line, defect: Defect, found: Placed) -> Placed:
    s = line.masts[(defect.support or 1) - 1]
    names = {
        run.name
        for run in line.of_role("stitch")
        if run.start.s <= s <= run.end.s and defect.wire in (None, run.wire_name)
    }
    if not names:
        raise MisplacedError(f"there is no stitch wire at support {defect.support}")
    return replace(found, stitches=found.stitches | names)


def _broken_arm(line: Line, defect: Defect, found: Placed) -> Placed:
    rows = {
        row
        for row, piece in enumerate(line.registrations)
        if piece.label.number == defect.support
        and defect.wire in (None, line.by_name[piece.at.run].wire_name)
    }
    if not rows:
        raise MisplacedError(f"there is no steady arm at support {defect.support}")
    return replace(found, arms=found.arms | rows)


def _shifted(line: Line, defect: Defect, found: Placed) -> Placed:  # noqa: ARG001
    shift = (defect.support or 1, defect.lateral, defect.vertical)
    return replace(found, shifts=(*found.shifts, shift))


def _extra_mass(line: Line, defect: Defect, found: Placed) -> Placed:
    s = line.masts[(defect.span or 1) - 1] + (defect.at or 0.0)
    runs = _runs_at(line.runs, defect, s)
    if len(runs) != 1:
        which = "several tension lengths have" if runs else "there is no"
        raise MisplacedError(
            f"{which} wire {defect.wire!r} at {s:g} m; name tension_length and wire"
        )
    return replace(found, masses=(*found.masses, (At(runs[0].name, s), defect.mass or 0.0)))


def _seized(line: Line, defect: Defect, found: Placed) -> Placed:
    runs = [
        run
        for run in line.runs
        if run.wire_name == defect.wire
        and run.tension_length == (defect.tension_length or run.tension_length)
    ]
    ends = {(run.start if defect.end == "left" else run.end).kind for run in runs}
    if len(runs) != 1 or ends != {"weighted"}:
        raise MisplacedError(
            f"the {defect.end} end of {defect.wire!r} has no tensioning device; give it one "
            "(line.ends, or the ends of its tension length)"
        )
    return replace(found, seized=found.seized | {(runs[0].name, str(defect.end))})


_PLACES: dict[str, Callable[[Line, Defect, Placed], Placed]] = {
    "missing dropper": _missing,
    "slack dropper": _slack,
    "dropper length": _changed,
    "swapped droppers": _swapped,
    "broken stitch wire": _broken_stitch,
    "broken steady arm": _broken_arm,
    "displaced support": _shifted,
    "extra mass": _extra_mass,
    "seized tensioning device": _seized,
}
"""What each kind of defect does."""
