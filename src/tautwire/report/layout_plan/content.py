"""What a layout plan shows of a line: its pieces as built, where its static state has them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tautwire.line.expand import expand
from tautwire.line.pieces import Line
from tautwire.report.layout_plan.alignment import Bend, Rise, bends, rises
from tautwire.results.equilibrium import Equilibrium, WireShape
from tautwire.specs.case import Case
from tautwire.specs.line.catenary import Device, Ends
from tautwire.specs.line.tension import TensionLength

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Support:
    """A support and the texts that stand at it.

    Attributes
    ----------
    s : float m
    mark : str
        Name of its mast, or its number.
    chainage : str
    stagger, height, encumbrance : str
        One value per contact wire, or per tension length, that it holds.
    """

    s: float
    mark: str
    chainage: str
    stagger: str
    height: str
    encumbrance: str


@dataclass(frozen=True, eq=False)
class PlanWire:
    """A wire: its name and role, and its points ``(n, 3)``: along, lateral, above the rails [m]."""

    name: str
    role: str
    points: Array

    def between(self, start: float, end: float) -> Array:
        """Return its points between two places, with those at the places, ``(n, 3)`` [m]."""
        s = self.points[:, 0]
        ends = np.clip(np.array([start, end]), s[0], s[-1])
        inner = self.points[(s > ends[0]) & (s < ends[1])]
        cut = np.stack([ends, *(np.interp(ends, s, self.points[:, k]) for k in (1, 2))], axis=1)
        return np.concatenate([cut[:1], inner, cut[1:]])


@dataclass(frozen=True)
class PlanDropper:
    """A dropper: place, heights of its clamps [m], and its text.

    Attributes
    ----------
    row : (str, int)
        Wire that it carries, and row of its tension length.
    """

    s: float
    low: float
    high: float
    row: tuple[str, int]
    text: str


@dataclass(frozen=True)
class PlanArm:
    """A steady arm: place, and lateral position and height of its wire and of its far end [m]."""

    s: float
    wire: tuple[float, float]
    end: tuple[float, float]


@dataclass(frozen=True)
class Stretch:
    """A tension length.

    Attributes
    ----------
    name : str
        Empty where there is only one.
    texts : tuple of str
        Name and tensions, the longest first.
    start, end : float m
    ends : (str, str)
        What ends its wires on the left and on the right.
    is_held : (bool, bool)
        Whether the ends are anchored.
    middle : float or None m
        Of its mid-point anchor.
    row : int
        0 or 1, so that neighbours stand in different rows.
    """

    name: str
    texts: tuple[str, ...]
    start: float
    end: float
    ends: tuple[str, str]
    is_held: tuple[bool, bool]
    middle: float | None
    row: int


@dataclass(frozen=True)
class Content:
    """All that a plan shows.

    Attributes
    ----------
    supports : tuple of Support
    wires : tuple of PlanWire
    droppers : tuple of PlanDropper
        From left to right.
    arms : tuple of PlanArm
    stretches : tuple of Stretch
    overlaps : tuple of (float, float, int)
        Where overlaps begin and end [m], and how many spans they have.
    bends : tuple of Bend
    rises : tuple of Rise
    chainage_heading : str
    legend : tuple of (str, str)
        Role and description of every wire of the case.
    """

    supports: tuple[Support, ...]
    wires: tuple[PlanWire, ...]
    droppers: tuple[PlanDropper, ...]
    arms: tuple[PlanArm, ...]
    stretches: tuple[Stretch, ...]
    overlaps: tuple[tuple[float, float, int], ...]
    bends: tuple[Bend, ...]
    rises: tuple[Rise, ...]
    chainage_heading: str
    legend: tuple[tuple[str, str], ...]

    @property
    def length(self) -> float:
        """From the first support to the last [m]."""
        return self.supports[-1].s

    @property
    def longest_span(self) -> float:
        """Longest distance of neighbouring supports [m]."""
        return max(right.s - left.s for left, right in pairwise(self.supports))

    @cached_property
    def dropper_places(self) -> tuple[float, ...]:
        """Places of the droppers [m]."""
        return tuple(dropper.s for dropper in self.droppers)


def content_of(case: Case, shape: Equilibrium) -> Content:
    """Return what the plan of a line shows.

    Parameters
    ----------
    case
    shape
        Its static state.
    """
    line = expand(case)
    length = line.masts[-1]
    return Content(
        supports=_supports(case, line, shape),
        wires=tuple(_wire(wire) for wire in shape.wires),
        droppers=_droppers(case, line, shape),
        arms=_arms(shape),
        stretches=_stretches(case, line),
        overlaps=_overlaps(case, line),
        bends=bends(shape.track, case.track.rail_distance, length),
        rises=rises(shape.track, length),
        chainage_heading="chainage [km]" if case.line.chainage else "from support 1 [m]",
        legend=tuple(
            (str(wire.role), f"{name}, {1e-3 * wire.tension:g} kN, {wire.mass:g} kg/m")
            for name, wire in case.wires.named()
        ),
    )


def _wire(wire: WireShape) -> PlanWire:
    points = np.concatenate([wire.s[:, None], wire.position[:, 1:]], axis=1)
    return PlanWire(wire.name, wire.role, points)


def _supports(case: Case, line: Line, shape: Equilibrium) -> tuple[Support, ...]:
    marks = case.line.support_marks()
    staggers: list[list[str]] = [[] for _ in marks]
    heights: list[list[str]] = [[] for _ in marks]
    encumbrances: list[list[str]] = [[] for _ in marks]
    rows = zip(
        shape.support_number.tolist(),
        shape.support_wire.tolist(),
        shape.support_x.tolist(),
        shape.support_heights.tolist(),
        strict=True,
    )
    for number, index, s, height in rows:
        wire = shape.wires[index]
        staggers[number - 1].append(side_in_words(float(np.interp(s, wire.s, wire.position[:, 1]))))
        heights[number - 1].append(f"{height:.3f}")
        carrier = _messenger_of(line, shape, wire)
        if carrier is not None:
            above = float(np.interp(s, carrier.s, carrier.position[:, 2])) - height
            encumbrances[number - 1].append(f"{above:.3f}")
    return tuple(
        Support(
            s,
            mark,
            f"{s:.2f}" if case.line.chainage is None else f"{case.line.chainage[number] / 1e3:.3f}",
            *(" / ".join(dict.fromkeys(texts[number])) for texts in
              (staggers, heights, encumbrances)),
        )
        for number, (mark, s) in enumerate(zip(marks, line.masts, strict=True))
    )  # fmt: skip


def side_in_words(y: float) -> str:
    """Return a lateral position in millimetres with its side: L to the left of rising distance.

    Examples
    --------
    >>> side_in_words(0.2), side_in_words(-0.15), side_in_words(0.0)
    ('L 200', 'R 150', '0')
    """
    size = f"{1e3 * abs(y):.0f}"
    return size if size == "0" else f"{'L' if y > 0.0 else 'R'} {size}"


def _messenger_of(line: Line, shape: Equilibrium, wire: WireShape) -> WireShape | None:
    own = line.by_name[wire.name].tension_length
    return next(
        (w for w in shape.of_role("messenger") if line.by_name[w.name].tension_length == own), None
    )


def _droppers(case: Case, line: Line, shape: Equilibrium) -> tuple[PlanDropper, ...]:
    """Return the droppers; those of neighbouring tension lengths have rows of their own."""
    order = {one.name: number for number, one in enumerate(case.tension_lengths)}
    found = []
    rows = zip(
        shape.dropper_x.tolist(),
        shape.dropper_wires.tolist(),
        shape.dropper_span.tolist(),
        shape.dropper_lengths.tolist(),
        strict=True,
    )
    for s, (upper, lower), span, length in rows:
        high, low = (
            float(np.interp(s, shape.wires[k].s, shape.wires[k].position[:, 2]))
            for k in (upper, lower)
        )
        run = line.by_name[shape.wire_names[lower]]
        row = (run.wire_name, order.get(run.tension_length, 0) % 2)
        text = f"{s - line.masts[span - 1]:.2f} / {length:.3f}"
        found.append(PlanDropper(s, low, high, row, text))
    return tuple(sorted(found, key=lambda dropper: dropper.s))


def _arms(shape: Equilibrium) -> tuple[PlanArm, ...]:
    found = []
    for row, end in zip((shape.arm_supports - 1).tolist(), shape.arm_ends.tolist(), strict=True):
        s, wire = float(shape.support_x[row]), shape.wires[int(shape.support_wire[row])]
        y = float(np.interp(s, wire.s, wire.position[:, 1]))
        height = float(shape.support_heights[row])
        found.append(PlanArm(s, (y, height), (end[1], end[2])))
    return tuple(found)


def _stretches(case: Case, line: Line) -> tuple[Stretch, ...]:
    tensions = ", ".join(f"{name} {1e-3 * wire.tension:g} kN" for name, wire in case.wires.named())
    if not case.tension_lengths:
        return (_stretch(("", tensions), (line.masts[0], line.masts[-1]), case.line.ends, None, 0),)
    return tuple(
        _stretch(
            (one.name, tensions),
            (line.masts[one.masts[0] - 1], line.masts[one.masts[1] - 1]),
            one.ends,
            None if one.fixed_point is None else line.masts[one.fixed_point - 1],
            number % 2,
        )
        for number, one in enumerate(case.tension_lengths)
    )


def _stretch(
    names: tuple[str, str], places: tuple[float, float], ends: Ends, middle: float | None, row: int
) -> Stretch:
    name, tensions = names
    length = f"{places[1] - places[0]:.1f} m"
    texts = (
        ": ".join(filter(None, (name, f"{length}, {tensions}"))),
        " ".join(filter(None, (name, length))),
        *([name] if name else []),
    )
    held = ends.left == "anchored", ends.right == "anchored"
    words = _end_in_words(ends.left), _end_in_words(ends.right)
    return Stretch(name, texts, *places, words, held, middle, row)


def _end_in_words(end: str | Device) -> str:
    if isinstance(end, Device) and end.weights is not None:
        return f"weights 1:{end.weights.ratio:g}"
    if isinstance(end, Device) and end.spring is not None:
        return f"spring {1e-3 * end.spring.stiffness:g} kN/m"
    return str(end)


def _overlaps(case: Case, line: Line) -> tuple[tuple[float, float, int], ...]:
    shared: list[tuple[TensionLength, TensionLength]] = list(pairwise(case.tension_lengths))
    return tuple(
        (line.masts[right.masts[0] - 1], line.masts[left.masts[1] - 1],
         left.masts[1] - right.masts[0])
        for left, right in shared
    )  # fmt: skip
