"""``tautwire spans``: tables, files and refusals."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from tautwire.cli.app import run_command_line

EXAMPLE = Path(__file__).parents[2] / "examples" / "spans" / "norway-20a.yaml"


def test_table_and_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The example gives six radii and four winds, on screen, as JSON, CSV and page."""
    out = tmp_path / "spans.csv"
    assert run_command_line(["spans", str(EXAMPLE), "--json", "--out", str(out)]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [len(row["spans"]) for row in document["rows"]] == [4] * 6
    with out.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 24
    assert float(rows[2]["longest_span_m"]) == pytest.approx(35.6, abs=0.1)
    page = tmp_path / "spans.html"
    assert run_command_line(["spans", str(EXAMPLE), "--out", str(page)]) == 0
    capsys.readouterr()
    for text in ("35.6", "Longest spans", "not checked against the standard"):
        assert text in page.read_text(encoding="utf-8")
    assert run_command_line(["spans", str(EXAMPLE)]) == 0
    assert "not checked against the standard" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"tension: 20 kN": "tension: 20 m"}, "which is a length"),
        ({"radius: straight": "radius: 5 m"}, "curves[6].radius"),
        ({'head: "1600"': 'head: "1700"'}, "there are: 1600, 1800, 1950"),
        (
            {'permissible: {rule: en50367-2012-norway, head: "1600", height: 5.6 m}': ""},
            "curves[1].permissible: is missing",
        ),
    ],
)
def test_refusals(
    change: dict[str, str], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A fault is told with its place, exit code 2, and no file is written."""
    text = EXAMPLE.read_text(encoding="utf-8")
    for old, new in change.items():
        assert old in text
        text = text.replace(old, new)
    table, out = tmp_path / "table.yaml", tmp_path / "spans.csv"
    table.write_text(text, encoding="utf-8")
    assert run_command_line(["spans", str(table), "--out", str(out)]) == 2
    assert told in capsys.readouterr().err
    assert not out.exists()
