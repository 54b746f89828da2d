"""Figures that mesh and time step do not carry are marked wherever they are shown."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from tautwire.analyses.force.statistics import contact_statistics
from tautwire.analyses.road.pipeline import run_case
from tautwire.assessment.checks import Criteria
from tautwire.cli.views.loss_view import loss_cells, loss_view
from tautwire.cli.views.run_view import run_view
from tautwire.inputs.load import load_case
from tautwire.model.preflight import preflight
from tautwire.report.pages.run_page import write_report
from tautwire.report.pages.study_page import write_study_report
from tautwire.report.parts.tables import force_history_csv
from tautwire.results.run import Run
from tautwire.results.statistics import ContactLoss
from tautwire.results.storage import load_run, save_run
from tautwire.specs.study import Study
from tautwire.studies.execution.task import Job, perform
from tautwire.studies.plan import plan_study
from tautwire.studies.store import Store
from tautwire.studies.table import collect


def rendered(parts: list[Any]) -> str:
    """Return what a view shows, spaces alike."""
    console = Console(width=200, record=True, file=None)
    with console.capture() as captured:
        for part in parts:
            console.print(part)
    return captured.get().replace("\N{NO-BREAK SPACE}", " ")


@pytest.fixture(scope="module")
def coarse_run() -> Run:
    """Return a passage on four nodes between droppers, which carry 11 Hz, with losses."""
    changes = {
        "line.spans": 4,
        "settings.section": [2, 3],
        "settings.nodes_between_droppers": 4,
        "settings.contact_stiffness": 3e5,
        "scenario.uplift_force": 180.0,
    }
    return run_case(load_case("ac-simple", changes))


def test_figures_beyond_the_band_are_marked(coarse_run: Run, tmp_path: Path) -> None:
    """Wherever a loss count or a wide band is shown, its mark stands beside it.

    The mesh carries 11 Hz: bands up to 5 Hz are not marked, those up to 20 Hz and more are.
    """
    statistics = contact_statistics(coarse_run)
    entry = statistics.pantograph()
    assert entry.contact_loss.count > 0
    assert not entry.contact_loss.is_carried
    data = statistics.as_dict()["pantographs"][0]
    assert data["contact_loss"]["is_carried"] is False
    assert "std_0_200_n" in data["sharp"]["not_carried"]
    assert "std_0_5_n" not in data["sharp"]["not_carried"]
    assert any(note.startswith("‡: mesh and time step carry 11 Hz") for note in statistics.notes)
    count = f"{entry.contact_loss.count} ‡"
    deviation = f"{entry.sharp.standard_deviations['0_200']:.2f} ‡"
    page = write_report(coarse_run, tmp_path / "report.html").read_text("utf-8")
    checks = Criteria().checks(statistics, coarse_run.case)
    for text in (rendered(run_view(coarse_run, statistics, checks)), page.replace("\xa0", " ")):
        assert count in text
        assert deviation in text
    assert f"contact loss: {count} events" in str(statistics).replace("\xa0", " ")
    assert count in rendered(loss_view(entry.contact_loss))
    head, first, *_ = force_history_csv(coarse_run).splitlines()
    assert head.endswith(",mesh and step carry [Hz]")
    assert first.endswith(",11")


def test_nothing_is_marked_on_a_mesh_for_the_band() -> None:
    """A mesh and a step for 200 Hz carry losses and every band."""
    changes = {"line.spans": 3, "settings.section": [2, 2], "scenario.uplift_force": 150.0}
    statistics = contact_statistics(run_case(load_case("ac-simple", changes)))
    assert statistics.pantograph().contact_loss.is_carried
    assert statistics.pantograph().sharp.as_dict()["not_carried"] == []
    assert "‡" not in str(statistics)


@pytest.mark.slow
def test_study_tables_carry_the_mark(tmp_path: Path) -> None:
    """A case on a coarse mesh has its marked columns beside the figures, in CSV and page."""
    content = {
        "schema": 1, "name": "meshes", "base": "ac-simple",
        "overrides": {"line.spans": 3, "settings.section": [2, 2], "scenario.uplift_force": 150},
        "axes": {"settings.nodes_between_droppers": [3, 24]},
    }  # fmt: skip
    plan = plan_study(Study.model_validate(content))
    store = Store(tmp_path)
    for point in plan.points:
        store.save(point.key, perform(Job(point.key, plan.case(point).to_dict())).row)
    table = collect(plan, store)
    assert [table.carries((at,), "std_0_200") for at in (0, 1)] == [False, True]
    assert [table.carries((at,), "losses") for at in (0, 1)] == [False, True]
    assert "std_0_200" in table.to_csv().splitlines()[1]
    page = write_study_report(table, tmp_path / "report.html").read_text("utf-8")
    assert page.count("‡") >= 3


def test_advice_is_kept_in_the_run(coarse_run: Run, tmp_path: Path) -> None:
    """What the check says before the work stands in the run, in its file and in the report."""
    wanted = [str(item) for item in preflight(coarse_run.case)]
    assert any(text.startswith("mesh: elements of up to 1.92 m") for text in wanted)
    save_run(coarse_run, tmp_path / "run.nc")
    assert set(wanted) <= set(load_run(tmp_path / "run.nc").warnings)
    page = write_report(coarse_run, tmp_path / "report.html").read_text("utf-8")
    assert "elements of up to 1.92 m" in page


def test_losses_of_a_section_never_reached() -> None:
    """A pantograph that never was in the section has no count of losses, not a count of 0."""
    never = ContactLoss("rear", 0.0, ())
    text = rendered(loss_view(never))
    assert "rear was never in the section" in text
    assert loss_cells([never], lambda loss: str(loss.count)) == ["–"]
