"""``rank``: corrections of a line as built, in the order of what they gain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from tautwire.analyses.survey.corrections import LEAST
from tautwire.analyses.survey.rank import Ranking, rank
from tautwire.analyses.threads import core_count
from tautwire.cli.commands.measuring.measured import quantity
from tautwire.cli.commands.study import MOST_WORKERS
from tautwire.cli.folders import Files, prepared_folder, tell_files
from tautwire.cli.interrupts import Interrupts
from tautwire.cli.json_text import to_json
from tautwire.cli.session import Answer, Interrupted
from tautwire.cli.views.tables import heading, table
from tautwire.errors import InputError
from tautwire.files import write_text
from tautwire.inputs.load import load_case
from tautwire.report.parts.recordings.rank import (
    FIGURE_HEAD,
    RANK_HEAD,
    SHOWN,
    corrections_csv,
    figure_rows,
    rank_rows,
)
from tautwire.version import __version__

PASSAGES = "passages"
"""Folder in which passages are kept."""


@dataclass(frozen=True)
class RankRequest:
    """What the user asked for, quantities as texts.

    Attributes
    ----------
    design, built : str
        Names or files of the two cases.
    overrides : sequence of str
        For the case as built.
    least : str or None
    workers : int or None
        Processes; one per core by default.
    """

    design: str
    built: str
    overrides: Sequence[str] = ()
    least: str | None = None
    workers: int | None = None


def show_ranking(answer: Answer, request: RankRequest, out: Path | None) -> None:
    """Rank corrections, show them, and write the files that are asked for."""
    least = quantity("--least", request.least, "m", 0.0, 1.0)
    design, built = load_case(request.design), load_case(request.built, request.overrides)

    def watch(done: int, count: int) -> None:
        if done == 0:
            answer.say(f"deviations in {count} spans; spans that are kept are not computed again")
        elif done % max(count // 10, 1) == 0:
            answer.say(f"{done} of {count} spans done")

    keep = None
    if out is not None:
        with prepared_folder(out):
            keep = out / PASSAGES
    try:
        with Interrupts().handled():
            ranking = rank(
                design,
                built,
                least=LEAST if least is None else least,
                workers=_workers(request.workers),
                keep=keep,
                watch=watch,
            )
    except Interrupted as stop:
        if keep is not None:
            stop.kept = f"what is finished is kept in {keep}; the same command goes on from there"
        raise
    answer.document.update({"version": __version__, **_document(ranking)})
    rate = (
        f"{ranking.passages} passages over some spans each, on {ranking.length:.0f} m; "
        f"{ranking.cpu:.1f} s of CPU"
    )
    answer.show(
        heading("Corrections", rate),
        table(RANK_HEAD, "rLrrrrrrrr", rank_rows(ranking)[:SHOWN]),
        heading("What the first gain together"),
        table(FIGURE_HEAD, "Lrrrr", figure_rows(ranking)),
    )
    if out is not None:
        files = Files(out)
        _write(files, answer, ranking)
        tell_files(answer, files)


def _workers(given: int | None) -> int:
    count = core_count() if given is None else given
    if not 1 <= count <= MOST_WORKERS:
        raise InputError(f"--workers: got {count}; give 1 to {MOST_WORKERS}")
    return count


def _document(ranking: Ranking) -> dict[str, object]:
    return {
        "case": ranking.case.name,
        "passages": ranking.passages,
        "length": ranking.length,
        "cpu_s": ranking.cpu,
        "built": asdict(ranking.built),
        "checked": asdict(ranking.checked),
        "corrections": [asdict(one) for one in ranking.ranked],
    }


def _write(files: Files, answer: Answer, ranking: Ranking) -> None:
    from tautwire.report.pages.rank_page import write_rank_page

    text = to_json(answer.document) + "\n"
    files.write("corrections.html", lambda path: write_rank_page(ranking, path))
    files.write("corrections.json", lambda path: write_text(path, text))
    files.write("corrections.csv", lambda path: write_text(path, corrections_csv(ranking)))
