"""The layout plan of a line: what stands in its files, read back, and what is refused."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import tautwire as tw
from tautwire.catalogue.entries import list_entries
from tautwire.cli.app import run_command_line
from tautwire.errors import InputError
from tautwire.line.alignment import alignment
from tautwire.report.figures.packing import simplified
from tautwire.report.layout_plan.alignment import bends, rises
from tautwire.report.layout_plan.content import side_in_words
from tautwire.report.layout_plan.items import LAYERS, spread, text_width
from tautwire.report.layout_plan.plan import LayoutPlan
from tautwire.report.layout_plan.strip import TOLERANCE, Piece, Strip
from tautwire.specs.project import Project

SVG = "{http://www.w3.org/2000/svg}"
POINTS_PER_MM = 72.0 / 25.4
SHORT = {"line.spans": 6}


def drawn(name: str, overrides: dict[str, Any] | None = None, **how: str) -> LayoutPlan:
    """Return the plan of a case."""
    case = tw.load_case(name, overrides or {})
    return tw.layout_plan(case, tw.find_shape(tw.build(case)), **how)


@pytest.fixture(scope="module")
def shape() -> tw.Equilibrium:
    """Return the static state of a short simple line."""
    return tw.find_shape(tw.build(tw.load_case("ac-simple", SHORT)))


@pytest.fixture(scope="module")
def curve() -> LayoutPlan:
    """Return the plan of two tension lengths with an overlap in a curve."""
    return drawn("ac-simple-curve")


def modelspace(plan: LayoutPlan, folder: Path) -> Any:
    """Write a plan as DXF, and return its drawing as a CAD library reads it."""
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.readfile(plan.write(folder / "plan.dxf"))
    assert not document.audit().errors
    return document.modelspace()


def texts_of(space: Any) -> list[str]:
    """Return the texts of a drawing."""
    return [entity.dxf.text for entity in space.query("TEXT")]


# ---- DXF: true to scale ------------------------------------------------------------------------


@pytest.mark.parametrize(("scale", "times"), [("1:1000/1:100", 10.0), ("1:500/1:500", 1.0)])
def test_dxf_is_true_to_scale(
    shape: tw.Equilibrium, tmp_path: Path, scale: str, times: float
) -> None:
    """A unit is a metre along the track; heights above the rails at y = 0 are multiplied evenly."""
    case = tw.load_case("ac-simple", SHORT)
    space = modelspace(tw.layout_plan(case, shape, scale=scale, paper="roll"), tmp_path)
    masts = sorted({line.dxf.start.x for line in space.query('LINE[layer=="SUPPORTS"]')} - {0.0})
    np.testing.assert_allclose(masts, shape.mast_x[1:], atol=1e-3)
    droppers = list(space.query('LINE[layer=="DROPPERS"]'))
    found = np.array(sorted((d.dxf.start.x, d.dxf.start.y, d.dxf.end.y) for d in droppers))
    np.testing.assert_allclose(found[:, 0], shape.dropper_x, atol=1e-3)
    np.testing.assert_allclose(found[:, 1], times * shape.dropper_heights, atol=2e-3)
    np.testing.assert_allclose(
        found[:, 2] - found[:, 1], times * shape.dropper_lengths, atol=2e-3 * times
    )
    (rails,) = (one for one in space.query('LINE[layer=="TRACK"]') if one.dxf.start.y == 0.0 and
                one.dxf.start.x == 0.0)  # fmt: skip
    assert rails.dxf.end.x == pytest.approx(shape.mast_x[-1], abs=1e-3)


def test_drawn_wires_are_the_wires(shape: tw.Equilibrium, tmp_path: Path) -> None:
    """Thinned wires stay within the tolerance of the static state, in height and to the side."""
    case = tw.load_case("ac-simple", SHORT)
    plan = tw.layout_plan(case, shape)
    space = modelspace(plan, tmp_path)
    axis = plan.sheets.layout.axis - plan.sheets.layout.rails
    within = 1e-3 * TOLERANCE * 1000 + 1e-3
    for name, wire in zip(("CONTACT", "MESSENGER"), shape.wires, strict=True):
        lines = [np.array(one.get_points("xy")) for one in space.query(f'*[layer=="{name}"]')
                 if one.dxftype() == "LWPOLYLINE" and len(one) > 5]  # fmt: skip
        lines.sort(key=lambda points: points[0, 1])
        side, height = lines[1], lines[0]
        if side[:, 1].mean() < height[:, 1].mean():
            side, height = height, side
        assert len(height) < len(wire.s)
        assert np.interp(wire.s, *height.T) == pytest.approx(10.0 * wire.position[:, 2], abs=within)
        y = axis + 10.0 * wire.position[:, 1]
        assert np.interp(wire.s, *side.T) == pytest.approx(y, abs=within)


def test_dxf_says_what_the_line_is(curve: LayoutPlan, tmp_path: Path) -> None:
    """Names, ends, mid-point anchors, overlap, radius, cant and staggers with sides are texts."""
    space = modelspace(curve, tmp_path)
    texts = texts_of(space)
    for text in ("overlap, 3 spans", "weighted", "mid-point anchor", "T2 contact", "0 / R 400",
                 "5.300 / 5.680", "1.200 / 0.820", "R 1200 m left, cant 90 mm, 480.0 m",
                 "transition 80.0 m", "level"):  # fmt: skip
        assert text in texts, text
    assert {layer.dxf.name for layer in space.doc.layers} >= LAYERS.keys()
    assert space.doc.layers.get("TEXT").color == 7  # black or white, against the screen's
    assert space.doc.header["$INSUNITS"] == 6  # metres


def test_masts_stand_with_name_and_chainage(shape: tw.Equilibrium, tmp_path: Path) -> None:
    """Mast names and chainage of the case stand at their supports, also where chainage falls."""
    names = [f"4/{number}" for number in range(7)]
    chainage = [12624.0 - 55.0 * number for number in range(7)]
    case = tw.load_case("ac-simple", {**SHORT, "line.masts": names, "line.chainage": chainage})
    space = modelspace(tw.layout_plan(case, shape), tmp_path)
    found = {text.dxf.text: text.dxf.insert.x for text in space.query("TEXT")}
    for name, at, x in zip(names, chainage, shape.mast_x, strict=True):
        assert found[name] == pytest.approx(x, abs=1.0)
        assert found[f"{at / 1e3:.3f}"] == pytest.approx(x, abs=1.0)
    assert "chainage [km]" in found


# ---- SVG and PDF: sheets -----------------------------------------------------------------------


def test_svg_has_sheets_of_their_size(curve: LayoutPlan, tmp_path: Path) -> None:
    """The picture is in millimetres, one sheet below the other, each numbered."""
    root = ET.parse(curve.write(tmp_path / "plan.svg")).getroot()
    assert root.get("width") == "420mm"
    assert root.get("height") == f"{curve.pages * 307 - 10:g}mm"
    texts = ["".join(one.itertext()) for one in root.iter(f"{SVG}text")]
    assert [text for text in texts if re.fullmatch(r"\d of \d", text)] == [
        f"{number} of {curve.pages}" for number in range(1, curve.pages + 1)
    ]
    assert sum("/ 0.820" in text for text in texts) >= 2
    assert texts.count("steady arm") == curve.pages


def test_strips_show_every_span_once(curve: LayoutPlan) -> None:
    """Strips go from support to support, each where the one before ended, and fit the paper."""
    pieces = curve.sheets.pieces
    supports = curve.sheets.layout.content.supports
    assert [pieces[0].first, *(one.last for one in pieces)] == [
        *(one.first for one in pieces), len(supports) - 1,
    ]  # fmt: skip
    for drawing in curve.sheets.drawings:
        points = np.concatenate([one.points for one in drawing.strokes])
        assert points.min() >= 10.0
        assert points[:, 0].max() <= 410.0
        ends = [label.x + text_width(label.text, label.height) for label in drawing.labels
                if label.anchor == "start" and not label.is_upright]  # fmt: skip
        assert max(ends) <= 410.0


def test_pdf_has_a_page_to_a_sheet(curve: LayoutPlan, tmp_path: Path) -> None:
    """Pages have the size of the paper, in points, and there is one for every sheet."""
    pytest.importorskip("typst")
    content = curve.write(tmp_path / "plan.pdf").read_bytes()
    boxes = re.findall(rb"/MediaBox\s*\[0 0 ([\d.]+) ([\d.]+)\]", content)
    assert len(boxes) == curve.pages
    for box in boxes:
        size = [float(side) / POINTS_PER_MM for side in box]
        assert size == pytest.approx([420.0, 297.0], abs=0.1)
    assert len(content) < 200_000


@pytest.mark.parametrize("name", ["ac-simple-curve", "compound", "tram", "adif-ca160-3kv"])
def test_texts_of_a_strip_stand_clear(name: str) -> None:
    """No two texts of a plan cover each other, whatever the line is made of."""
    plan = drawn(name)
    layout = plan.sheets.layout
    last = len(layout.content.supports) - 1
    labels = Strip(layout, Piece(0, last)).drawn().labels
    boxes = np.array([box_of(label) for label in labels])
    left, low, right, high = boxes.T
    covers = (
        (left[:, None] < right - 0.01) & (left < right[:, None] - 0.01)
        & (low[:, None] < high - 0.01) & (low < high[:, None] - 0.01)
    )  # fmt: skip
    pairs = [(labels[i].text, labels[j].text) for i, j in np.argwhere(np.triu(covers, 1))]
    assert not pairs


def box_of(label: Any) -> tuple[float, float, float, float]:
    """Return left, bottom, right and top of a text [mm]."""
    width, height = text_width(label.text, label.height), label.height
    x = label.x - {"start": 0.0, "middle": 0.5, "end": 1.0}[label.anchor] * width
    if label.is_upright:
        return label.x - height, label.y, label.x, label.y + width
    return x, label.y, x + width, label.y + height


def test_title_block_has_the_project(shape: tw.Equilibrium, tmp_path: Path) -> None:
    """Client, revision and author of the project block stand on every sheet, with the logo."""
    logo = "data:image/svg+xml;base64,PHN2ZyB4bWxucz0iaHR0cDovL3d3dy53My5vcmcvMjAwMC9zdmciLz4="
    project = Project(client="Valley <Railway>", revision="B", author="A. Author", logo=logo)
    case = tw.load_case("ac-simple", SHORT).with_(project=project)
    root = ET.parse(tw.layout_plan(case, shape).write(tmp_path / "plan.svg")).getroot()
    texts = ["".join(one.itertext()) for one in root.iter(f"{SVG}text")]
    assert {"Client", "Valley <Railway>", "Revision", "B", "Author", "A. Author"} <= set(texts)
    assert [image.get("href") for image in root.iter(f"{SVG}image")] == [logo]


@pytest.mark.slow
@pytest.mark.parametrize("name", [one.name for one in list_entries() if one.kind == "case"])
def test_every_library_line_is_drawn(name: str, tmp_path: Path) -> None:
    """All lines of the library become all three kinds of file, at the usual scale on A3."""
    ezdxf = pytest.importorskip("ezdxf")
    pytest.importorskip("typst")
    plan = drawn(name)
    assert (plan.scale, plan.paper) == ("1:1000/1:100", "A3")
    for kind in ("svg", "pdf", "dxf"):
        assert plan.write(tmp_path / f"plan.{kind}").stat().st_size > 5_000
    ET.parse(tmp_path / "plan.svg")
    assert not ezdxf.readfile(tmp_path / "plan.dxf").audit().errors


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "spans", "pages"), [("ac-simple", 182, 31), ("compound", 200, 34)]
)
def test_ten_kilometres_have_at_most_a_megabyte(
    name: str, spans: int, pages: int, tmp_path: Path
) -> None:
    """A line of 10 km with nine or fifteen droppers to the span stays below 1 MB in every kind of
    file, and the DXF has nothing that has to be repaired."""
    ezdxf = pytest.importorskip("ezdxf")
    pytest.importorskip("typst")
    plan = drawn(name, {"line.spans": spans})
    sizes = {
        kind: plan.write(tmp_path / f"plan.{kind}").stat().st_size for kind in ("svg", "pdf", "dxf")
    }
    assert max(sizes.values()) <= 1_000_000, sizes
    audit = ezdxf.readfile(tmp_path / "plan.dxf").audit()
    assert not audit.errors
    assert not audit.fixes
    assert plan.pages == pytest.approx(pages, abs=1)


def test_texts_of_others_act_nowhere(shape: tw.Equilibrium, tmp_path: Path) -> None:
    """Markup, control codes of CAD programs and line ends in names stay texts in every file."""
    names = ["<b>&\"'", "^J%%c", "\N{CJK UNIFIED IDEOGRAPH-7AD9}12", *"4567"]
    case = tw.load_case("ac-simple", {**SHORT, "line.masts": names, "title": "one\ntwo"})
    plan = tw.layout_plan(case, shape)
    root = ET.parse(plan.write(tmp_path / "plan.svg")).getroot()
    assert set(names) <= {"".join(one.itertext()) for one in root.iter(f"{SVG}text")}
    found = texts_of(modelspace(plan, tmp_path))
    assert {names[0], "^ J% %c", names[2], "Layout plan: one two"} <= set(found)


def test_condition_is_drawn_and_named(tmp_path: Path) -> None:
    """In wind the wires of the plan stand aside; the title block names condition and defects."""
    defect = {"kind": "missing dropper", "span": 3, "dropper": 2}
    wind = {"speed": 20.0, "from": "left"}
    overrides = {"conditions": [{"name": "storm", "wind": wind, "defects": [defect]}],
                 "wires.contact.diameter": 0.0132, "wires.messenger.diameter": 0.014,
                 "droppers.diameter": 0.005}  # fmt: skip
    calm = drawn("ac-simple", {**SHORT, **overrides})
    storm = drawn("ac-simple", {**SHORT, **overrides, "condition": "storm"})
    middles = [
        np.interp(137.5, *plan.sheets.layout.content.wires[0].points[:, :2].T)
        for plan in (calm, storm)
    ]
    assert middles[1] < middles[0] - 0.02
    texts = texts_of(modelspace(storm, tmp_path))
    assert "storm; broken parts drawn too" in texts


# ---- scale and paper ---------------------------------------------------------------------------


def test_short_spans_get_a_larger_scale() -> None:
    """Spans of 8 m are drawn at 1:500, where the texts of neighbouring supports have room."""
    plan = drawn("tram", {"line.spans": 6, "line.span_length": "8 m"})
    assert plan.scale == "1:500/1:50"


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ({"scale": "1/1000"}, r"scale '1/1000': write lengths and heights as in 1:1000/1:100"),
        ({"scale": "1:0"}, r"1:0 is no scale of a layout plan; choose one between"),
        ({"scale": "1:20000"}, r"at least 1:2115 along the track; choose 1:1000 or larger"),
        ({"paper": "A9"}, r"paper 'A9': choose one of A3, A2, A1, A0, roll"),
        (
            {"scale": "1:1000/1:20", "paper": "A3"},
            r"564 mm high, and the sheet has room for 235 mm; choose paper A0, or the scale "
            r"1:1000/1:100",
        ),
        (
            {"scale": "1:100/1:100", "paper": "A3"},
            r"the longest span has 55 m; choose paper A1, or the scale 1:200/1:100",
        ),
    ],
)
def test_impossible_scales_are_refused(
    shape: tw.Equilibrium, how: dict[str, str], words: str
) -> None:
    """Scales that are none, too small for the texts or too large for the paper, with cures."""
    with pytest.raises(InputError, match=words):
        tw.layout_plan(tw.load_case("ac-simple", SHORT), shape, **how)


def test_cures_of_small_paper_work(shape: tw.Equilibrium) -> None:
    """Both the sheet and the scale that a refusal names are taken."""
    case = tw.load_case("ac-simple", SHORT)
    with pytest.raises(InputError) as refused:
        tw.layout_plan(case, shape, scale="1:100/1:100", paper="A3")
    paper, scale = re.findall(r"choose paper (\w+), or the scale (\S+)", str(refused.value))[0]
    assert tw.layout_plan(case, shape, scale="1:100/1:100", paper=paper).paper == paper
    assert tw.layout_plan(case, shape, scale=scale, paper="A3").scale == scale


def test_long_roll_is_no_page_of_a_pdf(shape: tw.Equilibrium, tmp_path: Path) -> None:
    """A page has at most 5.08 m; what is longer is refused before anything is written."""
    pytest.importorskip("typst")
    plan = tw.layout_plan(tw.load_case("ac-simple", SHORT), shape, scale="1:50", paper="roll")
    with pytest.raises(InputError, match=r"at most 5\.08 m; choose paper A3"):
        plan.write(tmp_path / "plan.pdf")
    assert not list(tmp_path.iterdir())


# ---- the command -------------------------------------------------------------------------------


def test_command_writes_all_kinds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One command writes what is asked for and says scale, paper and sheets."""
    pytest.importorskip("ezdxf")
    pytest.importorskip("typst")
    files = [str(tmp_path / f"plan.{kind}") for kind in ("svg", "pdf", "dxf")]
    outs = [word for file in files for word in ("--out", file)]
    code = run_command_line(["draw", "ac-simple", "--set", "line.spans=6", *outs, "--json"])
    told = json.loads(capsys.readouterr().out)
    assert code == 0
    assert told["files"] == files
    assert (told["scale"], told["paper"], told["sheets"]) == ("1:1000/1:100", "A3", 1)
    assert all(Path(file).stat().st_size > 5_000 for file in files)


def test_command_refuses_everything_at_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Endings, folders, scale, paper and missing packages are told together, before the line."""
    monkeypatch.setattr(
        "tautwire.report.layout_plan.dxf.find_spec", lambda _: None
    )  # as if it were not installed
    outs = ["-o", str(tmp_path / "a.png"), "-o", str(tmp_path / "no" / "a.svg"), "-o", "a.dxf"]
    code = run_command_line(["draw", "ac-simple", *outs, "--scale", "x", "--paper", "B5", "--json"])
    problems = json.loads(capsys.readouterr().out)["error"]["problems"]
    assert code == 2
    assert len(problems) == 5
    for words in ("written as .svg, .pdf, .dxf", "pip install 'tautwire[dxf]'", "scale 'x'",
                  "paper 'B5'", "does not exist"):  # fmt: skip
        assert sum(words in problem for problem in problems) == 1, words
    assert not list(tmp_path.iterdir())


# ---- parts -------------------------------------------------------------------------------------


def test_track_in_words() -> None:
    """Pieces of a track are told as they were given, joined where the profile cuts them."""
    pieces = [
        {"straight": 50.0}, {"transition": 40.0},
        {"arc": 100.0, "radius": 500.0, "side": "right", "cant": 0.1}, {"transition": 40.0},
        {"straight": 100.0},
    ]  # fmt: skip
    profile = [
        {"at": 0.0, "height": 0.0}, {"at": 165.0, "height": 1.65, "radius": 5000.0},
        {"at": 330.0, "height": 0.0},
    ]  # fmt: skip
    case = tw.load_case("ac-simple", {**SHORT, "track": {"pieces": pieces, "profile": profile}})
    track = alignment(case.track, case.line)
    curves = bends(track, case.track.rail_distance, 330.0)
    assert [one.texts[0] for one in curves] == [
        "straight 50.0 m", "transition 40.0 m", "R 500 m right, cant 100 mm, 100.0 m",
        "transition 40.0 m", "straight 100.0 m",
    ]  # fmt: skip
    assert [one.texts[0] for one in rises(track, 330.0)] == [
        "+10.00 ‰", "crest, Rv 5000 m", "-10.00 ‰",
    ]  # fmt: skip
    for before, after in pairwise(curves):
        assert before.end == pytest.approx(after.start)


def test_short_pieces_of_track_are_told_as_left_out(shape: tw.Equilibrium) -> None:
    """Where no text has room, the plan counts it."""
    pieces = [{"straight": 150.0}, {"arc": 5.0, "radius": 9e3, "side": "left"}, {"straight": 175.0}]
    case = tw.load_case("ac-simple", {**SHORT, "track": pieces})
    assert tw.layout_plan(case, tw.find_shape(tw.build(case))).left_out == 1
    assert tw.layout_plan(tw.load_case("ac-simple", SHORT), shape).left_out == 0


def random_places(seed: int) -> Iterator[tuple[np.ndarray, float]]:
    """Yield rising places between 0 and 100 and a pitch that leaves room for all."""
    random = np.random.default_rng(seed)
    for count in (1, 2, 5, 20):
        yield np.sort(random.uniform(0.0, 100.0, count)), 90.0 / count


def test_spread_texts_stand_apart_and_close() -> None:
    """Moved texts keep order, pitch and limits; those that have room stay where they were."""
    for wanted, pitch in random_places(3):
        found = spread(wanted.tolist(), pitch, 0.0, 100.0)
        assert np.all(np.diff(found) >= pitch - 1e-9)
        assert found.min() >= 0.0
        assert found.max() <= 100.0 + 1e-9
    assert spread([10.0, 20.0, 21.0, 50.0], 3.0, 0.0, 60.0).tolist() == [10.0, 19.0, 22.0, 50.0]


def test_thinned_line_stays_within_tolerance() -> None:
    """A parabola of f = 12 mm needs sqrt(f / tolerance) chords; halving takes at most twice."""
    x = np.linspace(0.0, 50.0, 1001)
    points = np.stack([x, 12.0 * ((x - 25.0) / 25.0) ** 2], axis=1)
    kept = simplified(points, 0.03)
    steepest = np.hypot(1.0, 4.0 * 12.0 / 50.0)
    assert np.abs(np.interp(x, *kept.T) - points[:, 1]).max() <= 0.03 * steepest
    assert 1.0 <= (len(kept) - 1) / np.sqrt(12.0 / 0.03) <= 2.0
    assert len(simplified(np.stack([x, 2.0 * x], axis=1), 0.03)) == 2


def test_sides_are_named() -> None:
    """Left of rising distance is L; what rounds to nothing has no side."""
    assert [side_in_words(y) for y in (0.2, -0.1504, 4e-4, -4e-4)] == ["L 200", "R 150", "0", "0"]
