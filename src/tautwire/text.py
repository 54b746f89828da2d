"""Texts made fit to be shown: nothing in them acts on the terminal or spreadsheet around them."""

from __future__ import annotations

import csv
import html
import io
import re
import unicodedata
from collections.abc import Iterable, Sequence

_UNSEEN = frozenset({"Cc", "Cs", "Zl", "Zp"})
"""Unicode categories: controls, halves of surrogate pairs, separators of lines and paragraphs."""
_TURNING = frozenset("\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
"""Marks that turn the direction of what follows, so that a text reads otherwise than it is."""
_WHITE = "\t\n\r"
_ACTING = ("=", "+", "-", "@", "\t", "\r")


MARK = "‡"
"""Beside a figure that mesh and time step do not carry."""


def marked(text: str, *, is_carried: bool) -> str:
    """Return a figure with its mark where mesh and time step do not carry it.

    Examples
    --------
    >>> marked("3", is_carried=False)
    '3 ‡'
    """
    return text if is_carried else f"{text}\N{NO-BREAK SPACE}{MARK}"


DESIGN = "design"
"""Name of the state of a line without a condition."""

LONGEST_NAME = 60
"""Characters of a name: it stands in columns of tables and in names of files."""


def as_name(text: str) -> str:
    """Return a text as a name that file systems, tables and command lines take.

    Examples
    --------
    >>> as_name("Linie 4/2 (neu)")
    'Linie-4-2--neu-'
    """
    return re.sub(r"[^A-Za-z0-9._+-]", "-", text)[:LONGEST_NAME]


def unprintable(text: str) -> str:
    r"""Say which character of a text cannot be shown as it is; nothing where all can.

    Tabs and line ends are allowed.

    Examples
    --------
    >>> unprintable("a\x1b[31mb")
    'holds the control character U+001B; remove it'
    """
    if text.isascii() and text.isprintable():
        return ""
    for letter in text:
        if letter not in _WHITE and _acts(letter):
            return f"holds the control character U+{ord(letter):04X}; remove it"
    return ""


def printable(text: str) -> str:
    r"""Return a text with every control character written as its number.

    Line ends and tabs stay; ``"\x1b"`` becomes ``"<1B>"``, so that a terminal does not obey it.
    """
    if text.isascii() and text.isprintable():
        return text
    return "".join(
        f"<{ord(letter):02X}>" if letter not in _WHITE and _acts(letter) else letter
        for letter in text
    )


def shortened(text: str, most: int = 100) -> str:
    """Return a text for a message: printable, on one line, its middle left out where it is long."""
    line = " ".join(printable(text).split()) if text.strip() else text
    half = (most - 5) // 2
    return line if len(line) <= most else f"{line[:half]} ... {line[-half:]}"


def shown(value: object, most: int = 60) -> str:
    """Return a value for a message: texts quoted, all shortened where they are long.

    Examples
    --------
    >>> shown("55 m"), shown(5.0), shown(None)
    ("'55 m'", '5', 'nothing')
    """
    if value is None:
        return "nothing"
    try:
        text = repr(value) if isinstance(value, str) else str(value)
    except ValueError:  # Python writes no integer of more than 4300 digits
        return f"a very large {type(value).__name__}"
    if isinstance(value, float):
        text = text.removesuffix(".0")
    return text if len(text) <= most else text[: most - 3] + "..."


class Told:
    """An object that tells in a line, and in a notebook as a table, what matters about it."""

    def facts(self) -> dict[str, str]:
        """Return what matters, by what it is."""
        raise NotImplementedError

    def __repr__(self) -> str:
        """Return kind and facts in one line."""
        told = "; ".join(f"{name} {text}" for name, text in self.facts().items())
        return f"<{type(self).__name__}: {printable(told)}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th style='text-align:left'>{html.escape(name)}</th>"
            f"<td style='text-align:left'>{html.escape(text)}</td></tr>"
            for name, text in self.facts().items()
        )
        return f"<table><caption>{type(self).__name__}</caption>{rows}</table>"


def csv_text(head: Sequence[object], rows: Iterable[Sequence[object]]) -> str:
    r"""Return a table as CSV whose cells no spreadsheet takes for formulas.

    A spreadsheet computes a cell that begins with ``=``, ``+``, ``-``, ``@``, a tab or a carriage
    return; an apostrophe before such a text makes it show the text. Numbers are left as they are.

    Examples
    --------
    >>> csv_text(("case", "force [N]"), [("=1+1", -2.5)])
    "case,force [N]\n'=1+1,-2.5\n"
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([_cell(value) for value in head])
    writer.writerows([_cell(value) for value in row] for row in rows)
    return out.getvalue()


def _cell(value: object) -> object:
    acts = isinstance(value, str) and value.startswith(_ACTING) and not _is_number(value)
    return f"'{value}" if acts else value


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _acts(letter: str) -> bool:
    return unicodedata.category(letter) in _UNSEEN or letter in _TURNING
