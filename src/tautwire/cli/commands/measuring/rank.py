"""``rank``: corrections of a line as built, in the order of what they gain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from tautwire.analyses.survey.rank import LEAST, Ranking, rank
from tautwire.cli.commands.measuring.measured import quantity
from tautwire.cli.folders import Files, prepared_folder, tell_files
from tautwire.cli.json_text import to_json
from tautwire.cli.session import Answer
from tautwire.cli.views.tables import heading, table
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
    """

    design: str
    built: str
    overrides: Sequence[str] = ()
    least: str | None = None


def show_ranking(answer: Answer, request: RankRequest, out: Path | None) -> None:
    """Rank corrections, show them, and write the files that are asked for."""
    least = quantity("--least", request.least, "m", 0.0, 1.0)
    design, built = load_case(request.design), load_case(request.built, request.overrides)

    def watch(number: int, count: int) -> None:
        if number == 0:
            answer.say(f"{count} passages; those that are kept already are not computed again")

    keep = None
    if out is not None:
        with prepared_folder(out):
            keep = out / PASSAGES
    ranking = rank(design, built, least=LEAST if least is None else least, keep=keep, watch=watch)
    answer.document.update({"version": __version__, **_document(ranking)})
    rate = f"{ranking.passages} passages over {ranking.length:.0f} m, {ranking.cpu:.1f} s of CPU"
    answer.show(
        heading("Corrections", rate),
        table(RANK_HEAD, "rLrrrrrrr", rank_rows(ranking)[:SHOWN]),
        heading("What the first gain together"),
        table(FIGURE_HEAD, "Lrrrr", figure_rows(ranking)),
    )
    if out is not None:
        files = Files(out)
        _write(files, answer, ranking)
        tell_files(answer, files)


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
