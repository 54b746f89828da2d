"""Numbers of the catalogue: each with its unit, where it comes from and how far it is trusted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

from pydantic import GetCoreSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from tautwire.units import UnitError, parse_quantity, to_unit

Confidence = Literal["seen", "derived", "memory", "choice"]
CONFIDENCES: tuple[Confidence, ...] = get_args(Confidence)
_WRITTEN: dict[str, tuple[tuple[float, str], ...]] = {
    "m": ((0.1, "m"), (0.0, "mm")),
    "m^2": ((0.0, "mm2"),),
    "Pa": ((1e10, "GPa"), (0.0, "MPa")),
    "N": ((1e6, "MN"), (1e3, "kN"), (0.0, "N")),
}
"""Units in which numbers are written, each from a value on; others in SI."""
_EXTRAS = ("value", "range", "note")
_FORM = "{value: 1.067 kg/m, seen: SOURCE}, with derived, memory or choice in place of seen"


@dataclass(frozen=True)
class Number:
    """One number of an entry.

    Attributes
    ----------
    value : float
        In SI units.
    unit : str
        The SI unit.
    confidence : str
        ``seen`` in the sources named, ``derived`` by the rule named, from ``memory`` with no
        document at hand, or a ``choice`` for the reason named.
    origins : tuple of str
        The documents that give it; or, alone, the rule, the reason, what memory rests on.
    low, high : float or None
        Range that the source allows or in which other sources lie.
    note : str
    """

    value: float
    unit: str
    confidence: Confidence
    origins: tuple[str, ...]
    low: float | None = None
    high: float | None = None
    note: str = ""

    @property
    def source(self) -> str:
        """Where the number comes from, in one text."""
        return "; ".join(self.origins)

    def text(self) -> str:
        """Return the value in the unit that people of the trade use, as a case file takes it."""
        return self.in_words(self.value)

    def in_words(self, value: float) -> str:
        """Return another value of the same unit in the unit in which this one is written."""
        unit = next((u for floor, u in _WRITTEN.get(self.unit, ()) if self.value >= floor), "")
        if not unit:
            return f"{value:.6g} {self.unit}".rstrip()
        return f"{to_unit(value, unit):.6g} {unit}"

    def trust(self) -> str:
        """Return the confidence in the words of a case: ``two sources``, ``one source`` ..."""
        if self.confidence != "seen":
            return self.confidence
        return "two sources" if len(self.origins) > 1 else "one source"


@dataclass(frozen=True)
class Known:
    """Annotation of a field that holds a :class:`Number`: its unit and whether it may be 0.

    In a file the number is a mapping with its value and one key that says where it comes from:
    ``{value: 1.067 kg/m, seen: T}``. ``seen`` names one or several documents from the list at the
    top of the file, or is a text of its own; ``derived``, ``memory`` and ``choice`` are texts.
    """

    unit: str
    zero_allowed: bool = False

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._read)

    def _read(self, given: Any, info: ValidationInfo) -> Number:
        if isinstance(given, Number):
            return given
        if not isinstance(given, Mapping) or "value" not in given:
            raise ValueError(f"got {given!r}; write {_FORM}")
        unknown = [key for key in given if key not in (*_EXTRAS, *CONFIDENCES)]
        words: list[Confidence] = [word for word in CONFIDENCES if word in given]
        if unknown or len(words) != 1:
            fault = f"unknown key {unknown[0]!r}" if unknown else "needs exactly one origin"
            raise ValueError(f"{fault}; write {_FORM}")
        word, named = words[0], given[words[0]]
        origins = _origins(word, named, (info.context or {}).get("sources", {}))
        low, high = self._limits(given.get("range"))
        note = str(given.get("note", ""))
        value = self._checked(given["value"])
        return Number(value, self.unit, word, origins, low, high, note)

    def _checked(self, written: Any) -> float:
        try:
            value = parse_quantity(written, self.unit)
        except UnitError as error:
            raise ValueError(str(error)) from None
        if value < 0.0 or (value == 0.0 and not self.zero_allowed):
            bound = "at least" if self.zero_allowed else "greater than"
            raise ValueError(f"got {written!r}; must be {bound} 0")
        return value

    def _limits(self, written: Any) -> tuple[float | None, float | None]:
        if written is None:
            return None, None
        if not isinstance(written, list) or len(written) != 2:
            raise ValueError(f"range: got {written!r}; write [lowest, highest]")
        low, high = (self._checked(item) for item in written)
        return low, high


def _origins(word: Confidence, named: Any, sources: Mapping[str, str]) -> tuple[str, ...]:
    """Return the texts of an origin; only documents may be several."""
    names: list[Any] = named if isinstance(named, list) and word == "seen" else [named]
    if not names or not all(isinstance(name, str) and name for name in names):
        raise ValueError(f"{word}: got {named!r}; name the source, or say how or why")
    return tuple(sources.get(name, name) for name in names)
