"""Validation record: what a published study claims, what this program finds, and a verdict."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from tautwire.assessment.references import ReferenceRow
from tautwire.files import write_text
from tautwire.report.pages.run_page import write_report
from tautwire.report.parts.blocks import Section, Table, Text, Verdict
from tautwire.report.parts.published import NAMES
from tautwire.report.parts.words import MISSING, listing, quantity
from tautwire.report.writers.html import render
from tautwire.results.run import Run
from tautwire.results.storage import save_run
from tautwire.specs.case import Source
from tautwire.text import csv_text
from tautwire.version import __version__

DOUBTFUL = ("memory", "calibrated")
"""Confidence of inputs that a reader must know about."""

_PUBLISHED_UNITS = {"N": (1.0, "N"), "m": (1e3, "mm"), "%": (1.0, "%")}
_OUTCOMES = {"inside": "passed", "outside": "failed"}


@dataclass(frozen=True)
class Claim:
    """One published range, and the number found with every filter.

    Attributes
    ----------
    run : str
        Which run it is about, as in ``"250 km/h"``.
    quantity : str
    unit : str
        Published unit; all numbers are in it.
    low, high : float
    found : mapping of str to float
        By kind of filter; by ``"unfiltered"`` where no filter is involved.
    inside : mapping of str to bool or None
        Whether each lies in the range; None without a value.
    confidence : str
        How well the published range is known.
    remark : str
        The number found over a wider section, for a claim that is not met.
    """

    run: str
    quantity: str
    unit: str
    low: float
    high: float
    found: Mapping[str, float]
    inside: Mapping[str, bool | None]
    confidence: str
    remark: str = ""

    @property
    def name(self) -> str:
        """Quantity as a person reads it."""
        if self.quantity.startswith("std_"):
            return f"σ, {self.quantity[4:].replace('_', '-')} Hz"
        return NAMES.get(self.quantity, self.quantity)

    @property
    def verdict(self) -> str:
        """``"inside"``, ``"outside"``, ``"depends on the filter"`` or ``"no value"``."""
        outcomes = set(self.inside.values())
        if None in outcomes:
            return "no value"
        if outcomes == {True}:
            return "inside"
        return "outside" if outcomes == {False} else "depends on the filter"

    @property
    def explanation(self) -> str:
        """With which filter, and over which section, the number lies inside; empty when met."""
        if self.verdict == "inside":
            return ""
        parts = []
        if self.verdict == "depends on the filter":
            kinds = [_short(kind) for kind, is_inside in self.inside.items() if is_inside]
            parts.append(
                f"inside with the {' and '.join(kinds)} filter; the source does not state its own"
            )
        return "; ".join([*parts, self.remark] if self.remark else parts)

    def as_dict(self) -> dict[str, Any]:
        """Return the claim as plain data for JSON, None in place of NaN."""
        found = {k: v if math.isfinite(v) else None for k, v in self.found.items()}
        return {
            "run": self.run,
            "quantity": self.quantity,
            "unit": self.unit,
            "low": self.low,
            "high": self.high,
            "found": found,
            "inside": dict(self.inside),
            "verdict": self.verdict,
            "explanation": self.explanation,
            "confidence": self.confidence,
        }


@dataclass(frozen=True, eq=False)
class Record:
    """A study repeated.

    Attributes
    ----------
    study, title : str
    status : str
        ``"done"``, or ``"partial"`` when it was interrupted.
    source : str
        Where the published numbers come from.
    published_filter : str
        What the source says about its filter.
    filters : mapping of str to str
        Filters used here, with every number.
    claims : tuple of Claim
    doubtful_inputs : tuple of Source
        Inputs that are remembered or calibrated.
    changed_inputs : tuple of str
        Inputs that differ from those of the library; empty for a true repetition.
    runs : mapping of str to Run
    """

    study: str
    title: str
    status: str
    source: str
    published_filter: str
    filters: Mapping[str, str]
    claims: tuple[Claim, ...]
    doubtful_inputs: tuple[Source, ...]
    changed_inputs: tuple[str, ...]
    runs: Mapping[str, Run]

    @property
    def counts(self) -> dict[str, int]:
        """Number of claims per verdict."""
        verdicts = [claim.verdict for claim in self.claims]
        return {verdict: verdicts.count(verdict) for verdict in dict.fromkeys(verdicts)}

    @property
    def statement(self) -> str:
        """The outcome in a sentence."""
        words = {"depends on the filter": "depending on the filter", "no value": "without value"}
        parts = [f"{count} {words.get(verdict, verdict)}" for verdict, count in self.counts.items()]
        text = f"{len(self.claims)} published ranges: {', '.join(parts)}."
        if self.status != "done":
            text += " The study was interrupted; the record is not complete."
        if self.changed_inputs:
            text += f" Changed for this run: {', '.join(self.changed_inputs)}."
        return text

    def as_dict(self) -> dict[str, Any]:
        """Return the record as plain data for JSON."""
        return {
            "study": self.study,
            "title": self.title,
            "version": __version__,
            "status": self.status,
            "statement": self.statement,
            "source": self.source,
            "published_filter": self.published_filter,
            "filters": dict(self.filters),
            "verdicts": self.counts,
            "claims": [claim.as_dict() for claim in self.claims],
            "doubtful_inputs": [entry.to_dict() for entry in self.doubtful_inputs],
            "changed_inputs": list(self.changed_inputs),
            "runs": {
                name: {"case_hash": run.case.hash(), "provenance": dict(run.provenance)}
                for name, run in self.runs.items()
            },
        }


def claims_of(
    run: str,
    by_filter: Mapping[str, Iterable[ReferenceRow]],
    wider: Mapping[str, Iterable[ReferenceRow]] | None = None,
    section: str = "",
) -> tuple[Claim, ...]:
    """Join the comparisons of one run with the same reference, made with several filters.

    Parameters
    ----------
    run
        Which run it is.
    by_filter
        Comparisons by kind of filter; rows without a range are left out.
    wider
        The same over a wider section, to explain what is not met.
    section
        Name of that section.
    """
    rows, others = _by_quantity(by_filter), _by_quantity(wider or {})
    return tuple(
        replace(_claim(run, own), remark=_remark(section, others.get(name, {})))
        for name, own in rows.items()
        if next(iter(own.values())).low is not None
    )


def _by_quantity(
    by_filter: Mapping[str, Iterable[ReferenceRow]],
) -> dict[str, dict[str, ReferenceRow]]:
    found: dict[str, dict[str, ReferenceRow]] = {}
    for kind, rows in by_filter.items():
        for row in rows:
            found.setdefault(row.quantity, {})[kind] = row
    return found


def _remark(section: str, rows: Mapping[str, ReferenceRow]) -> str:
    """Tell what is found over another section."""
    parts = []
    for kind, row in rows.items():
        factor, unit = _PUBLISHED_UNITS[row.unit]
        where = {True: "inside", False: "outside", None: "no value"}[row.inside]
        filtered = "" if row.filter == "unfiltered" else f" ({_short(kind)})"
        parts.append(f"{quantity(row.value * factor, unit)}{filtered}, {where}")
    return f"over {section}: {'; '.join(dict.fromkeys(parts))}" if parts else ""


def _claim(run: str, rows: Mapping[str, ReferenceRow]) -> Claim:
    any_row = next(iter(rows.values()))
    factor, unit = _PUBLISHED_UNITS[any_row.unit]
    if any_row.filter == "unfiltered":
        rows = {"unfiltered": any_row}
    low, high = any_row.low, any_row.high
    assert low is not None
    assert high is not None
    return Claim(
        run=run,
        quantity=any_row.quantity,
        unit=unit,
        low=round(low * factor, 9),
        high=round(high * factor, 9),
        found={kind: row.value * factor for kind, row in rows.items()},
        inside={kind: row.inside for kind, row in rows.items()},
        confidence=any_row.confidence,
    )


def writers(record: Record) -> dict[str, Callable[[Path], object]]:
    """Return the files of a record by name: how each is written to a path."""
    text = json.dumps(record.as_dict(), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    found: dict[str, Callable[[Path], object]] = {
        "record.html": lambda path: write_text(path, record_html(record)),
        "record.json": lambda path: write_text(path, text),
        "record.csv": lambda path: write_text(path, record_csv(record)),
    }
    for name, run in record.runs.items():
        slug = name.split()[0]
        found[f"run-{slug}.nc"] = lambda path, own=run: save_run(own, path)
    if record.runs:
        runs, labels = list(record.runs.values()), list(record.runs)
        found["report.html"] = lambda path: write_report(runs, path, labels=labels)
    return found


def record_csv(record: Record) -> str:
    """Return the claims as CSV, one row per claim and filter."""
    head = (
        "run", "quantity", "unit", "low", "high", "filter", "found", "inside", "verdict", "known"
    )  # fmt: skip
    rows = []
    for claim in record.claims:
        for kind, value in claim.found.items():
            number = f"{value:.6g}" if math.isfinite(value) else ""
            outcome = {True: "yes", False: "no", None: ""}[claim.inside[kind]]
            rows.append(
                (claim.run, claim.name, claim.unit, f"{claim.low:g}", f"{claim.high:g}",
                 kind, number, outcome, claim.verdict, claim.confidence)
            )  # fmt: skip
    return csv_text(head, rows)


def record_html(record: Record) -> str:
    """Return the record as one page that needs no network."""
    provenance = next((run.provenance for run in record.runs.values()), {})
    facts = {"Program": f"tautwire {__version__}", "Status": record.status} | {
        title: str(provenance.get(name) or MISSING)[:length]
        for title, name, length in (
            ("Commit", "commit", 40), ("Computed", "created", 10), ("Backend", "backend", 40),
        )
    }  # fmt: skip
    masthead = {
        "title": record.title,
        "description": "Validation record: published ranges beside what is found here.",
        "facts": facts,
        "version": __version__,
        "case_hash": listing([run.case.hash()[:12] for run in record.runs.values()]) or MISSING,
    }
    return render(list(_sections(record)), masthead)


def _sections(record: Record) -> Iterator[Section]:
    yield Section("summary", "Outcome", (Text(record.statement, "statement"),))
    for run in record.runs:
        yield Section(f"run-{run.split()[0]}", run, (_claims_table(record, run),))
    used = Table("Used here", ("filter", ""), "ll", tuple(record.filters.items()))
    note = (
        "The mean is rounded to 1 N before it is compared, as the published range is printed. "
        "Uplift and contact loss are not filtered."
    )
    published = Text(f"Published: {record.published_filter}.")
    yield Section("filters", "Filters", (published, used, Text(note, "note")))
    inputs = tuple((item.path, item.source, item.confidence) for item in record.doubtful_inputs)
    head = ("input", "source", "known from")
    remembered = Table("No input was adjusted to meet the ranges.", head, "lll", inputs)
    shown = remembered if inputs else Text("None.")
    yield Section("inputs", "Inputs that rest on memory", (shown,))
    yield Section("source", "Source of the ranges", (Text(record.source),))


def _claims_table(record: Record, run: str) -> Table:
    """Return the published ranges of one run, with what was found through every filter."""
    found = tuple(f"found, {_short(kind)}" for kind in record.filters)
    rows = tuple(
        (
            claim.name,
            range_text(claim),
            *(found_text(claim, kind) for kind in record.filters),
            Verdict(claim.verdict, _OUTCOMES.get(claim.verdict, "unverified")),
            claim.explanation,
            claim.confidence,
        )
        for claim in record.claims
        if claim.run == run
    )
    heads = ("quantity", "published range", *found, "verdict", "", "range known from")
    return Table(f"Published ranges at {run}", heads, "lr" + "r" * len(found) + "lll", rows)


def range_text(claim: Claim) -> str:
    """Return the published range as text."""
    low, high = (f"{value:g}".replace("-", "\N{MINUS SIGN}") for value in (claim.low, claim.high))
    return f"{low} {claim.unit}" if low == high else f"{low} to {high} {claim.unit}"


def _short(kind: str) -> str:
    return {"butterworth": "Butterworth"}.get(kind, kind)


def found_text(claim: Claim, kind: str) -> str:
    """Return the number found with a filter, or without one, as text."""
    value = claim.found.get(kind, claim.found.get("unfiltered"))
    return MISSING if value is None else quantity(value, claim.unit)
