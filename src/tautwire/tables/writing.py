"""Workbooks written: sheets of plain cells, headings that stay in sight."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence

from tautwire.tables.sheets import Cell

Row = Sequence[Cell]
_WIDEST = 60
"""Of a column, in letters: longer texts are read in the cell."""


def workbook_bytes(sheets: Mapping[str, Sequence[Row]], headings: int = 1) -> bytes:
    """Return sheets as an XLSX workbook.

    Numbers are stored as they are, texts as texts also where they look like formulas.

    Parameters
    ----------
    sheets
        Rows by the name of the sheet.
    headings
        Rows at the head of every sheet that stay in sight.
    """
    from openpyxl import Workbook
    from openpyxl.styles import Alignment, Font
    from openpyxl.utils import get_column_letter

    book = Workbook()
    book.remove(book.worksheets[0])
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        sheet.freeze_panes = sheet.cell(headings + 1, 1)
        for number, row in enumerate(rows, 1):
            for column, value in enumerate(row, 1):
                told = repr(value) if isinstance(value, float) else value
                cell = sheet.cell(number, column, told)
                if told is not None:  # openpyxl writes floats with 16 digits, and formulas
                    cell.data_type = "s" if isinstance(value, str) else "n"
                if number <= headings:
                    cell.font = Font(bold=True)
                    cell.alignment = Alignment(wrap_text=True, vertical="top")
        for column in range(1, max(map(len, rows), default=0) + 1):
            texts = (str(row[column - 1] or "") for row in rows if len(row) >= column)
            width = min(max(map(len, texts), default=0), _WIDEST) + 2
            sheet.column_dimensions[get_column_letter(column)].width = width
    content = io.BytesIO()
    book.save(content)
    return content.getvalue()
