"""``compare``: runs beside recordings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

from tautwire.analyses.force.section import analysed_section
from tautwire.analyses.force.statistics import passed_uplift
from tautwire.analyses.road.elasticity import elasticity
from tautwire.assessment.comparison.coverage import covered
from tautwire.assessment.comparison.geometry import GeometryRow, compare_geometry
from tautwire.assessment.comparison.measurement import (
    MeasurementComparison,
    compare_with_measurement,
    incompleteness,
)
from tautwire.assessment.comparison.points import PointComparison, compare_points, judged
from tautwire.assessment.limits import Limits, load_limits
from tautwire.cli.commands.measuring.measured import RecordingRequest, quantity
from tautwire.cli.commands.results import load_runs
from tautwire.cli.folders import Files, prepared_folder, tell_files
from tautwire.cli.idle import refuse_idle
from tautwire.cli.json_text import to_json
from tautwire.cli.session import Answer
from tautwire.cli.views.mapping_view import announce_recording
from tautwire.cli.views.tables import facts, heading, table
from tautwire.errors import InputError
from tautwire.files import write_text
from tautwire.inputs.attached import load_project
from tautwire.inputs.reading.recording import RecordingFile
from tautwire.inputs.reading.survey import load_survey
from tautwire.measured.evaluation import Treatment, evaluate
from tautwire.measured.files.formats import is_computed
from tautwire.model.build import build
from tautwire.report.parts.recordings.comparison import (
    HEADS,
    POINT_HEADS,
    number_row,
    outcome_of,
    percentile_rows,
    point_rows,
    verdict_of,
)
from tautwire.report.parts.words import readable
from tautwire.results.run import Run
from tautwire.specs.project import Project
from tautwire.text import csv_text
from tautwire.version import __version__

NO_OFFSET = "0 m"
FARTHEST = 1e7
"""Largest offset and search [m], that of the chainage of a line."""


@dataclass(frozen=True)
class ComparisonRequest:
    """What is to be compared, quantities as texts.

    Attributes
    ----------
    files : tuple of Path
        Runs and recordings.
    reading : RecordingRequest
        How the recordings are read.
    pantographs : tuple of str
    offset : str
    search : str or None
    limits : Path or None
    points : Path or None
        Elasticity and uplift at places.
    elasticity_force : str or None
        Under which elasticity was measured; that of the case by default.
    project : Path or None
        File with the project block.
    """

    files: tuple[Path, ...]
    reading: RecordingRequest
    pantographs: tuple[str, ...] = ()
    offset: str = NO_OFFSET
    search: str | None = None
    limits: Path | None = None
    points: Path | None = None
    elasticity_force: str | None = None
    project: Path | None = None

    def runs(self) -> list[Path]:
        """Return the runs among the files.

        Raises
        ------
        InputError
            When the first one is none.
        """
        runs = [path for path in self.files if is_computed(path)]
        if self.files[0] not in runs:
            _refuse_first(self.files[0], runs)
        return runs

    def pairs(self) -> list[tuple[Path, Path]]:
        """Return runs and recordings in pairs.

        Raises
        ------
        InputError
            When they make no pairs.
        """
        runs = self.runs()
        recordings = [path for path in self.files if path not in runs]
        if not recordings and self.points is not None:
            return []
        if not recordings:
            raise InputError(
                f"{runs[0]}: give a recording too, as in: tautwire compare run.nc recording.csv"
            )
        if len(runs) != len(recordings) and 1 not in (len(runs), len(recordings)):
            raise InputError(
                f"{len(runs)} runs and {len(recordings)} recordings make no pairs; give one of "
                "either, or as many of both"
            )
        count = max(len(runs), len(recordings))
        return [(runs[n % len(runs)], recordings[n % len(recordings)]) for n in range(count)]

    def pantograph_of(self, number: int, count: int) -> str | None:
        """Return the pantograph of a pair; None for the leading one."""
        if len(self.pantographs) not in (0, 1, count):
            raise InputError(
                f"--pantograph: got {len(self.pantographs)} names for {count} comparisons; give "
                "one, or one for each"
            )
        return self.pantographs[number % len(self.pantographs)] if self.pantographs else None


def _refuse_first(path: Path, runs: Sequence[Path]) -> NoReturn:
    """Refuse a first file that is no run.

    Raises
    ------
    InputError
        Naming a run that stands elsewhere, or else what is wrong with a file that should be one.
    """
    if runs:
        raise InputError(
            f"{path} is no run, but {runs[0]} is; give the run first, as in: tautwire compare "
            f"{runs[0]} {path}"
        )
    if path.suffix == ".nc" or not path.is_file():
        load_runs([path])
    raise InputError(
        f"{path} is no run; give the result file of one first, as in: tautwire compare run.nc "
        f"{path.name}"
    )


class _Options(NamedTuple):
    """What the options of a comparison say, in SI, read before any file is opened."""

    offset: float
    search: float | None
    elasticity_force: float | None
    treatment: Treatment
    limits: Limits | None
    project: Project | None

    @classmethod
    def of(cls, request: ComparisonRequest) -> _Options:
        return cls(
            quantity("--offset", request.offset, "m", -FARTHEST, FARTHEST) or 0.0,
            quantity("--search", request.search, "m", 0.0, FARTHEST),
            quantity("--elasticity-force", request.elasticity_force, "N", 1.0, 1e4),
            request.reading.treatment(),
            None if request.limits is None else load_limits(request.limits),
            None if request.project is None else load_project(request.project),
        )


_Recorded = list[tuple[Run, MeasurementComparison]]
_Pointed = list[tuple[Run, PointComparison]]


def compare_runs(answer: Answer, request: ComparisonRequest, out: Path | None) -> None:
    """Compare stored runs with what was measured, show the tables and write the files asked for."""
    _refuse_idle(request, out)
    options = _Options.of(request)
    _refuse_idle_of_recordings(request)
    pairs, paths = request.pairs(), request.runs()
    runs = dict(zip(paths, load_runs(paths), strict=True))
    answer.warn([f"{path}: {told}" for path, run in runs.items() for told in incompleteness(run)])
    found = _recorded(
        answer, request, [(path, runs[path], other) for path, other in pairs], options
    )
    points = _pointed(answer, request, runs, options)
    if out is not None:
        _write_files(answer, out, found, points, options.project)


def _refuse_idle(request: ComparisonRequest, out: Path | None) -> None:
    """Refuse options for points or files where there are none."""
    if request.points is None:
        refuse_idle(
            "--points FILE with elasticity", {"--elasticity-force": request.elasticity_force}
        )
    if out is None:
        needs = "--out DIR: it stands on the page that is written there"
        refuse_idle(needs, {"--project": request.project})


def _refuse_idle_of_recordings(request: ComparisonRequest) -> None:
    """Refuse options for a recording where there is none."""
    reading = request.reading
    if len(request.runs()) == len(request.files):
        given = {
            "--pantograph": request.pantographs, "--offset": request.offset != NO_OFFSET,
            "--search": request.search, "--mapping": reading.mapping, "--speed": reading.speed,
            "--strip-mass": reading.masses, "--filtered": reading.is_filtered,
            "--air": reading.air, "--reversed": reading.is_reversed,
        }  # fmt: skip
        refuse_idle("a recording beside the runs", given)


def _recorded(
    answer: Answer,
    request: ComparisonRequest,
    pairs: Sequence[tuple[Path, Run, Path]],
    options: _Options,
) -> _Recorded:
    """Compare runs with recordings and show what is found."""
    opened: dict[Path, RecordingFile] = {}
    found: _Recorded = []
    told: list[dict[str, Any]] = []
    for number, (run_file, run, path) in enumerate(pairs):
        if path not in opened:
            reading = replace(request.reading, path=path)
            opened[path] = reading.opened(run.case.scenario.speed)
            announce_recording(answer, opened[path])
        recording = opened[path].recording
        geometry = compare_geometry(run, recording, offset=options.offset)
        about = {"run": str(run_file), "case": run.case.name, "status": run.status}
        told.append({**about, "geometry": [row.as_dict() for row in geometry]})
        answer.warn([row.note for row in geometry if row.note])
        if not len(recording.forces):
            told[-1] |= {"measurement": recording.label, "notes": list(recording.notes)}
            told[-1]["evaluation"] = evaluate(recording, options.treatment).as_dict()
            answer.warn(recording.notes)
            answer.show(
                heading("Comparison with a measurement", f"{run_file} and {recording.label}"),
                *_geometry_view(geometry),
            )
            continue
        compared = compare_with_measurement(
            run,
            recording,
            pantograph=request.pantograph_of(number, len(pairs)),
            treatment=options.treatment,
            offset=options.offset,
            search=options.search,
            limits=options.limits,
        )
        found.append((run, compared))
        told[-1] |= compared.as_dict()
        answer.warn([*_unsaid(run, compared.notes), *_faults(compared)])
        answer.show(*_comparison_view(run_file, compared), *_geometry_view(geometry))
    if told and not found:
        given = {
            "--pantograph": request.pantographs, "--search": request.search,
            "--strip-mass": request.reading.masses, "--filtered": request.reading.is_filtered,
            "--air": request.reading.air,
        }  # fmt: skip
        refuse_idle("a contact force; no recording has one", given)
    answer.document.update({"version": __version__, "comparisons": told})
    if found:
        answer.document["covers"] = covered([compared.coverage for _, compared in found])
    return found


def _pointed(
    answer: Answer,
    request: ComparisonRequest,
    runs: Mapping[Path, Run],
    options: _Options,
) -> _Pointed:
    """Compare elasticity and uplift at places with every run, and show what is found."""
    found: _Pointed = []
    told: list[dict[str, Any]] = []
    for path, run in runs.items() if request.points is not None else ():
        assert request.points is not None
        survey = load_survey(request.points, run.case)
        curve = None
        if not survey.of("elasticity"):
            needs = f"elasticity to be compared; {request.points} has none"
            refuse_idle(needs, {"--elasticity-force": request.elasticity_force})
        else:
            curve = elasticity(build(run.case), run.equilibrium, force=options.elasticity_force)
        section = analysed_section(run, (1, run.case.line.spans))
        uplift = passed_uplift(run, section).uplift
        one = compare_points(run, survey, elasticity=curve, uplift=uplift, limits=options.limits)
        found.append((run, one))
        about = {"run": str(path), "case": run.case.name, "status": run.status}
        told.append({**about, **one.as_dict()})
        if curve is not None:
            told[-1]["elasticity_force_n"] = curve.force
        rows = [(*row, verdict_of(row_.numbers))
                for row, row_ in zip(point_rows(one), one.rows, strict=True)]  # fmt: skip
        answer.warn(_unsaid(run, one.notes))
        answer.show(
            heading("Elasticity and uplift at places", f"{path} and {survey.label}"),
            table(POINT_HEADS, "lLrrrLL", rows),
            judged(one.rows),
        )
    if told:
        answer.document["points"] = told
    return found


def _unsaid(run: Run, notes: Sequence[str]) -> list[str]:
    """Return notes without what is told of every run that is not complete."""
    return [note for note in notes if note not in incompleteness(run)]


def _faults(compared: MeasurementComparison) -> list[str]:
    return [
        f"{fault['kind']}, {fault['channel']}: {fault['text']}"
        for fault in compared.evaluation.faults
    ]


def _geometry_view(rows: Sequence[GeometryRow]) -> list[Any]:
    """Return the table of heights and staggers; nothing where none was measured."""
    if not rows:
        return []
    cells = [
        (row.quantity, readable(row.mean, "m"), readable(row.standard_deviation, "m"),
         readable(row.largest, "m"), f"{row.place:.1f} m")
        for row in rows
    ]  # fmt: skip
    return [
        heading("Contact wire at rest, simulated minus measured"),
        table(("", "mean", "deviation", "largest", "at"), "lrrrr", cells),
    ]


def _write_files(
    answer: Answer, out: Path, found: _Recorded, points: _Pointed, project: Project | None
) -> None:
    from tautwire.report.pages.comparison_page import compose_comparison

    with prepared_folder(out):
        files = Files(out)
        if found or points:
            runs, compared = [run for run, _ in found], [one for _, one in found]
            page = compose_comparison(runs, compared, project, points)
            files.write("comparison.html", page.write)
        text = to_json(answer.document) + "\n"
        files.write("comparison.json", lambda path: write_text(path, text))
        for number, (_, one) in enumerate(found, 1):
            content = overlay_csv(one)
            name = "forces.csv" if number == 1 else f"forces-{number}.csv"
            files.write(name, lambda path, content=content: write_text(path, content))
    tell_files(answer, files)


def overlay_csv(compared: MeasurementComparison) -> str:
    """Return both forces over the position as CSV; empty cells were not measured."""
    head = ("position [m]", "simulated force [N]", "measured force [N]")
    rows = zip(
        compared.position.tolist(),
        compared.simulated_force.tolist(),
        compared.measured_force.tolist(),
        strict=True,
    )
    return csv_text(
        head, ((f"{x:.4f}", f"{a:.4f}", f"{b:.4f}" if isfinite(b) else "") for x, a, b in rows)
    )


def _comparison_view(run_file: Path, compared: MeasurementComparison) -> list[Any]:
    rows = [(*number_row(row), verdict_of(row)) for row in compared.rows]
    return [
        heading("Comparison with a measurement", f"{run_file} and {compared.label}"),
        facts(
            [
                ("pantograph", compared.pantograph),
                ("part of the line", f"{compared.start:.1f} to {compared.end:.1f} m"),
                ("position", compared.placement.text),
                ("filter", compared.filter),
                ("tolerances", outcome_of(compared)),
            ]
        ),
        heading("Numbers"),
        table(HEADS, "lrrrLL", rows),
        heading("Force below which a share of the way lies"),
        table(("", "simulated", "measured", "difference"), "Lrrr", percentile_rows(compared)),
    ]
