"""Commands for what measuring trains record."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tautwire.cli.options import (
    CaseArgument,
    JsonOption,
    LimitsOption,
    ProjectOption,
    SetOption,
)
from tautwire.cli.session import answering


def register(app: typer.Typer) -> None:
    """Add the commands to the program."""
    app.command()(measured)
    app.command()(compare)
    app.command("as-built")(as_built)
    app.command()(rank)


MappingOption = Annotated[
    Path | None,
    typer.Option(
        "--mapping",
        metavar="FILE",
        help="Which column is what; by default the file beside the recording, or another one of "
        "its folder for the same columns.",
        show_default=False,
    ),
]
SpeedOption = Annotated[
    str | None,
    typer.Option(
        "--speed",
        metavar="SPEED",
        help="Speed of the train where the file has neither time nor speed.",
        show_default=False,
    ),
]
FilteredOption = Annotated[
    bool, typer.Option("--filtered", help="The measured force is low-passed at 20 Hz already.")
]
MassOption = Annotated[
    list[str] | None,
    typer.Option(
        "--strip-mass",
        metavar="MASS",
        help="Mass above the sensors of a strip, the first, the second ...: its inertia is taken "
        'off, as in --strip-mass "2.9 kg" --strip-mass "2.9 kg".',
        show_default=False,
    ),
]
HighOption = Annotated[
    str | None,
    typer.Option(
        "--high",
        metavar="FORCE",
        help="Force above which an event is listed; mean plus three deviations by default.",
        show_default=False,
    ),
]
SearchOption = Annotated[
    str | None,
    typer.Option(
        "--search",
        metavar="LENGTH",
        help="Largest error of the recorded positions; nearly half of the shortest span by "
        "default, 0 m leaves them as they are.",
        show_default=False,
    ),
]
AirOption = Annotated[
    Path | None,
    typer.Option(
        "--air",
        metavar="FILE",
        help="Aerodynamic force on what is above the sensors, added over the speed: columns speed, "
        "force, and reversed for the other direction.",
        show_default=False,
    ),
]
ReversedOption = Annotated[
    bool,
    typer.Option("--reversed", help="The pantograph runs the other way round, for --air."),
]
PointsOption = Annotated[
    Path | None,
    typer.Option(
        "--points",
        metavar="FILE",
        help="Elasticity and uplift measured at supports, droppers or mid-span, CSV or XLSX.",
        show_default=False,
    ),
]
ElasticityForceOption = Annotated[
    str | None,
    typer.Option(
        "--elasticity-force",
        metavar="FORCE",
        help="Force under which elasticity was measured; that of the case by default.",
        show_default=False,
    ),
]


def measured(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE", help="CSV of any dialect, XLSX, MAT, netCDF, HDF5, Parquet or TDMS."
        ),
    ],
    mapping: MappingOption = None,
    speed: SpeedOption = None,
    strip_mass: MassOption = None,
    filtered: FilteredOption = False,
    air: AirOption = None,
    is_reversed: ReversedOption = False,
    stretch: Annotated[
        str, typer.Option("--every", metavar="LENGTH", help="Stretches of the statistics.")
    ] = "1 km",
    high: HighOption = None,
    hard: Annotated[
        str | None,
        typer.Option(
            "--hard",
            metavar="ACCELERATION",
            help="Acceleration of the head above which a hard spot is listed, as in '490 m/s2'; "
            "seven times what is usual in the run by default.",
            show_default=False,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", metavar="DIR",
            help="Folder for measured.html, measured.json, force.csv, stretches.csv.",
            show_default=False,
        ),
    ] = None,
    as_json: JsonOption = False,
) -> None:  # fmt: skip
    """Read a recording, find faults of its sensors, process the force and take its figures.

    What each column was read as is shown and kept in a small mapping file, which is used again for
    the next file with these columns.
    """
    with answering(as_json) as answer:
        from tautwire.cli.commands.measuring.measured import RecordingRequest, show_recording

        request = RecordingRequest(
            file,
            mapping,
            speed,
            tuple(strip_mass or ()),
            filtered,
            stretch,
            high,
            hard,
            air,
            is_reversed,
        )
        show_recording(answer, request, out)


def compare(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN.nc RECORDING",
            help="A result of \"tautwire run\" and a recording; several of either in turn.",
        ),
    ],
    pantograph: Annotated[
        list[str] | None,
        typer.Option(
            "--pantograph", metavar="NAME",
            help="The leading one by default; one for all recordings, or one for each.",
            show_default=False,
        ),
    ] = None,
    offset: Annotated[
        str,
        typer.Option(
            "--offset", metavar="LENGTH", help="Position in the model of the measurement's zero."
        ),
    ] = "0 m",
    search: SearchOption = None,
    mapping: MappingOption = None,
    speed: SpeedOption = None,
    strip_mass: MassOption = None,
    filtered: FilteredOption = False,
    air: AirOption = None,
    is_reversed: ReversedOption = False,
    limits: LimitsOption = None,
    points: PointsOption = None,
    elasticity_force: ElasticityForceOption = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", metavar="DIR",
            help="Folder for comparison.html, comparison.json and forces.csv.",
            show_default=False,
        ),
    ] = None,
    project: ProjectOption = None,
    as_json: JsonOption = False,
) -> None:  # fmt: skip
    """Compare runs with recordings, after EN 50318 and IEC 63453.

    One run is compared with every recording, one recording with every run, or both in pairs.
    """
    with answering(as_json) as answer:
        from tautwire.cli.commands.measuring.compare import ComparisonRequest, compare_runs
        from tautwire.cli.commands.measuring.measured import RecordingRequest

        masses = tuple(strip_mass or ())  # the path is that of each recording
        reading = RecordingRequest(
            Path(), mapping, speed, masses, filtered, air=air, is_reversed=is_reversed
        )
        asked = (tuple(pantograph or ()), offset, search, limits, points, elasticity_force, project)
        request = ComparisonRequest(tuple(files), reading, *asked)
        compare_runs(answer, request, out)


def as_built(
    case: CaseArgument,
    survey: Annotated[
        Path,
        typer.Argument(
            metavar="SURVEY", help="CSV or XLSX: heights, lengths, staggers by place."
        ),
    ],
    set_: SetOption = None,
    accuracy: Annotated[
        str | None,
        typer.Option(
            "--accuracy", metavar="LENGTH",
            help="Standard deviation of the readings, 3 mm by default; a column of their own wins.",
            show_default=False,
        ),
    ] = None,
    scatter: Annotated[
        str | None,
        typer.Option(
            "--scatter", metavar="LENGTH",
            help="Standard deviation of dropper lengths about the design, 5 mm by default.",
            show_default=False,
        ),
    ] = None,
    support_scatter: Annotated[
        str | None,
        typer.Option(
            "--support-scatter", metavar="LENGTH",
            help="The same of the heights at supports, 10 mm by default.",
            show_default=False,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", metavar="DIR",
            help="Folder for as-built.yaml (the case), page, JSON and tables.",
            show_default=False,
        ),
    ] = None,
    as_json: JsonOption = False,
) -> None:  # fmt: skip
    """Estimate the line as built from a survey: dropper lengths, heights, droppers misplaced."""
    with answering(as_json) as answer:
        from tautwire.cli.commands.measuring.as_built import SurveyRequest, show_as_built

        request = SurveyRequest(case, survey, set_ or [], accuracy, scatter, support_scatter)
        show_as_built(answer, request, out)


def rank(
    cases: Annotated[
        list[str],
        typer.Argument(
            metavar="CASE BUILT...",
            help="The design, and the line as built, as 'as-built' writes it; of several tension "
            "lengths one pair after the other.",
            show_default=False,
        ),
    ],
    set_: SetOption = None,
    least: Annotated[
        str | None,
        typer.Option(
            "--least", metavar="LENGTH", help="Least deviation that is looked at, 3 mm by default.",
            show_default=False,
        ),
    ] = None,
    first: Annotated[
        int | None,
        typer.Option(
            "--first", metavar="N",
            help="Corrections for the crew, 10 by default; what they change together is computed.",
            show_default=False,
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            "--workers", metavar="N", help="Processes; one per core by default.",
            show_default=False,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", metavar="DIR",
            help="Folder for corrections.html (for the crew), JSON, CSV, and the passages, from "
            "which a ranking that was stopped goes on.",
            show_default=False,
        ),
    ] = None,
    as_json: JsonOption = False,
) -> None:  # fmt: skip
    """Rank corrections of a line as built by what they do to the contact force.

    Several tension lengths make one list.
    """
    with answering(as_json) as answer:
        from tautwire.cli.commands.measuring.rank import RankRequest, show_ranking

        show_ranking(answer, RankRequest(cases, set_ or [], least, first, workers), out)
