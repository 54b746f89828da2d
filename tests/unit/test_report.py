"""The report: one page, complete, self-contained, honest about what is missing."""

from __future__ import annotations

import base64
import dataclasses
import json
import re
import zlib
from hashlib import sha256
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tautwire.analyses.force.contact_loss import contact_loss
from tautwire.errors import InputError
from tautwire.model.irregularity import draw_irregularities
from tautwire.report.pages.run_page import write_report
from tautwire.report.parts.blocks import Chart
from tautwire.report.writers.html import chart_library, without_addresses
from tautwire.results.run import Run

from .synthetic import make_case, make_elasticity, make_run

SECTIONS = [
    *(
        "summary",
        "line",
        "force",
        "losses",
        "spectrum",
        "uplift",
        "droppers",
        "elasticity",
        "inputs",
    ),
    "animation",
]
LARGEST = 3_000_000
"""Bytes of a page that is sent by mail."""
CHANGED_WIRE = {
    "tension": 2.1e4, "mass": 1.2, "axial_stiffness": 1.2e7, "bending_stiffness": 110.0,
    "strength": 5e4, "diameter": 0.012, "thermal_expansion": 1.6e-5,
}  # fmt: skip
LARGEST_OF_MANY = 12_000_000


class _Page(HTMLParser):
    """Elements, texts and scripts of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.data: dict[str, str] = {}
        self.scripts: list[str] = []
        self._inside: tuple[str, str] | None = None
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag in ("script", "style"):
            self._inside = (tag, dict(attrs).get("id") or "")

    def handle_endtag(self, tag: str) -> None:
        if tag in ("script", "style"):
            self._inside = None

    def handle_data(self, data: str) -> None:
        if self._inside is None:
            self.words.append(data)
        elif self._inside[1]:
            self.data[self._inside[1]] = self.data.get(self._inside[1], "") + data
        elif self._inside[0] == "script":
            self.scripts.append(data)

    @property
    def text(self) -> str:
        """Everything a person reads, spaces made even."""
        return " ".join(" ".join(self.words).split())

    def ids(self, tag: str) -> list[str | None]:
        """Identifiers of all elements of a kind."""
        return [attrs.get("id") for name, attrs in self.elements if name == tag]


def _page(runs: Run | list[Run], folder: Path, *args: Any, **more: Any) -> _Page:
    path = write_report(runs, folder / "report.html", *args, **more)
    return _Page(path.read_text(encoding="utf-8"))


def _chart(kind: str) -> Chart:
    return Chart(kind, json.dumps({"data": [{"type": kind}], "layout": {}}), "", "", 400)


def _unpacked(item: dict[str, Any]) -> np.ndarray:
    return np.frombuffer(base64.b64decode(item["bdata"]), dtype=f"<{item['dtype']}")


def _inflated(item: dict[str, Any]) -> bytes:
    return zlib.decompress(base64.b64decode(item["data"]))


@pytest.fixture(scope="module")
def run() -> Run:
    """A run over 17 spans with two losses of contact."""
    return make_run(losses=True)


@pytest.fixture(scope="module")
def path(run: Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its report."""
    folder = tmp_path_factory.mktemp("report")
    return write_report(run, folder / "report.html", make_elasticity(run.case))


@pytest.fixture(scope="module")
def page(path: Path) -> _Page:
    """The report, parsed."""
    return _Page(path.read_text(encoding="utf-8"))


def test_page_is_small(path: Path) -> None:
    """The report of a 17-span run has less than 3 MB and is a single file."""
    assert path.stat().st_size < LARGEST
    assert [item.name for item in path.parent.iterdir()] == ["report.html"]


def test_overlay_is_small(run: Run, tmp_path: Path) -> None:
    """So has the report of two such runs, overlaid, each with its film."""
    path = write_report([run, run], tmp_path / "report.html", make_elasticity(run.case))
    assert path.stat().st_size < LARGEST


def test_page_needs_no_network(path: Path, page: _Page) -> None:
    """Nothing on the page refers to another machine, and the browser is told to allow nothing."""
    links = [
        value
        for _, attrs in page.elements
        for name, value in attrs.items()
        if name in ("src", "href", "srcset", "data", "action", "poster")
    ]
    assert all(link and link.startswith(("#", "data:,")) for link in links)
    text = path.read_text(encoding="utf-8")
    assert not re.search(r"""(src|href)\s*=\s*\\?["'`]?https?://""", text)
    assert not re.search(r"@import|import\(\s*[\"'`]https?://|fetch\([\"'`]https?:", text)
    addresses = re.findall(r"""["'`]https?://([^/"'`]+)""", text)
    assert set(addresses) <= {"www.w3.org"}
    policies = [a["content"] for _, a in page.elements if "http-equiv" in a]
    assert policies
    assert policies[0].startswith("default-src 'none';")


def test_chart_library_stands_once(page: _Page) -> None:
    """plotly.js is on the page exactly once."""
    assert sum("plotly.js (basic" in script[:200] for script in page.scripts) == 1


def test_figures_that_need_more_get_a_larger_chart_library() -> None:
    """Only box plots and heat maps ask for the plotly.js with more kinds of traces."""
    plain = [_chart("scatter"), _chart("bar")]
    assert "plotly.js (basic" in chart_library(plain)[:200]
    assert "plotly.js (cartesian" in chart_library([*plain, _chart("box")])[:200]


def test_all_sections_are_present(page: _Page) -> None:
    """All nine sections are there, numbered, and reached from the table of contents."""
    assert page.ids("section") == SECTIONS
    links = [attrs["href"] for tag, attrs in page.elements if tag == "a"]
    assert links[1:-1] == [f"#{name}" for name in SECTIONS]
    assert links[-1] == "#animation"
    assert "See the passage move" in page.text


def test_every_figure_has_data_a_caption_and_a_text(page: _Page) -> None:
    """Every chart finds its data, says what it shows, and has a numbered caption."""
    charts = [attrs for _, attrs in page.elements if attrs.get("class") == "chart"]
    assert len(charts) == 11
    for attrs in charts:
        content = json.loads(page.data[f"{attrs['id']}-data"])
        assert content["data"]
        assert attrs["role"] == "img"
        assert attrs["aria-label"]
    numbers = [int(n) for n in re.findall(r"Figure (\d+)\.", page.text)]
    assert numbers == list(range(1, 13))


def test_identifiers_are_unique(page: _Page) -> None:
    """No identifier stands twice."""
    ids = [attrs["id"] for _, attrs in page.elements if attrs.get("id")]
    assert len(ids) == len(set(ids))


def test_summary_tells_the_result(page: _Page) -> None:
    """The first sentence names speed, section, mean, deviation, filter and contact losses."""
    text = page.text
    assert "At 320 km/h, over spans 4 to 13, pantograph front presses on the contact wire" in text
    assert "sharp filter" in text
    assert "it loses contact 2 times" in text


def test_filters_are_named_with_their_numbers(page: _Page) -> None:
    """Captions of filtered forces give family, order and cut-off."""
    assert page.text.count("sharp low-pass, cut-off 20 Hz") >= 4
    assert "Butterworth low-pass, order 6 forward and backward, cut-off 20 Hz" in page.text
    assert "the same with a cut-off of 200 Hz" in page.text


def test_unverified_limits_never_pass(page: _Page) -> None:
    """A limit that was not compared with its standard is called unverified, never passed."""
    verdicts = [a["class"] for _, a in page.elements if "verdict" in (a.get("class") or "")]
    assert len(verdicts) >= 5
    assert set(verdicts) == {"verdict unverified"}
    assert "no verdict is given" in page.text


def test_inputs_show_source_and_confidence(page: _Page) -> None:
    """Every input is listed; its source is the one of the smallest group that names it."""
    text = page.text
    assert "droppers.presag 0, 0.024, 0.041, 0.052, 0.055, 0.052, 0.041, 0.024, 0 m [2]" in text
    assert "wires.contact.tension 22000 N [1] choice" in text
    assert "settings.contact_stiffness 200000 N/m" in text
    for word in ("contact stiffness", "closure at the supports", "wire ends", "damping"):
        assert word in text


def test_force_curve_is_not_thinned(page: _Page, run: Run) -> None:
    """Up to 24,000 samples the drawn unfiltered force is the computed one, sample by sample."""
    raw = json.loads(page.data["chart-force-data"])["data"][0]
    drawn = _unpacked(raw["y"])
    assert drawn.size == run.time.size
    assert np.allclose(drawn, run.pantographs[0].contact_force, atol=1e-4)


def test_losses_are_listed(page: _Page) -> None:
    """Each loss of contact has a row with its place."""
    assert page.text.count("dropper 3 of span") >= 2


def test_losses_are_told_as_a_surrogate(page: _Page) -> None:
    """The section counts losses of 5 ms and longer, sorts them into classes, says where its
    instants come from and that no arc is modelled."""
    assert "losses of contact" in page.text
    assert "of 5 ms or longer. The longest lasts" in page.text
    assert "Losses of contact are a surrogate for measured arcing: no arc is modelled" in page.text
    assert "5 to 10 ms" in page.text
    assert "re-contact are interpolated between samples" in page.text


def test_longest_losses_are_enlarged(page: _Page, run: Run) -> None:
    """Each panel shows the unfiltered samples around a loss, and the loss as a bar."""
    figure = json.loads(page.data["chart-losses-data"])
    loss = contact_loss(run)[0].events[0]
    bars = [t for t in figure["data"] if t.get("hovertemplate", "").startswith("lost for")]
    assert any(bar["x"] == [loss.start, loss.start + loss.duration] for bar in bars)
    curve = next(t for t in figure["data"] if t["name"] == "unfiltered")
    time = _unpacked(curve["x"])
    assert time.min() >= loss.start - 0.0121
    assert time.max() <= loss.start + loss.duration + 0.0121


def test_runs_are_compared_loss_by_loss(run: Run, tmp_path: Path) -> None:
    """Of two runs of one passage the report says what the first missed and invented against the
    last; runs at different speeds are not compared."""
    gap = run.pantographs[0].gap.copy()
    lost = np.flatnonzero((gap >= 0.0) & (run.pantographs[0].position > 300.0))
    first = lost[: int(np.argmax(np.diff(lost) > 1)) + 1]
    gap[first] = -1e-3
    record = dataclasses.replace(run.pantographs[0], gap=gap)
    fewer = dataclasses.replace(run, pantographs=(record,))
    page = _page([fewer, run], tmp_path, labels=["coarse", "fine"])
    assert "The runs loss by loss" in page.text
    assert "Against fine" in page.text
    assert "missed" in page.text
    faster = make_case(scenario={"speed": 300 / 3.6, "mean_force": 169.0})
    other = make_run(faster, losses=True)
    assert "loss by loss" not in _page([other, run], tmp_path).text


def test_conditions_name_step_control_and_irregularities(tmp_path: Path) -> None:
    """The conventions name the step control as it ran, and irregularities with their seed; what was
    drawn is a figure."""
    irregularities = {
        "installation": {"of": "height", "amplitude": 1e-3},
        "unevenness": [{"kind": "uniform", "spacing": 1.0, "amplitude": 1e-3}],
    }
    case = make_case(irregularities=irregularities, settings={"contact_stiffness": 2e5, "seed": 42})
    plain = make_run(case, losses=True)
    run = dataclasses.replace(
        plain,
        irregularities=draw_irregularities(case),
        counters={**plain.counters, "step_control": "variable step 1 ms, located to 0.0001 m"},
    )
    page = _page(run, tmp_path)
    assert "variable step 1 ms, located to 0.0001 m" in page.text
    assert "errors of dropper height (uniform) and unevenness (uniform), seed 42" in page.text
    assert "chart-irregularities-data" in page.data
    assert "Irregularities as drawn, seed 42" in page.text
    assert "irregularities.unevenness[1].amplitude" in page.text


def test_animation_has_its_data(page: _Page, run: Run) -> None:
    """The film holds shapes and motion; the canvas can be reached and has a text."""
    [film] = json.loads(page.data["film-data"])
    assert len(film["supports"]) == run.case.line.spans + 1
    assert [p["name"] for p in film["pantographs"]] == ["front"]
    contact = film["frames"]["wires"][0]
    moved = np.frombuffer(_inflated(contact["moved"]), dtype="u1")
    count, frames = contact["count"], run.snapshots.time.size
    assert moved.size == count * frames
    [canvas] = [attrs for tag, attrs in page.elements if tag == "canvas"]
    assert canvas["aria-label"]
    assert canvas["tabindex"] == "0"


def test_animation_keeps_the_shape(page: _Page, run: Run) -> None:
    """Heights read back from the film equal the stored ones within half a step of 1/255."""
    [film] = json.loads(page.data["film-data"])
    contact, (_, frames) = film["frames"]["wires"][0], run.snapshots.of(0)
    packed = contact["moved"]
    changes = np.frombuffer(_inflated(packed), dtype="u1").reshape(-1, packed["row"])
    moved = np.cumsum(changes, axis=0, dtype="u1").astype(float)
    still = np.frombuffer(_inflated(contact["still"]), dtype="<f4")
    heights = packed["low"] + packed["step"] * moved + still
    assert np.abs(heights - frames).max() <= 0.51 * packed["step"] + 1e-6
    assert packed["step"] < 1e-3


@pytest.fixture(scope="module")
def overlaid(tmp_path_factory: pytest.TempPathFactory) -> _Page:
    """The report of two runs, one of them with two pantographs."""
    first = make_run(make_case(spans=8))
    second = make_case(spans=8, pantographs=2, settings={"contact_stiffness": 5e4})
    runs = [first, make_run(second, force=150.0)]
    return _page(runs, tmp_path_factory.mktemp("overlaid"), [make_elasticity(first.case), None])


def test_runs_are_overlaid(overlaid: _Page) -> None:
    """Every run and pantograph has its own curve, label, colour and dash."""
    data = json.loads(overlaid.data["chart-force-data"])["data"]
    low = [trace for trace in data if "0–20 Hz" in trace.get("name", "")]
    assert [trace["name"] for trace in low] == [
        "200 kN/m, front, 0–20 Hz",
        "50 kN/m, front, 0–20 Hz",
        "50 kN/m, rear, 0–20 Hz",
    ]
    assert len({trace["line"]["color"] for trace in low}) == 3
    assert len({trace["line"]["dash"] for trace in low}) == 3


def test_masthead_speaks_of_every_run(tmp_path: Path) -> None:
    """Lines, sections, stiffnesses and hashes of all runs stand in the head, not the first's."""
    one = make_run(make_case(spans=8))
    other = make_run(make_case(spans=12, settings={"contact_stiffness": 5e4}))
    path = write_report([one, other], tmp_path / "report.html", labels=["long", "short"])
    text = path.read_text(encoding="utf-8")
    head = text[text.index("<header") : text.index("</header")]
    assert "8 spans, 440 m and 12 spans, 660 m" in head
    assert "200 kN/m and 50 kN/m" in head
    for run in (one, other):
        assert run.case.hash()[:12] in text[text.rindex("<footer") :]


def _rows(page: Path, first: str, last: str) -> str:
    text = page.read_text(encoding="utf-8")
    part = text[text.index(first) : text.index(last)]
    return " ".join(re.sub(r"<[^>]+>", " ", part).split())


def test_overlay_begins_with_what_differs(tmp_path: Path) -> None:
    """Figures of lines that differ, results and inputs stand first, with the change from the first
    run; what is alike is left out, and an item that one run lacks is one row."""
    one = make_run(make_case(spans=8))
    faster = {"speed": 300 / 3.6, "mean_force": 169.0}
    other = make_run(make_case(spans=12, pantographs=2, scenario=faster))
    path = write_report([one, other], tmp_path / "report.html", labels=["long", "short"])
    told = _rows(path, "What differs between the runs", ">Results<")
    change = 100.0 * (300.0 / 320.0 - 1.0)
    assert "spans 8 12 (+50.0 %)" in told
    even = told.replace("\xa0", " ")
    assert f"speed 320 km/h 300 km/h (\N{MINUS SIGN}{-change:.1f} %)" in even
    assert "tension, contact" not in told
    assert "mean contact force" in told
    assert "pantographs[2] – given" in told
    assert "pantographs[2]." not in told
    alone = write_report(one, tmp_path / "alone.html").read_text(encoding="utf-8")
    assert "What differs" not in alone


def test_many_differences_are_folded_away(tmp_path: Path) -> None:
    """More than a dozen inputs that differ do not push the results out of sight."""
    run = make_run(make_case(spans=6))
    changes = {f"wires.contact.{name}": value for name, value in CHANGED_WIRE.items()}
    changes |= {f"wires.messenger.{name}": value for name, value in CHANGED_WIRE.items()}
    changes |= {"line.damping.mass": 0.02, "line.damping.stiffness": 1e-5}
    other = dataclasses.replace(run, case=run.case.with_(**changes))
    told = _rows(write_report([run, other], tmp_path / "a.html"), "What differs", ">Results<")
    shown, folded = told.split("more difference", 1)
    assert shown.rsplit(None, 1)[-1].isdigit()
    assert "wires.messenger.mass" in shown + folded


def test_runs_stand_side_by_side(overlaid: _Page) -> None:
    """The statistics have a column per run, pantograph and filter; differences are listed."""
    assert "200 kN/m, front 50 kN/m, front 50 kN/m, rear" in overlaid.text
    assert "settings.contact_stiffness 200000 N/m 50000 N/m" in overlaid.text


def test_films_can_be_chosen(overlaid: _Page) -> None:
    """With several runs the animation offers each of them."""
    films = json.loads(overlaid.data["film-data"])
    assert [len(film["pantographs"]) for film in films] == [1, 2]
    assert sum(attrs.get("data-part") == "film" for _, attrs in overlaid.elements) == 1


def test_many_runs_stay_small(tmp_path: Path) -> None:
    """Twelve overlaid runs of 17 spans stay below 15 MB."""
    base = make_run()
    runs = [
        dataclasses.replace(
            base, case=base.case.with_(**{"settings.contact_stiffness": 1e4 * (n + 1)})
        )
        for n in range(12)
    ]
    assert write_report(runs, tmp_path / "many.html").stat().st_size < LARGEST_OF_MANY


def test_names_are_escaped(tmp_path: Path) -> None:
    """Titles, labels and names that look like HTML stay text, in the page and in its data."""
    nasty = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"
    case = make_case(
        spans=3,
        title=nasty,
        description=nasty,
        sources=[{"path": "wires", "source": nasty, "confidence": "choice"}],
    )
    run = dataclasses.replace(make_run(case), warnings=(nasty,))
    path = write_report([run, run], tmp_path / "report.html", labels=[nasty, "b"], title=nasty)
    text = path.read_text(encoding="utf-8")
    assert "<script>alert" not in text
    assert "<img src=x" not in text
    assert "&lt;/script&gt;" in text
    assert len(_Page(text).ids("section")) == len(SECTIONS)


def test_policy_allows_the_scripts_of_the_page_alone(tmp_path: Path) -> None:
    """Every script that runs has its SHA-256 in the policy; nothing else may run (CSP Level 3)."""
    text = write_report([make_run(make_case(spans=3))], tmp_path / "r.html").read_text("utf-8")
    policy = re.search(r"script-src ([^;]*);", text)
    scripts = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    hashes = [base64.b64encode(sha256(script.encode()).digest()).decode() for script in scripts]
    assert policy is not None
    assert policy.group(1).split() == [f"'sha256-{value}'" for value in hashes]
    assert len(hashes) == 3
    assert not re.search(r"\son[a-z]+=", text.split("<body>")[1].split("<script>")[0])


def test_partial_run_says_so(tmp_path: Path) -> None:
    """A partial run is reported with its message and with what it did not cover."""
    run = make_run(make_case(spans=8), status="partial", duration=2.5)
    text = _page(run, tmp_path).text
    assert "The run is partial; what was computed up to then is valid." in text
    assert run.message in text
    assert "covered only" in text


@pytest.mark.parametrize("duration", [0.0, 0.001, 0.03])
def test_run_without_activity_is_reported(tmp_path: Path, duration: float) -> None:
    """A run interrupted at once gives a page with all sections and dashes for numbers."""
    run = make_run(make_case(spans=3), status="partial", duration=duration)
    page = _page(run, tmp_path)
    assert page.ids("section") == SECTIONS
    if duration == 0.0:
        assert "pantograph front was never in the analysed section" in page.text
        assert "NaN" not in page.text


def test_pantograph_that_never_enters(tmp_path: Path) -> None:
    """A following pantograph that has not entered yet leaves gaps, not errors."""
    run = make_run(make_case(spans=8, pantographs=2), status="partial", duration=1.0)
    page = _page(run, tmp_path)
    assert "pantograph rear was never in the analysed section" in page.text
    [film] = json.loads(page.data["film-data"])
    assert [p["name"] for p in film["pantographs"]] == ["front"]


def test_values_that_are_not_finite_are_cut_off(tmp_path: Path) -> None:
    """A failed run that ends in NaN is reported up to the last finite sample, and says so."""
    run = make_run(make_case(spans=8), status="failed")
    record = run.pantographs[0]
    force = record.contact_force.copy()
    force[4000:] = np.nan
    broken = dataclasses.replace(record, contact_force=force)
    page = _page(dataclasses.replace(run, pantographs=(broken,)), tmp_path)
    assert "The run failed; its numbers must not be used." in page.text
    assert "Values are not finite from t = 4.000 s on" in page.text
    assert re.search(r"mean of \d+\.\d N", page.text)
    assert not any(re.search(r"\bNaN\b", data) for data in page.data.values())


def test_elasticity_may_be_missing(tmp_path: Path) -> None:
    """Without an elasticity the section says how to get it."""
    text = _page(make_run(make_case(spans=3)), tmp_path).text
    assert "The elasticity was not computed with this run" in text


def test_published_results_are_compared(tmp_path: Path) -> None:
    """A reference line stands beside its published results, with their confidence."""
    case = make_case(name="ac-simple")
    text = _page(make_run(case), tmp_path, make_elasticity(case)).text
    assert "Published results" in text
    assert "World benchmark (2015) AC simple" in text
    assert "support 0.2060 mm/N 0.2060 mm/N +0.0 %" in text


def test_nothing_to_report_is_refused(tmp_path: Path) -> None:
    """No run, too many elasticities and missing labels are refused, and nothing is written."""
    run = make_run(make_case(spans=2), duration=0.05)
    data = make_elasticity(run.case)
    with pytest.raises(InputError, match="at least one run"):
        write_report([], tmp_path / "a.html")
    with pytest.raises(InputError, match="2 elasticities"):
        write_report(run, tmp_path / "a.html", [data, data])
    with pytest.raises(InputError, match="1 labels were given for 2 runs"):
        write_report([run, run], tmp_path / "a.html", labels=["one"])
    with pytest.raises(InputError, match="does not exist"):
        write_report(run, tmp_path / "nowhere" / "a.html")
    assert not list(tmp_path.iterdir())


def test_addresses_are_emptied() -> None:
    """Addresses in strings of a script go; XML names and comments stay; scripts cannot end it."""
    script = (
        'a="https://maps.example/x";b="http://www.w3.org/2000/svg";// https://licence\n"</script>"'
    )
    assert without_addresses(script) == (
        'a="offline:maps.example/x";b="http://www.w3.org/2000/svg";// https://licence\n"<\\/script>"'
    )
