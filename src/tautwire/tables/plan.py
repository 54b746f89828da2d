"""What tables of a line are read beside: its spans and masts, from its case and its supports."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

from tautwire.tables.values import CellError
from tautwire.units import UnitError, parse_quantity

_CLOSE = 3
"""Names that are offered in place of an unknown one."""
_NAMED = 12
"""Names that are listed where none is close: a line of text."""


@dataclass(frozen=True)
class LinePlan:
    """The spans and supports of a line, as far as they are known.

    Attributes
    ----------
    span_lengths : sequence of float m
        Empty where they are not known.
    masts : sequence of str
        Names of the supports; empty where they have none.
    spans : int
        Number of spans, or 0.
    """

    span_lengths: Sequence[float] = ()
    masts: Sequence[str] = ()
    spans: int = 0

    def span_length(self, span: int) -> float | None:
        """Return the length [m] of a span, numbered from 1; None where it is not known."""
        return self.span_lengths[span - 1] if 0 < span <= len(self.span_lengths) else None

    def mast(self, name: str) -> int:
        """Return the number of a support, from 1, by its name.

        Raises
        ------
        CellError
            When no support, or more than one, has the name.
        """
        count = self.masts.count(name)
        if count == 1:
            return self.masts.index(name) + 1
        if count:
            raise CellError(f"got {name!r}, a name that {count} supports have; rename all but one")
        raise CellError(f"got {name!r}, which no mast is called; {self._offered(name)}")

    def support(self, text: str) -> int:
        """Return the number of a support, from 1, by its name, or by itself.

        Numbers count the supports only where no mast has another support's number for a name.

        Raises
        ------
        CellError
            When it is neither.
        """
        if text in self.masts or not text.isdecimal() or self._are_numbered_otherwise():
            if self.masts:
                return self.mast(text)
            raise CellError(
                f"got {text!r}; the masts have no names, so give the number of a support"
            )
        if self.spans and not 1 <= int(text) <= self.spans + 1:
            raise CellError(f"got {text!r}; the line has the supports 1 to {self.spans + 1}")
        return int(text)

    def _are_numbered_otherwise(self) -> bool:
        """Tell whether a mast has a number for a name that is not that of its support."""
        names = enumerate(self.masts, 1)
        return any(name.isdecimal() and name != str(number) for number, name in names)

    def _offered(self, name: str) -> str:
        close = get_close_matches(name, self.masts, n=_CLOSE, cutoff=0.5)
        if close:
            return f"did you mean {' or '.join(map(repr, close))}?"
        more = ", ..." if len(self.masts) > _NAMED else ""
        return f"there are: {', '.join(self.masts[:_NAMED])}{more}"


def known_line(line: Any) -> dict[str, Any]:
    """Return what a case says about spans and masts of its line, quantities in SI.

    Parameters
    ----------
    line
        The block ``line`` of a case as plain data, not validated; what is not understood is left
        out here and refused with the case.
    """
    given: Mapping[str, Any] = line if isinstance(line, Mapping) else {}
    known: dict[str, Any] = {}
    for name in ("span_length", "chainage"):
        if isinstance(values := given.get(name), (list, tuple)):
            known |= {name: lengths} if (lengths := _lengths(values)) else {}
    spans = given.get("spans", len(known.get("span_length", ())))
    if isinstance(spans, int) and not isinstance(spans, bool) and spans > 0:
        known["spans"] = spans
        if (length := _lengths([given.get("span_length")])) and "span_length" not in known:
            known["span_length"] = length * spans
    masts = given.get("masts")
    if isinstance(masts, (list, tuple)) and all(isinstance(name, str) for name in masts):
        known["masts"] = list(masts)
    return known


def _lengths(values: Sequence[Any]) -> list[float]:
    """Return lengths [m]; nothing when one of them is none."""
    try:
        return [parse_quantity(value, "m") for value in values]
    except UnitError:
        return []
