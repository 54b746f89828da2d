"""The workshop sheet: cut lengths, what rounding does to the line, quantities, the static page."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pytest

from tautwire.analyses.design.workshop import WorkshopSheet, too_short, workshop_sheet
from tautwire.analyses.road.shape import find_cut, find_shape
from tautwire.cli.app import run_command_line
from tautwire.files import write_bytes
from tautwire.inputs.load import load_case
from tautwire.model.build import Model, build
from tautwire.report.parts.design.workshop_words import rounding_in_words, workshop_sheets
from tautwire.results.equilibrium import Equilibrium
from tautwire.tables.writing import workbook_bytes

COARSE = ["settings.nodes_between_droppers=4"]


def sheet_of(name: str, **given: Any) -> tuple[Model, Equilibrium, WorkshopSheet]:
    """Return model, design and workshop sheet of a library line."""
    case = load_case(name, COARSE).with_(workshop=given)
    model = build(case)
    shape = find_shape(model)
    return model, shape, workshop_sheet(model, shape)


def test_cut_length_is_the_closed_form() -> None:
    """Rope is the unstrained length between axes less deductions plus two loops, to the step."""
    _, shape, sheet = sheet_of(
        "ac-simple", upper_clamp=0.035, lower_clamp=0.02, loop=0.06, step=5e-3
    )
    rope = shape.dropper_lengths_unstrained - 0.055 + 0.12
    assert sheet.exact == pytest.approx(rope, abs=1e-12)
    assert np.abs(sheet.cut - rope).max() <= 2.5e-3 + 1e-12
    assert sheet.cut / 5e-3 == pytest.approx(np.rint(sheet.cut / 5e-3), abs=1e-9)
    assert sheet.axes - shape.dropper_lengths_unstrained == pytest.approx(sheet.cut - rope)


@pytest.mark.parametrize("name", ["ac-simple", "ac-stitched", "dc-twin", "ac-simple-overlap"])
def test_rounding_that_changes_nothing(name: str) -> None:
    """Cut to a nanometre, the line is that of the design: heights to 1 um, forces to 0.01 N."""
    _, _, sheet = sheet_of(name, step=1e-9)
    assert np.abs(sheet.height_change).max() < 1e-6
    assert np.abs(sheet.force_change).max() < 1e-2
    _, shape, unrounded = sheet_of(name, step=0.0)
    assert unrounded.as_cut is shape


def test_all_droppers_longer_lower_the_wire() -> None:
    """All droppers longer by 1 mm lower the contact wire by 1 mm in the middle of the spans."""
    model, shape, _ = sheet_of("ac-simple")
    longer = find_cut(model, shape.dropper_lengths_unstrained + 1e-3)
    middle = (shape.dropper_span > 6) & (shape.dropper_span < 12)
    lowered = shape.dropper_heights - longer.dropper_heights
    inner = middle & (shape.dropper_number > 2) & (shape.dropper_number < 8)
    assert lowered[inner] == pytest.approx(1e-3, abs=2e-4)


def test_sheet_read_back_is_the_line_as_cut(tmp_path: Path) -> None:
    """The workbook as a table of droppers gives the heights that the sheet promises, to 0.1 mm."""
    for name in ("ac-simple", "ac-stitched"):
        model, shape, sheet = sheet_of(name, step=5e-3, upper_clamp=0.04)
        book = workshop_sheets(model.case, shape, sheet)
        write_bytes(tmp_path / "workshop.xlsx", workbook_bytes(book))
        (tmp_path / "cut.yaml").write_text(
            f"schema: 2\ninclude: {name}\nname: cut\ntables: {{droppers: workshop.xlsx}}\n",
            encoding="utf-8",
        )
        again = find_shape(build(load_case(tmp_path / "cut.yaml", COARSE)))
        assert again.dropper_heights == pytest.approx(sheet.as_cut.dropper_heights, abs=1e-5)
        assert again.dropper_forces == pytest.approx(sheet.as_cut.dropper_forces, abs=0.1)


def test_quantities_add_up() -> None:
    """Unstrained wires are spans less their stretch; classes hold every dropper and its rope."""
    model, shape, sheet = sheet_of("ac-stitched", length_class=0.05)
    wires = {one.wire: one for one in sheet.wires}
    case = model.case
    stretch = case.wires.contact.tension / case.wires.contact.axial_stiffness
    zigzag = sum(np.hypot(span, 0.5) for span in case.line.span_lengths())
    assert wires["contact"].length == pytest.approx(zigzag / (1 + stretch), rel=1e-5)
    assert wires["stitch"].pieces == case.line.spans - 1
    assert wires["contact"].mass == pytest.approx(1.08 * wires["contact"].length)
    assert sum(one.count for one in sheet.classes) == shape.dropper_x.size
    assert sum(one.rope for one in sheet.classes) == pytest.approx(sheet.cut.sum())
    inside = [one.begin <= one.rope / one.count < one.end for one in sheet.classes]
    assert all(inside)
    counts = dict(sheet.clamps)
    assert counts["dropper clamps on contact, lower"] == shape.dropper_x.size
    assert counts["steady arm clamps on contact"] == case.line.spans - 1
    assert counts["clamps of stitch on messenger"] == 2 * (case.line.spans - 1)


def test_clamps_that_leave_no_length_are_told() -> None:
    """A deduction larger than a dropper is no crash; the dropper is named."""
    _, shape, sheet = sheet_of("ac-simple", upper_clamp=0.4, lower_clamp=0.4)
    assert too_short(sheet).size == (shape.dropper_lengths_unstrained <= 0.8).sum() > 0
    assert "moves the wire by at most" in rounding_in_words(shape, sheet)


def test_workshop_changes_no_result() -> None:
    """The key changes neither the hash of a case nor its shape."""
    case = load_case("ac-simple", COARSE)
    assert case.with_(workshop={"step": "5 mm", "loop": "80 mm"}).hash() == case.hash()


def test_static_writes_page_and_workshop_sheet(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """``static --out`` writes page and sheet, which say what rounding does; ``--no-report``."""
    arguments = ["static", "ac-stitched", "--set", COARSE[0], "--set", "workshop.step=5 mm"]
    assert run_command_line([*arguments, "--out", str(tmp_path / "a")]) == 0
    told = re.search(r"moves the wire by at most\s+([0-9.]+) mm", capsys.readouterr().out)
    assert told is not None
    page = (tmp_path / "a" / "static.html").read_text(encoding="utf-8")
    for words in ("AC stitched", "Workshop sheet", "Supports, installation", "Checks of the design",
                  "non-uniformity", f"moves the wire by at most {told.group(1)} mm"):  # fmt: skip
        assert words in page
    book = openpyxl.load_workbook(tmp_path / "a" / "workshop.xlsx", data_only=True)
    assert book.sheetnames == ["droppers", "wire quantities", "dropper quantities", "clamps",
                               "notes"]  # fmt: skip
    assert f"at most {told.group(1)} mm" in str(book["notes"]["A3"].value)
    assert run_command_line([*arguments, "--out", str(tmp_path / "b"), "--no-report"]) == 0
    assert not (tmp_path / "b" / "static.html").exists()
    assert (tmp_path / "b" / "workshop.xlsx").exists()
