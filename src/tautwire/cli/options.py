"""Arguments and options that several commands share."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from tautwire.cli.idle import refuse_rivals
from tautwire.text import DESIGN


def _cases_that_begin(incomplete: str) -> list[str]:
    """Return library cases for the completion of the shell, which adds files by itself."""
    from tautwire.catalogue.entries import list_entries

    entries = list_entries()
    return [e.name for e in entries if e.kind == "case" and e.name.startswith(incomplete)]


CaseArgument = Annotated[
    str,
    typer.Argument(
        autocompletion=_cases_that_begin,
        metavar="CASE",
        help="Name of a library case, or a case file (YAML, TOML or JSON).",
        show_default=False,
    ),
]
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        help='Replace one value, as in --set scenario.speed="275 km/h"; may be repeated.',
        show_default=False,
    ),
]
ConditionOption = Annotated[
    str | None,
    typer.Option(
        "--condition",
        metavar="NAME",
        help='Condition of the case in which the line is examined; "design" for none.',
        show_default=False,
    ),
]
JsonOption = Annotated[
    bool,
    typer.Option("--json", help="Print one JSON document on standard output and nothing else."),
]
ErrorOption = Annotated[
    str | None,
    typer.Option(
        "--error",
        metavar="KIND",
        help="Numerical error of every figure, from mesh and step: none, estimate or bound; "
        "by default that of the case (settings.error).",
        show_default=False,
    ),
]
AccurateOption = Annotated[
    bool,
    typer.Option(
        "--accurate",
        help="Extrapolate from half and quarter time steps (settings.integrator=extrapolated): a "
        "hundredth of the error that the step leaves in the force over time, at five times the "
        "cost.",
    ),
]
OutFolderOption = Annotated[
    Path | None,
    typer.Option(
        "--out", "-o", metavar="DIR", help="Folder for the files; made if there is none.",
        show_default=False,
    ),
]  # fmt: skip
ForceOption = Annotated[
    bool, typer.Option("--force", help="Replace the files of another result in the folder.")
]
SystemOption = Annotated[
    str,
    typer.Option(
        "--system",
        metavar="SYSTEM",
        help="Supply system, which decides between limits: ac, dc-1.5kv or dc-3kv.",
    ),
]
LimitsOption = Annotated[
    Path | None,
    typer.Option(
        "--limits",
        metavar="FILE",
        help='Own limits, a file begun with "tautwire limits --copy"; in place of those that the '
        "case names.",
        show_default=False,
    ),
]
ProjectOption = Annotated[
    Path | None,
    typer.Option(
        "--project",
        metavar="FILE",
        help="Project block of the pages: client, revision, author, checked, logo; in place of "
        "that of the case.",
        show_default=False,
    ),
]
PdfOption = Annotated[
    bool,
    typer.Option("--pdf", help='Write the report as PDF too; needs the extra "pdf".'),
]
FreeUpliftOption = Annotated[
    str | None,
    typer.Option(
        "--free-uplift",
        metavar="LENGTH",
        help='Free space for uplift at the supports, as in "120 mm", in place of what the case '
        "says (requirements.uplift_space, or the gap of its uplift stops).",
        show_default=False,
    ),
]


def with_error(overrides: list[str], kind: str | None) -> list[str]:
    """Return the values to replace, with the kind of numerical error that was chosen among them."""
    if kind is None:
        return overrides
    refuse_rivals("--error", "settings.error", overrides)
    return [*overrides, f"settings.error={json.dumps(kind)}"]


def with_accurate(overrides: list[str], accurate: bool) -> list[str]:
    """Return the values to replace, with the integrator of fourth order where it is wanted."""
    if not accurate:
        return overrides
    refuse_rivals("--accurate", "settings.integrator", overrides)
    return [*overrides, "settings.integrator=extrapolated"]


def with_condition(overrides: list[str] | None, condition: str | None) -> list[str]:
    """Return the values to replace, with the condition that was chosen among them."""
    if condition is None:
        return list(overrides or [])
    refuse_rivals("--condition", "condition", overrides or ())
    chosen = None if condition == DESIGN else condition
    return [*(overrides or []), f"condition={json.dumps(chosen, ensure_ascii=False)}"]
