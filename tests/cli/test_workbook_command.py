"""From the spreadsheet to the report with one command."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import openpyxl
import pytest

from tautwire.cli.app import run_command_line
from tautwire.results.storage import load_run

SPANS = (50, 55, 60, 60, 58, 54, 60, 60, 48, 45, 50, 57, 60, 60, 60, 52, 54, 60, 55, 50)
COARSE = ["--set", "settings.nodes_between_droppers=3", "--set", "settings.time_step=2 ms",
          "--set", "scenario.uplift_force=110 N"]  # fmt: skip


def _comma(value: float, digits: int) -> str:
    return f"{value:.{digits}f}".replace(".", ",")


def german_workbook(path: Path) -> Path:
    """Write a line of 20 unequal spans: names, km, staggers, dropper lengths, wires by name."""
    book = openpyxl.Workbook()
    masts, droppers, wires = book.active, book.create_sheet("Hänger"), book.create_sheet("Leiter")
    assert masts is not None
    masts.title = "Maste"
    masts.append(["Strecke 4711, Blatt 3"])
    masts.append(["Mast-Nr.", "Bau-km", "Seitenlage [cm]", "Fahrdrahthöhe [m]", "Systemhöhe [m]",
                  "Bemerkung"])  # fmt: skip
    for i in range(len(SPANS) + 1):
        place = 12300 + sum(SPANS[:i])
        masts.append([f"12/{i + 1}", f"{place // 1000}+{place % 1000:03d}", 20 * (-1) ** i, "5,30",
                      "1,40", "Weiche" if i == 7 else None])  # fmt: skip
    droppers.append(["Mast", "Hänger-Nr.", "Abstand vom Stützpunkt [m]", "Hängerlänge [mm]"])
    for i, span in enumerate(SPANS):
        for k in range(8):
            x = 4.5 + k * (span - 9.0) / 7.0
            length = 1.4 - 1.42 * 9.81 * x * (span - x) / (2.0 * 10e3)
            droppers.append([f"12/{i + 1}" if k == 0 else None, k + 1, _comma(x, 2),
                             round(1e3 * length)])  # fmt: skip
    wires.append(["Leiter", "Bauart", "Zugkraft [kN]"])
    wires.append(["Fahrdraht", "Ri 100", "10,0"])
    wires.append(["Tragseil", "Bz II 50", "10,0"])
    book.save(path)
    return path


def test_one_command_from_workbook_to_report(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The untouched workbook becomes a report with one command, which writes the mapping itself."""
    monkeypatch.chdir(tmp_path)
    path = german_workbook(tmp_path / "Strecke.xlsx")
    before = path.read_bytes()
    assert run_command_line(["run", "Strecke.xlsx", *COARSE, "--out", "out"]) == 0
    told = capsys.readouterr()
    assert "Bau-km" in told.out
    assert path.read_bytes() == before
    mapping = (tmp_path / "Strecke.mapping.yaml").read_text(encoding="utf-8")
    assert '"Bemerkung": aside' in mapping
    run = load_run(tmp_path / "out" / "run.nc")
    case = run.case
    assert case.line.span_lengths() == SPANS
    assert case.line.masts is not None
    assert case.line.place_of_support(20) == "mast 12/21, km 13.408"
    assert case.supports.contact_staggers(21)[:2] == (0.2, -0.2)
    assert run.status == "done"
    report = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "12/8" in report
    rows = (tmp_path / "out" / "droppers.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0].startswith("span,dropper,mast,position [m],x [m],chainage [m]")
    assert len(rows) == 1 + 8 * len(SPANS)


def test_static_and_second_run_of_a_workbook(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """``static`` of the workbook gives page and sheets; its line.xlsx is the same case again."""
    from tautwire.inputs.load import load_case

    monkeypatch.chdir(tmp_path)
    german_workbook(tmp_path / "Strecke.xlsx")
    assert run_command_line(["static", "Strecke.xlsx", *COARSE[:2], "--out", "st"]) == 0
    first: Any = load_case("Strecke.xlsx", [COARSE[1]])
    again = load_case(tmp_path / "st" / "line.xlsx")
    assert again == first
    page = (tmp_path / "st" / "static.html").read_text(encoding="utf-8")
    assert "12/8" in page
    assert "12350.000" in page


def test_tables_of_a_case_are_shown_as_they_are_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """How the columns of a table that a case names are read is shown, those kept aside named."""
    monkeypatch.chdir(tmp_path)
    table = "span,Hanger no.,Distance from mast [m],Pre-sag [mm],Bag\n1,1,10,0,A\n1,2,45,0,B\n"
    Path("hangers.csv").write_text(table, encoding="utf-8")
    text = "schema: 2\ninclude: ac-simple\nline: {spans: 1}\ntables: {droppers: hangers.csv}\n"
    Path("line.yaml").write_text(text + "settings: {section: [1, 1]}\n", encoding="utf-8")
    assert run_command_line(["check", "line.yaml"]) == 0
    lines = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    at = lines.index("hangers read as droppers")
    assert lines[at + 1 : at + 6] == [
        "span span",
        "Hanger no. dropper",
        "Distance from mast [m] position [m]",
        "Pre-sag [mm] presag [mm]",
        "Bag kept aside",
    ]
