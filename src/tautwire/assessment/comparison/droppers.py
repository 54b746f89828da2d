"""Droppers by what a survey calls them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import InputError
from tautwire.line.expand import expand
from tautwire.measured.survey import Reading
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.run import Run
from tautwire.specs.schema.vocabulary import folded


@dataclass(frozen=True)
class NamedDroppers:
    """The droppers of a line with span, number, lower wire and tension length.

    Numbers count the droppers of a span that carry the same wire, so that lines with several
    contact wires, an auxiliary messenger wire or an overlap have several droppers of one number.

    Attributes
    ----------
    shape : Equilibrium
    wires, lengths : (n_dropper,) tuples of str
        Name of the lower wire in the case; tension length, empty where there is but one.
    """

    shape: Equilibrium
    wires: tuple[str, ...]
    lengths: tuple[str, ...]

    @classmethod
    def of(cls, run: Run) -> NamedDroppers:
        """Name the droppers of the line of a run."""
        shape, runs = run.equilibrium, {one.name: one for one in expand(run.case).runs}
        lower = [runs[shape.wire_names[wire]] for wire in shape.dropper_wires[:, 1].tolist()]
        wires = tuple(one.wire_name for one in lower)
        return cls(shape, wires, tuple(one.tension_length for one in lower))

    def find(self, one: Reading) -> int:
        """Return the row of the dropper at which a reading was taken.

        Raises
        ------
        InputError
            When the line has no such dropper, or several, with those that it has.
        """
        asked = f"{one.where}: names dropper {one.dropper} of span {one.span}"
        alike = self._alike(one)
        if not alike.size:
            raise InputError(f"{asked}, which the line does not have")
        kept = [row for row in alike.tolist() if self._is_named(row, one)]
        if len(kept) == 1:
            return kept[0]
        there = "; ".join(self._words(row) for row in (kept or alike.tolist()))
        if kept:
            raise InputError(
                f"{asked}, which may be any of {len(kept)}: {there}; say which in a column "
                "'Lower wire' or 'Tension length'"
            )
        told = {"lower wire": one.wire, "tension length": one.tension_length}
        given = " and ".join(f"{name} {value!r}" for name, value in told.items() if value)
        raise InputError(f"{asked} with the {given}; those that the line has: {there}")

    def name(self, row: int) -> str:
        """Name a dropper by span and number, and by its wire where others have these numbers."""
        span, number = self.shape.dropper_span[row], self.shape.dropper_number[row]
        text = f"dropper {number} of span {span}"
        is_alone = self._alike(Reading("elasticity", 0.0, 0.0, int(span), int(number))).size == 1
        return text if is_alone else f"{text}, {self._wire(row)}"

    def _alike(self, one: Reading) -> NDArray[np.int64]:
        """Return the rows of the droppers with the span and number of a reading."""
        shape = self.shape
        is_alike = (shape.dropper_span == one.span) & (shape.dropper_number == one.dropper)
        return np.flatnonzero(is_alike)

    def _is_named(self, row: int, one: Reading) -> bool:
        pairs = ((one.wire, self.wires[row]), (one.tension_length, self.lengths[row]))
        return all(not given or folded(given) == folded(name) for given, name in pairs)

    def _wire(self, row: int) -> str:
        length = f" of tension length {self.lengths[row]!r}" if self.lengths[row] else ""
        return f"lower wire {self.wires[row]!r}{length}"

    def _words(self, row: int) -> str:
        return f"{self._wire(row)}, x = {self.shape.dropper_x[row]:.2f} m"
