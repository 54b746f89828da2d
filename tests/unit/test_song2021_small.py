"""Reproduction of Song et al. (2021) on a short line: the whole road, resumed, and its files."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest

from tautwire.reproductions.song2021.claims import NO_VALUE, VERDICTS
from tautwire.reproductions.song2021.pages.output import writers
from tautwire.reproductions.song2021.passages import UNCALIBRATED, Scope
from tautwire.reproductions.song2021.reproduction import reproduce

TINY = Scope("tiny", 9, (UNCALIBRATED,), ("hinged",), (), ((UNCALIBRATED, "rough"),), (1, 2))
SHORT = {"line.spans": 4}


@pytest.mark.slow
def test_short_line_gives_page_json_and_csv(tmp_path: Path) -> None:
    """Every claim that was computed has a verdict; a second call computes nothing again."""
    record = reproduce(tmp_path, TINY, workers=2, changes=SHORT)
    assert record.status == "done"
    assert {claim.verdict for claim in record.claims} <= set(VERDICTS)
    without = [c.name for c in record.claims if c.verdict == NO_VALUE]
    assert all(name.startswith(("losses-", "mode-")) for name in without)
    files = writers(record)
    for name, write in files.items():
        write(tmp_path / name)
    found = json.loads((tmp_path / "record.json").read_text(encoding="utf-8"))
    assert len(found["claims"]) == len(record.claims)
    table = (tmp_path / "record.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(io.StringIO(table)))
    assert len(rows) == sum(len(claim.evidence) for claim in record.claims)
    page = (tmp_path / "song2021.html").read_text(encoding="utf-8")
    for number in (3, 4, 5, 6, 7, 8, 9, 10, 11, 15, 17, 18):
        assert f"Fig. {number} of the paper" in page
    assert "default-src 'none'" in page

    calls: list[object] = []
    again = reproduce(
        tmp_path, TINY, workers=2, changes=SHORT, watch=lambda p: bool(calls.append(p))
    )
    assert calls == []
    assert again.statement == record.statement


@pytest.mark.slow
def test_stopped_reproduction_is_partial(tmp_path: Path) -> None:
    """What is not computed is named, and its claims have no verdict."""
    record = reproduce(tmp_path, TINY, workers=1, changes=SHORT, watch=lambda _: True)
    assert record.status == "partial"
    assert set(record.missing.values()) == {"not computed"}
    assert "Not complete" in record.statement
    assert "song2021.html" in writers(record)
