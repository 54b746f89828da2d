"""The command ``as-built``: what it reads, shows, writes and refuses."""

from __future__ import annotations

import json
from pathlib import Path

from tautwire.analyses.road.shape import find_shape
from tautwire.inputs.load import load_case
from tautwire.model.build import build

from ..lines import AC_SIMPLE, ac_simple
from .conftest import Invoke


def _survey(path: Path, change: float = 0.0) -> Path:
    """Write the design's heights as a crew would: in German, with decimal commas, in mm."""
    shape = find_shape(build(ac_simple()))
    rows = ["Aufnahme vom 12. Juli", "Feld;Hänger;Stützpunkt;Fahrdrahthöhe [mm]"]
    for span, number, height in zip(
        shape.dropper_span, shape.dropper_number, shape.dropper_heights, strict=True
    ):
        rows.append(f"{span};{number};;{1e3 * (height + change):.1f}".replace(".", ","))
    rows += [f";;{n};5300,0" for n in (2, 3)]
    path.write_text("\n".join(rows), encoding="utf-8")
    return path


def test_shows_and_writes(invoke: Invoke, tmp_path: Path) -> None:
    """The design's own heights give the design back; the case that is written is read again."""
    case = tmp_path / "line.json"
    case.write_text(json.dumps(AC_SIMPLE), encoding="utf-8")
    survey = _survey(tmp_path / "survey.csv")
    shown = invoke("as-built", case, survey, "--out", "out")
    assert shown.code == 0, shown.err
    assert "27: 0 slack" in shown.out
    built = load_case(tmp_path / "out" / "as-built.yaml")
    lengths = find_shape(build(built)).dropper_lengths_unstrained
    design = find_shape(build(ac_simple())).dropper_lengths_unstrained
    assert abs(lengths - design).max() < 2e-4
    droppers = {k: v for k, v in AC_SIMPLE["droppers"].items() if k not in ("positions", "presag")}
    droppers |= {"mode": "length", "length_kind": "unstrained"}
    named = {**AC_SIMPLE, "droppers": droppers, "tables": {"droppers": "out/droppers.csv"}}
    (tmp_path / "again.json").write_text(json.dumps(named), encoding="utf-8")
    again = find_shape(build(load_case(tmp_path / "again.json"))).dropper_lengths_unstrained
    assert abs(again - lengths).max() < 6e-6  # the case has hundredths of a millimetre
    page = (tmp_path / "out" / "as-built.html").read_text(encoding="utf-8")
    assert "No dropper hangs in the wrong place" in page
    again = invoke("as-built", case, survey, "--json", "--accuracy", "5 mm")
    assert len(again.document["droppers"]) == 27


def test_refuses_with_a_cure(invoke: Invoke, tmp_path: Path) -> None:
    """Tables that are no survey, cells that are no number and unknown masts are named."""
    case = tmp_path / "line.json"
    case.write_text(json.dumps(AC_SIMPLE), encoding="utf-8")
    bad = tmp_path / "bad.csv"
    bad.write_text("mast;contact height [m]\nM7;5.3\n1;high\n", encoding="utf-8")
    refused = invoke("as-built", case, bad)
    assert refused.code == 2
    assert "mast M7" in refused.err
    assert "'high'" in refused.err
    bad.write_text(
        "span;dropper;contact height [m];accuracy [mm]\n1;1;5.3;0\n1;2;5.3;2\n", encoding="utf-8"
    )
    refused = invoke("as-built", case, bad)
    assert refused.code == 2
    assert "row 2: accuracy of 0 m; give the standard deviation" in refused.err
    bad.write_text("a;b\n1;2\n", encoding="utf-8")
    assert "no sheet is a survey" in invoke("as-built", case, bad).err
