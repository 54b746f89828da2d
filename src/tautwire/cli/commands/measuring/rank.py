"""``rank``: corrections of a line as built, in the order of what they change."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from tautwire.analyses.survey.corrections import LEAST
from tautwire.analyses.survey.rank import TOGETHER, Ranking, rank_lines
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
    FIGURE_NARROW,
    RANK_HEAD,
    RISES,
    SHOWN,
    corrections_csv,
    figure_rows,
    line_names,
    listed,
    rank_rows,
    worse_lines,
)
from tautwire.specs.case import Case
from tautwire.version import __version__

MOST_FIRST = 1000
"""Most corrections that are made together: each is computed after all before it."""

PASSAGES = "passages"
"""Folder in which passages are kept."""


@dataclass(frozen=True)
class RankRequest:
    """What the user asked for, quantities as texts.

    Attributes
    ----------
    cases : sequence of str
        Names or files: design and line as built of one tension length after the other.
    overrides : sequence of str
        For the cases as built.
    least : str or None
    first : int or None
        Corrections for the crew, ten by default.
    workers : int or None
        Processes; one per core by default.
    """

    cases: Sequence[str]
    overrides: Sequence[str] = ()
    least: str | None = None
    first: int | None = None
    workers: int | None = None

    def lines(self) -> list[tuple[Case, Case]]:
        """Read the cases, in pairs of design and line as built."""
        if len(self.cases) % 2:
            raise InputError(
                f"rank: got {len(self.cases)} cases; give the design and the line as built of "
                "every tension length, as in: tautwire rank line-1.yaml built-1.yaml line-2.yaml "
                "built-2.yaml"
            )
        designs, builts = self.cases[::2], self.cases[1::2]
        return [
            (load_case(design), load_case(built, self.overrides))
            for design, built in zip(designs, builts, strict=True)
        ]


def show_ranking(answer: Answer, request: RankRequest, out: Path | None) -> None:
    """Rank corrections, show them, and write the files that are asked for."""
    least = quantity("--least", request.least, "m", 0.0, 1.0)
    first = TOGETHER if request.first is None else request.first
    if not 1 <= first <= MOST_FIRST:
        raise InputError(f"--first: got {first}; give 1 to {MOST_FIRST}")
    lines, interrupts, keep = request.lines(), Interrupts(), None
    if out is not None:
        with prepared_folder(out):
            keep = out / PASSAGES
    try:
        with interrupts.handled():
            rankings = rank_lines(
                lines,
                least=LEAST if least is None else least,
                first=first,
                workers=_workers(request.workers),
                keep=keep,
                watch=_watcher(answer, interrupts),
            )
    except Interrupted as stop:
        if keep is not None:
            stop.kept = f"what is finished is kept in {keep}; the same command goes on from there"
        raise
    answer.document.update({"version": __version__, **_document(rankings)})
    answer.warn(worse_lines(rankings))
    passages, length, cpu = (
        sum(getattr(one, name) for one in rankings) for name in ("passages", "length", "cpu")
    )
    rate = f"{passages} passages over some spans each, on {length:.0f} m; {cpu:.1f} s of CPU; "
    rate += f"{RISES}: by itself it raises σ"
    answer.show(
        heading("Corrections", rate),
        table(RANK_HEAD, "rLrrrrrrrr", rank_rows(rankings)[:SHOWN]),
        heading("What the first change together"),
        table(FIGURE_NARROW, "Lrrrrrrrrrr", figure_rows(rankings)),
    )
    if out is not None:
        files = Files(out)
        _write(files, answer, rankings)
        tell_files(answer, files)


def _watcher(answer: Answer, interrupts: Interrupts) -> Callable[[int, int], None]:
    """Return what tells how far the spans are, and stops where a signal got lost in a library."""

    def watch(done: int, count: int) -> None:
        if interrupts.requested is not None:
            raise Interrupted(interrupts.requested)
        if done == 0:
            answer.say(f"deviations in {count} spans; spans that are kept are not computed again")
        elif done % max(count // 10, 1) == 0:
            answer.say(f"{done} of {count} spans done")

    return watch


def _workers(given: int | None) -> int:
    count = core_count() if given is None else given
    if not 1 <= count <= MOST_WORKERS:
        raise InputError(f"--workers: got {count}; give 1 to {MOST_WORKERS}")
    return count


def _document(rankings: Sequence[Ranking]) -> dict[str, object]:
    lines = [
        {
            "name": name,
            "case": ranking.case.name,
            "passages": ranking.passages,
            "length": ranking.length,
            "cpu_s": ranking.cpu,
            "built": asdict(ranking.built),
            "made": ranking.made,
            "checked": asdict(ranking.checked),
        }
        for name, ranking in zip(line_names(rankings), rankings, strict=True)
    ]
    corrections = [{"line": number + 1, **asdict(one)} for number, one in listed(rankings)]
    return {"lines": lines, "corrections": corrections}


def _write(files: Files, answer: Answer, rankings: Sequence[Ranking]) -> None:
    from tautwire.report.pages.rank_page import write_rank_page

    text = to_json(answer.document) + "\n"
    files.write("corrections.html", lambda path: write_rank_page(rankings, path))
    files.write("corrections.json", lambda path: write_text(path, text))
    files.write("corrections.csv", lambda path: write_text(path, corrections_csv(rankings)))
