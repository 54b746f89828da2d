"""``report``: one page about stored runs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from tautwire.assessment.checks import Criteria
from tautwire.cli.session import Answer
from tautwire.errors import InputError
from tautwire.inputs.attached import load_project
from tautwire.results.run import Run
from tautwire.results.storage import load_elasticity, load_run
from tautwire.version import __version__


def report_runs(
    answer: Answer,
    paths: Sequence[Path],
    out: Path,
    criteria: Criteria,
    project: Path | None = None,
    *,
    pdf: bool = False,
) -> None:
    """Write the report of one run, or of several overlaid, with the project block of a file."""
    from tautwire.report.pages.run_page import compose_report
    from tautwire.report.writers.page import PDF

    wanted = list(dict.fromkeys([out, out.with_suffix(PDF)] if pdf else [out]))
    for path in wanted:
        refuse_unwritable(path)
    if any(path.suffix.lower() == PDF for path in wanted):
        from tautwire.report.writers.pdf import require_pdf

        require_pdf()
    block = None if project is None else load_project(project)
    runs = load_runs(paths)
    page = compose_report(
        runs,
        [load_elasticity(path) for path in paths],
        criteria=criteria,
        project=block,
    )
    written = [str(page.write(path)) for path in wanted]
    answer.document.update(
        {
            "version": __version__,
            "file": written[0],
            "files": written,
            "runs": [
                {
                    "file": str(path),
                    "case": run.case.name,
                    "status": run.status,
                    "speed_kmh": round(3.6 * run.case.scenario.speed, 9),
                }
                for path, run in zip(paths, runs, strict=True)
            ],
        }
    )
    answer.show(*(f"{name} written" for name in written))


def load_runs(paths: Sequence[Path]) -> list[Run]:
    """Load stored runs.

    Raises
    ------
    InputError
        With every file that cannot be used.
    """
    problems: list[str] = []
    runs: list[Run] = []
    for path in paths:
        try:
            runs.append(load_run(path))
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    return runs


def refuse_unwritable(path: Path) -> None:
    """Refuse a file name before the work that it is for."""
    if path.is_dir():
        raise InputError(f"--out {path}: is a folder; give the name of a file")
    if not path.parent.is_dir():
        raise InputError(
            f"--out {path}: the folder {path.parent} does not exist; make it or choose another name"
        )
