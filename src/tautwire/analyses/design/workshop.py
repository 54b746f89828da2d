"""Droppers as the workshop cuts them, what rounding does to the line, and quantities."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.road.shape import find_cut
from tautwire.model.build import Model
from tautwire.plain import Plain, named
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.line.workshop import Workshop

Array = NDArray[np.float64]


@dataclass(frozen=True)
class WireLength(Plain):
    """What is needed of one wire of the case.

    Attributes
    ----------
    wire, tension_length : str
    pieces : int
        Wires of this kind: stitch wires are as many as supports that have one.
    length : float m
        Unstrained, all pieces together; from anchor to anchor, without what ends and waste need.
    mass : float kg
    """

    wire: str
    tension_length: str
    pieces: int
    length: float = field(metadata=named("unstrained_length_m"))
    mass: float = field(metadata=named("mass_kg"))


@dataclass(frozen=True)
class DropperClass(Plain):
    """Droppers between the same wires in one class of cut length.

    Attributes
    ----------
    upper, lower : str
        Wires of the case.
    begin, end : float m
        Class, its end not included.
    count : int
    rope : float m
        Cut lengths together.
    """

    upper: str
    lower: str
    begin: float = field(metadata=named("from_m"))
    end: float = field(metadata=named("below_m"))
    count: int
    rope: float = field(metadata=named("rope_m"))


@dataclass(frozen=True, eq=False)
class WorkshopSheet:
    """Droppers of a line as they are cut, and quantities.

    Arrays are in the order of the droppers of the shape, ``(n_dropper,)``.

    Attributes
    ----------
    given : Workshop
    between_clamps : m
        Unstrained length between where the dropper bears in its clamps.
    exact, cut : m
        Rope of each dropper as computed and rounded to the step.
    axes : m
        Unstrained length between the axes of the wires that the cut dropper has.
    as_cut : Equilibrium
        The line with droppers of these lengths.
    height_change : m
        Of the wire below at the droppers, from the design to the line as cut.
    force_change : N
    wires : tuple of WireLength
    classes : tuple of DropperClass
    clamps : tuple of (str, int)
        Clamps by what they do.
    """

    given: Workshop
    between_clamps: Array
    exact: Array
    cut: Array
    axes: Array
    as_cut: Equilibrium
    height_change: Array
    force_change: Array
    wires: tuple[WireLength, ...]
    classes: tuple[DropperClass, ...]
    clamps: tuple[tuple[str, int], ...]

    def as_dict(self) -> dict[str, Any]:
        """Return inputs, largest effects of the rounding and quantities as plain data."""
        height, force = self.height_change, self.force_change
        return {
            "given": self.given.to_dict(),
            "largest_height_change_m": float(np.abs(height).max(initial=0.0)),
            "largest_force_change_n": float(np.abs(force).max(initial=0.0)),
            "slack_droppers": len(self.slack),
            "wires": [one.as_dict() for one in self.wires],
            "droppers": [one.as_dict() for one in self.classes],
            "clamps": dict(self.clamps),
        }

    @property
    def slack(self) -> NDArray[np.intp]:
        """Rows of droppers that carry nothing as cut."""
        return np.flatnonzero(self.as_cut.dropper_forces <= 0.0)


def workshop_sheet(model: Model, shape: Equilibrium) -> WorkshopSheet:
    """Return the droppers of a line as they are cut.

    The rope of a dropper is ``L - u - l + 2 s``: its unstrained length L between the axes of the
    wires less the deductions u and l of the clamps, with s in each loop; it is rounded to the step,
    and the line is found again with the lengths that follow, arms at the supports as designed.

    Parameters
    ----------
    model
        The line.
    shape
        Its design.

    Raises
    ------
    ConvergenceError
        When the line with rounded lengths is not found.
    """
    given = model.case.workshop
    deducted = given.upper_clamp + given.lower_clamp
    between = shape.dropper_lengths_unstrained - deducted
    exact = between + 2.0 * given.loop
    cut = np.rint(exact / given.step) * given.step if given.step > 0.0 else exact
    axes = shape.dropper_lengths_unstrained + (cut - exact)
    as_cut = find_cut(model, axes) if given.step > 0.0 and axes.size else shape
    return WorkshopSheet(
        given=given,
        between_clamps=between,
        exact=exact,
        cut=cut,
        axes=axes,
        as_cut=as_cut,
        height_change=as_cut.dropper_heights - shape.dropper_heights,
        force_change=as_cut.dropper_forces - shape.dropper_forces,
        wires=_wires(model, shape),
        classes=_classes(model, cut, given.length_class),
        clamps=_clamps(model),
    )


def too_short(sheet: WorkshopSheet) -> NDArray[np.intp]:
    """Return the rows of droppers that the clamps leave no length."""
    return np.flatnonzero(sheet.between_clamps <= 0.0)


def _wires(model: Model, shape: Equilibrium) -> tuple[WireLength, ...]:
    runs = {run.name: run for run in model.line.runs}
    found: dict[tuple[str, str], list[float]] = {}
    for wire in shape.wires:
        run = runs[wire.name]
        found.setdefault((run.wire_name, run.tension_length), []).append(float(wire.lengths.sum()))
    masses = {name: wire.mass for name, wire in model.case.wires.named()}
    return tuple(
        WireLength(name, length, len(pieces), sum(pieces), masses[name] * sum(pieces))
        for (name, length), pieces in found.items()
    )


def _classes(model: Model, cut: Array, width: float) -> tuple[DropperClass, ...]:
    runs = {run.name: run.wire_name for run in model.line.runs}
    found: dict[tuple[str, str, int], list[float]] = {}
    for hanger, length in zip(model.line.hangers, cut.tolist(), strict=True):
        pair = runs[hanger.upper.run], runs[hanger.lower.run]
        number = int(np.floor(length / width + 1e-9))  # 0.3 m is not below 3 x 0.1 m
        found.setdefault((*pair, number), []).append(length)
    return tuple(
        DropperClass(upper, lower, width * number, width * (number + 1), len(own), sum(own))
        for (upper, lower, number), own in sorted(found.items())
    )


def _clamps(model: Model) -> tuple[tuple[str, int], ...]:
    """Count clamps: two for every dropper, one for every steady arm and end of a stitch wire."""
    line = model.line
    runs = {run.name: run.wire_name for run in line.runs}
    counts: Counter[str] = Counter()
    for hanger in line.hangers:
        counts[f"dropper clamps on {runs[hanger.upper.run]}, upper"] += 1
        counts[f"dropper clamps on {runs[hanger.lower.run]}, lower"] += 1
    for piece in line.registrations:
        counts[f"steady arm clamps on {runs[piece.at.run]}"] += 1
    for joint in line.joints:
        counts[f"clamps of {runs[joint.other.run]} on {runs[joint.host.run]}"] += 1
    for piece in line.suspensions:
        counts[f"suspensions of {runs[piece.at.run]}"] += 1
    return tuple(counts.items())
