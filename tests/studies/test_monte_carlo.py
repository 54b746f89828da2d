"""Monte Carlo over irregular lines, shortened: the example's study on a small line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from tautwire.report.figures.study_figures import usual_figures
from tautwire.report.pages.study_page import write_study_report
from tautwire.specs.study import Study
from tautwire.studies.execution.executor import LocalWorkers
from tautwire.studies.plan import plan_study
from tautwire.studies.run import Options, run_study
from tautwire.studies.study_file import load_study, make_study

from .conftest import SMALL

EXAMPLE = Path(__file__).parents[2] / "examples" / "studies" / "irregular-seeds.yaml"
CASES = 24
FIRST = 6


def shortened() -> Study:
    """Return the example with fewer seeds, on a small line."""
    content = yaml.safe_load(EXAMPLE.read_text(encoding="utf-8"))
    content["overrides"] |= SMALL
    content["axes"] = {"settings.seed": {"seeds": CASES}}
    return make_study(content)


def test_example_holds_200_lines() -> None:
    """The study file asks for 200 seeds of NAD 9, each another valid case."""
    plan = plan_study(load_study(EXAMPLE))
    assert len(plan.points) == len(plan.by_key) == 200
    assert not any(point.problems for point in plan.points)
    case = plan.case(plan.points[7])
    assert case.settings.nodes_between_droppers == 9
    assert case.line.spans == 17


@pytest.mark.slow
def test_every_seed_is_a_line_of_its_own(tmp_path: Path) -> None:
    """All cases are done, no two alike, memory stays flat, and a box plot shows the spread."""
    study = shortened()
    first = run_study(
        study,
        tmp_path,
        executor=LocalWorkers(1, tmp_path),
        watch=lambda progress: progress.computed >= FIRST,
    )
    assert first.counts()["done"] == FIRST
    table = run_study(
        study, tmp_path, executor=LocalWorkers(2, tmp_path), options=Options(resume=True)
    )
    assert table.counts() == {"done": CASES, "failed": 0, "refused": 0, "missing": 0}
    largest = table["maximum"].values.reshape(CASES, -1)[:, 0]
    assert len(np.unique(largest)) == CASES
    assert np.all(np.isfinite(largest))
    memory = table["peak_memory_mb"].values[FIRST:]
    assert memory.max() < 1.1 * memory[:6].max()
    assert [name for name, _, _ in usual_figures(table)] == ["spread-seed"]
    write_study_report(table, tmp_path / "study.html")
    assert "over the repetitions" in (tmp_path / "study.html").read_text(encoding="utf-8")
