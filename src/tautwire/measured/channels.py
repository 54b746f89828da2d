"""Columns as channels in SI: units read, or decided by what is plausible; gaps counted."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.measured.files.source import Column, Source, columns_of_texts, text_of
from tautwire.measured.recording import Array
from tautwire.tables.columns import ANY, DEGREES, TEXT
from tautwire.tables.mapping import SheetMapping, Use
from tautwire.tables.values import CellError, factor_of, number_of

KM_M = "km+m"
_CLOCK = re.compile(rb"^(?:.*[T ])?\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?(?:Z|[+-]\d{2}:?\d{2})?$")
_DAY = 86_400.0
"""Seconds of a day: a clock begins again at midnight."""
_ABSURD = 1e12
"""No reading is so large in any unit; what is, is a mark of a recorder for no reading."""
_FEWEST_NUMBERS = 0.05
"""Share of cells with a number below which a column is no channel, but one of texts."""
_WORDS_NAMED = 5
"""Words in cells without a number that are named; recorders use one or two."""


@dataclass(frozen=True, eq=False)
class Channel:
    """A channel of a recording.

    Attributes
    ----------
    use : Use
        Heading, field and numbers.
    unit : str
        Unit that was applied.
    values : (n,)
        SI; NaN where there is no reading. Empty for texts.
    texts : (n,) bytes or None
    gaps : str
        What stands in the cells without a reading; empty where there are none.
    note : str
        What was decided; empty where the heading said it all.
    """

    use: Use
    unit: str
    values: Array
    texts: NDArray[np.bytes_] | None = None
    gaps: str = ""
    note: str = ""


def read_channels(source: Source, mapping: SheetMapping) -> list[Channel]:
    """Read the mapped columns of a sheet.

    A column whose cells are mostly no numbers is left out, and its note says so.
    """
    wanted = {use.column: _is_text(mapping, use) for use in mapping.uses}
    columns = source.read(mapping.sheet, mapping.first_row, dict(sorted(wanted.items())))
    return [
        _channel(use, columns.pop(use.column), decimal_comma=mapping.sheet.decimal_comma)
        for use in mapping.uses
    ]


def _is_text(mapping: SheetMapping, use: Use) -> bool:
    """Tell whether a column must be read as texts: by its kind, or by its first cells."""
    if use.field.unit in (TEXT, DEGREES) or use.unit.lower() == KM_M:
        return True
    rows = mapping.sheet.rows[mapping.first_row :]
    cells = [row[use.column] for row in rows if use.column < len(row)]
    texts = [cell for cell in cells if isinstance(cell, str)]
    odd = sum(1 for text in texts if re.search(r"\d", text) and not _is_number(text))
    return bool(cells) and odd > 0.5 * len(cells)


def _is_number(text: str) -> bool:
    try:
        float(text.replace(",", ".", 1))
    except ValueError:
        return False
    return True


def _channel(use: Use, column: Column, *, decimal_comma: bool) -> Channel:
    if use.field.unit == TEXT:
        texts = column.texts if column.texts is not None else np.empty(0, dtype=np.bytes_)
        return Channel(use, "", np.empty(0), texts)
    unit, note = use.unit, ""
    if column.texts is not None:
        column, unit = _from_texts(use, column.texts, decimal_comma=decimal_comma)
    numbers = column.numbers if column.numbers is not None else np.empty(0)
    numbers = np.where(np.abs(numbers) < _ABSURD, numbers, np.nan)
    known = ~np.isnan(numbers)
    if not len(numbers) or known.mean() < _FEWEST_NUMBERS:
        words = ", ".join(repr(word) for word, _ in column.words.most_common(_WORDS_NAMED))
        note = f"{use.heading!r} holds hardly any numbers ({words}); it is not read"
        return Channel(use, unit, np.full(len(numbers), np.nan), note=note)
    if use.field.unit not in (ANY, DEGREES) and unit != "SI":
        if not unit:
            unit, note = _plausible_unit(use, numbers)
        factor = factor_of(unit, use.field.unit) if unit else 1.0
        if factor != 1.0:
            numbers = numbers * factor
    return Channel(use, unit, numbers, gaps=_gaps(numbers, column), note=note)


def _from_texts(use: Use, texts: NDArray[np.bytes_], *, decimal_comma: bool) -> tuple[Column, str]:
    """Return texts as numbers: kilometres + metres, clock times, degrees, cells with units."""
    if use.field.unit == DEGREES:
        return _degrees(texts), "deg"
    filled = texts[texts != b""]
    sample = bytes(filled[0]) if len(filled) else b""
    if b"+" in sample[1:] and use.field.unit == "m":
        kilometres, _, metres = (np.char.strip(part) for part in np.char.partition(texts, b"+").T)
        whole, rest = columns_of_texts(kilometres), columns_of_texts(metres)
        assert whole.numbers is not None
        assert rest.numbers is not None
        return Column(1e3 * whole.numbers + rest.numbers, words=whole.words + rest.words), "SI"
    if use.field.unit == "s" and _CLOCK.match(sample):
        return _clock(texts), "SI"
    plain = columns_of_texts(texts)
    if plain.words.total() < 0.5 * len(texts):
        return plain, "" if use.unit.lower() == KM_M else use.unit
    return _cells(use, texts, decimal_comma=decimal_comma), "SI"


def _cells(use: Use, texts: NDArray[np.bytes_], *, decimal_comma: bool) -> Column:
    """Read cells that carry their own units, each text once."""
    found, places = np.unique(texts, return_inverse=True)
    values, words = np.full(len(found), np.nan), Column().words
    counts = np.bincount(places, minlength=len(found))
    for index, text in enumerate(found):
        try:
            value = number_of(text_of(text), use.unit, use.field.unit, decimal_comma=decimal_comma)
        except CellError:
            value = None
        if value is None:
            words[text_of(text)] += int(counts[index])
        else:
            values[index] = value
    return Column(values[places], words=words)


def _degrees(texts: NDArray[np.bytes_]) -> Column:
    """Read latitudes and longitudes, negative in the south and west."""
    upper = np.char.upper(texts)
    negative = np.char.endswith(upper, b"S") | np.char.endswith(upper, b"W")
    bare = np.char.strip(upper, b" NSEWO\xc2\xb0\xba\xf8")
    column = columns_of_texts(bare)
    assert column.numbers is not None
    return Column(np.where(negative, -column.numbers, column.numbers), words=column.words)


def _clock(texts: NDArray[np.bytes_]) -> Column:
    """Read clock times as seconds since the first; past midnight they go on."""
    comma = np.char.replace(texts, b",", b".")
    clock = np.char.rpartition(np.char.replace(comma, b"T", b" "), b" ")[:, 2]
    parts = [np.char.partition(clock, b":")]
    parts.append(np.char.partition(parts[0][:, 2], b":"))
    hours, minutes, seconds = (
        columns_of_texts(part) for part in (parts[0][:, 0], parts[1][:, 0], parts[1][:, 2])
    )
    assert hours.numbers is not None
    assert minutes.numbers is not None
    assert seconds.numbers is not None
    values = 3600.0 * hours.numbers + 60.0 * minutes.numbers + seconds.numbers
    steps = np.diff(values, prepend=values[0])
    values = values + _DAY * np.cumsum(np.nan_to_num(steps) < -0.5 * _DAY)
    return Column(values - values[0], words=seconds.words)


def _plausible_unit(use: Use, numbers: Array) -> tuple[str, str]:
    """Decide the unit of a column that has none: SI if that is plausible, else what fits alone."""
    if use.field.plausible is None:
        return "", ""
    statistic, low, high = use.field.plausible
    value = _STATISTICS[statistic](numbers)
    if not np.isfinite(value) or low <= value <= high:
        return "", ""
    fitting = [u for u in use.field.units if low <= value * factor_of(u, use.field.unit) <= high]
    if len(fitting) != 1:
        return "", ""
    return fitting[0], (
        f"{use.heading!r} has no unit; it is read in {fitting[0]}, which alone makes it plausible"
    )


def _step(numbers: Array) -> float:
    steps = np.abs(np.diff(numbers[:100_000]))
    steps = steps[steps > 0.0]
    return float(np.median(steps)) if len(steps) else float("nan")


def _spread(numbers: Array) -> float:
    known = np.abs(numbers[~np.isnan(numbers)])
    return float(np.quantile(known, 0.95)) if len(known) else float("nan")


def _median(numbers: Array) -> float:
    known = np.abs(numbers[~np.isnan(numbers)])
    return float(np.median(known)) if len(known) else float("nan")


_STATISTICS = {"step": _step, "spread": _spread, "median": _median}


def _gaps(numbers: Array, column: Column) -> str:
    missing = int(np.isnan(numbers).sum())
    if not missing:
        return ""
    named = [
        f"{word!r} {count} times" if word else f"empty {count} times"
        for word, count in column.words.most_common(_WORDS_NAMED)
    ]
    return f"{missing} of {len(numbers)} cells hold no number" + (
        f" ({', '.join(named)})" if named else ""
    )
