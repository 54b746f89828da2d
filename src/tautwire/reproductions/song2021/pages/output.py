"""The files of the reproduction: page, JSON and CSV."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from tautwire.files import write_text
from tautwire.reproductions.song2021.pages.page import page_html
from tautwire.reproductions.song2021.reproduction import SongRecord
from tautwire.text import csv_text


def writers(record: SongRecord) -> dict[str, Callable[[Path], object]]:
    """Return the files of a record by name: how each is written to a path."""
    text = json.dumps(record.as_dict(), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    return {
        "song2021.html": lambda path: write_text(path, page_html(record)),
        "record.json": lambda path: write_text(path, text),
        "record.csv": lambda path: write_text(path, record_csv(record)),
    }


def record_csv(record: SongRecord) -> str:
    """Return the evidence as CSV, one row per number."""
    head = ("claim", "section", "verdict", "condition", "quantity", "found", "unit", "published",
            "limits", "holds")  # fmt: skip
    rows = []
    for claim in record.claims:
        for item in claim.evidence:
            wanted = "" if item.published is None else f"{item.published:g}"
            rows.append(
                (claim.name, claim.section, claim.verdict, item.condition.text, item.quantity,
                 f"{item.found:.6g}", item.unit, wanted, item.requirement,
                 "yes" if item.holds else "no")
            )  # fmt: skip
    return csv_text(head, rows)
