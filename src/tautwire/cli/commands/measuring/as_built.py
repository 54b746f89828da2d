"""``as-built``: a survey and a design become a line as built."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tautwire.analyses.survey.as_built import SCATTER, SUPPORT_SCATTER, AsBuilt, as_built
from tautwire.cli.commands.measuring.measured import quantity
from tautwire.cli.folders import Files, prepared_folder, tell_files
from tautwire.cli.json_text import to_json
from tautwire.cli.session import Answer
from tautwire.cli.views.tables import facts, heading, table
from tautwire.files import write_text
from tautwire.inputs.load import load_case
from tautwire.inputs.reading.survey import ACCURACY, load_survey
from tautwire.report.parts.recordings.as_built import (
    DROPPER_HEAD,
    SUPPORT_HEAD,
    dropper_rows,
    droppers_csv,
    finding_lines,
    heights_csv,
    summary_rows,
    support_rows,
)
from tautwire.specs.case import Case
from tautwire.version import __version__


@dataclass(frozen=True)
class SurveyRequest:
    """A survey as the user gives it, quantities as texts.

    Attributes
    ----------
    case : str
    survey : Path
    overrides : sequence of str
    accuracy, scatter, support_scatter : str or None
    """

    case: str
    survey: Path
    overrides: Sequence[str] = ()
    accuracy: str | None = None
    scatter: str | None = None
    support_scatter: str | None = None

    def estimated(self) -> AsBuilt:
        """Read the files and estimate the line."""
        given = {
            name: quantity(f"--{name.replace('_', '-')}", getattr(self, name), "m", 1e-5, 1.0)
            for name in ("accuracy", "scatter", "support_scatter")
        }
        case = load_case(self.case, self.overrides)
        survey = load_survey(self.survey, case, accuracy=given["accuracy"] or ACCURACY)
        return as_built(
            case,
            survey,
            scatter=given["scatter"] or SCATTER,
            support_scatter=given["support_scatter"] or SUPPORT_SCATTER,
        )


def show_as_built(answer: Answer, request: SurveyRequest, out: Path | None) -> None:
    """Estimate a line as built, show it, and write the files that are asked for."""
    built = request.estimated()
    for note in built.survey.notes:
        answer.say(note)
    answer.warn(finding_lines(built))
    answer.document.update({"version": __version__, **built.as_dict()})
    answer.show(
        heading("As built", built.case.name),
        facts(summary_rows(built)),
        heading("Droppers", "unstrained lengths; slack ones are at least as long"),
        table(DROPPER_HEAD, "rrrrrrrrl", dropper_rows(built)),
        heading("Supports"),
        table(SUPPORT_HEAD, "r" * len(SUPPORT_HEAD), support_rows(built)),
    )
    if out is not None:
        with prepared_folder(out):
            files = Files(out)
            _write(files, answer, built)
        tell_files(answer, files)


def _write(files: Files, answer: Answer, built: AsBuilt) -> None:
    from tautwire.report.pages.as_built_page import write_as_built_page

    files.write("as-built.yaml", lambda path: write_text(path, case_text(built.case)))
    files.write("as-built.html", lambda path: write_as_built_page(built, path))
    files.write("as-built.json", lambda path: write_text(path, to_json(answer.document) + "\n"))
    files.write("droppers.csv", lambda path: write_text(path, droppers_csv(built)))
    files.write("heights.csv", lambda path: write_text(path, heights_csv(built)))


def case_text(case: Case) -> str:
    """Return a case as the text of a file, every value in SI units."""
    import yaml

    data = {key: value for key, value in case.to_dict().items() if value is not None}
    return yaml.safe_dump(data, sort_keys=False, allow_unicode=True)
