"""``cases``: what the library holds."""

from __future__ import annotations

import os
from pathlib import Path

from tautwire.catalogue.entries import copy_case, list_entries, read_entry
from tautwire.cli.session import Answer
from tautwire.cli.views.tables import heading, table
from tautwire.errors import InputError
from tautwire.inputs.book.case_book import write_workbook
from tautwire.inputs.load import load_case
from tautwire.text import as_name

WORKBOOK = ".xlsx"


def list_library(answer: Answer, *, copying: bool = False) -> None:
    """Show names and summaries of all entries."""
    entries = list_entries()
    if copying:
        names = ", ".join(entry.name for entry in entries)
        raise InputError(
            f"--copy needs the name of what to copy, as in 'tautwire cases ac-simple --copy "
            f"my-line.yaml'; the library holds: {names}"
        )
    answer.document["cases"] = [
        {"name": entry.name, "kind": entry.kind, "summary": entry.summary} for entry in entries
    ]
    for kind, title in (("case", "Cases"), ("pantograph", "Pantographs")):
        rows = [(e.name, e.summary.rstrip(".")) for e in entries if e.kind == kind]
        answer.show(heading(title), table(("", ""), "lL", rows))
    answer.show(
        heading("Next"),
        "tautwire cases ac-simple --copy my-line.yaml    a file to edit\n"
        "tautwire run ac-simple                          a first report",
    )


def show_entry(answer: Answer, name: str) -> None:
    """Show the text of an entry."""
    text = read_entry(name)
    answer.document.update({"name": name, "text": text})
    answer.show(text.rstrip("\n"))


def copy_entry(answer: Answer, name: str, path: Path, *, force: bool) -> None:
    """Copy an entry to a file."""
    copy = _copy_as_workbook if path.suffix.lower() == WORKBOOK else copy_case
    written = copy(name, path, force=force)
    answer.document.update({"name": name, "file": str(written)})
    answer.show(
        f"{written} written. Edit it, then: tautwire check {written}",
    )


def _copy_as_workbook(name: str, path: Path, *, force: bool) -> Path:
    """Write a case of the library as a workbook that begins a line of one's own."""
    case = load_case(name)
    if os.path.lexists(path) and (path.is_dir() or not force):
        raise InputError(f"{path}: exists already; choose another name, or --force")
    sources = [{**one.to_dict(), "template": name} for one in case.sources]
    own = case.with_(name=as_name(path.stem), title="", description="", sources=sources)
    return write_workbook(own, path)
