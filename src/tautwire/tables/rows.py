"""The values of a mapped sheet, column by column."""

from __future__ import annotations

from typing import Any

from tautwire.errors import InputError
from tautwire.specs.schema.vocabulary import folded
from tautwire.tables.columns import total_words
from tautwire.tables.mapping import SheetMapping, Use
from tautwire.tables.sheets import Cell
from tautwire.tables.values import CellError, number_of, ratio_of, side_of, text_of

MOST_PROBLEMS = 1000
"""Cells of which a sheet complains before the rest is only counted."""


LATERAL = ("contact_stagger", "messenger_stagger", "hinge", "arm_end_y", "end_y")
"""Columns that change their sign with the side on which they are positive."""


class Rows:
    """The values of a mapped sheet, column by column, and the problems met.

    Where one row tells of several droppers, each of them counts as a row.
    """

    def __init__(self, mapping: SheetMapping) -> None:
        self.mapping, self.sheet = mapping, mapping.sheet
        self.problems: list[str] = []
        filled = [
            row
            for row in range(mapping.first_row, len(self.sheet.rows))
            if any(self._cell(row, use.column) is not None for use in mapping.uses)
        ]
        self.totals = [self.sheet.numbers[row] for row in filled if self._is_total(row)]
        items = [(row, number) for row in filled if not self._is_total(row)
                 for number in self._droppers_in(row)]  # fmt: skip
        self.indices = [row for row, _ in items]
        self.droppers = [number for _, number in items]
        if not self.sheet.letters:
            self._refuse_overfull(len(self.sheet.rows[mapping.heading_row]))

    def numbers(self, name: str) -> list[float | None] | None:
        """Return a column in SI; None where the sheet has none, or one without any value."""
        values = [None if use is None else self._number(row, use) for row, use in self._uses(name)]
        return values if any(value is not None for value in values) else None

    def full(self, name: str) -> list[float] | None:
        """Return a column that has a value in every row."""
        values = self.numbers(name)
        for index, value in enumerate(values or []):
            if value is None:
                self.complain(index, name, "is empty; fill the column or leave all of it empty")
        return None if values is None else [0.0 if v is None else v for v in values]

    def texts(self, name: str) -> list[str | None] | None:
        """Return a column of names; None where the sheet has none."""
        use = self.mapping.use(name)
        return None if use is None else [self._text(row, use) for row in self.indices]

    def cells(self, name: str) -> list[Cell]:
        """Return a column as it stands; errors of formulas are complained of."""
        use = self.mapping.use(name)
        if use is None:
            return [None for _ in self.indices]
        for row in self.indices:
            self._text(row, use)
        return [self._cell(row, use.column) for row in self.indices]

    def place(self, index: int, name: str) -> str:
        """Name a cell."""
        use = self.mapping.use(name, self.droppers[index])
        if use is None:
            return self.sheet.place(self.indices[index], 0)
        return self.mapping.place(self.indices[index], use)

    def complain(self, index: int, name: str, text: str) -> None:
        """Note a problem of a cell."""
        self.problems.append(f"{self.place(index, name)}: {text}")

    def listed_problems(self) -> list[str]:
        """Return the problems, the rest counted where there are very many."""
        problems = list(dict.fromkeys(self.problems))  # a cell of several droppers counts once
        rest = len(problems) - MOST_PROBLEMS
        more = [f"{self.sheet.label}: {rest} more problems"] if rest > 0 else []
        return problems[:MOST_PROBLEMS] + more

    def raise_problems(self) -> None:
        """Raise InputError when there is any problem."""
        if self.problems:
            raise InputError(self.listed_problems())

    def _refuse_overfull(self, width: int) -> None:
        for row in dict.fromkeys(self.indices):
            cells = self.sheet.rows[row]
            if any(cell is not None for cell in cells[width:]):
                self.problems.append(
                    f"{self.sheet.label}, line {self.sheet.numbers[row]}: has {len(cells)} cells "
                    f"for {width} columns; check separators and decimal commas"
                )

    def _uses(self, name: str) -> list[tuple[int, Use | None]]:
        """Return the sheet's row of every row, and the column of a field there."""
        uses = {number: self.mapping.use(name, number) for number in set(self.droppers)}
        return [(row, uses[n]) for row, n in zip(self.indices, self.droppers, strict=True)]

    def _droppers_in(self, row: int) -> list[int | None]:
        """Return the droppers of which a row tells: up to the last that has a value."""
        numbers = self.mapping.droppers
        if not numbers:
            return [None]
        told = [
            use.dropper
            for use in self.mapping.uses
            if use.dropper is not None and self._cell(row, use.column) is not None
        ]
        return [number for number in numbers if number <= max(told, default=0)]

    def _cell(self, row: int, column: int) -> Any:
        cells = self.sheet.rows[row]
        return cells[column] if column < len(cells) else None

    def _is_total(self, row: int) -> bool:
        """Tell whether a row sums up those above it: its first text says so."""
        first = next((cell for cell in self.sheet.rows[row] if cell is not None), None)
        return isinstance(first, str) and folded(first) in total_words()

    def _number(self, row: int, use: Use) -> float | None:
        share = ratio_of(use.unit)
        unit, wanted = ("", "") if share is not None else (use.unit, use.field.unit)
        cell, sign = self._cell(row, use.column), 1.0
        if use.field.name in LATERAL:
            cell, sign = side_of(cell)
        try:
            value = number_of(cell, unit, wanted, decimal_comma=self.sheet.decimal_comma)
        except CellError as error:
            self.problems.append(f"{self.mapping.place(row, use)}: {error}")
            return 0.0
        if value is None or (share is None and sign == 1.0):
            return value
        return sign * value * (1.0 if share is None else share)

    def _text(self, row: int, use: Use) -> str | None:
        try:
            return text_of(self._cell(row, use.column))
        except CellError as error:
            self.problems.append(f"{self.mapping.place(row, use)}: {error}")
            return None
