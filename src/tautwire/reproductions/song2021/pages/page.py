"""The page of the reproduction: every figure and table of the paper, and a verdict per claim."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from tautwire.report.parts.blocks import (
    Callout,
    Cell,
    Details,
    Key,
    Keys,
    Section,
    Table,
    Text,
    Verdict,
)
from tautwire.report.parts.words import MISSING, number
from tautwire.report.writers.html import render
from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.claims import (
    CONDITIONAL,
    NO_VALUE,
    NOT_REPRODUCED,
    REPRODUCED,
    RULE,
    Claim,
    Evidence,
    counts,
)
from tautwire.reproductions.song2021.pages.page_high import sources_section
from tautwire.reproductions.song2021.pages.page_model import (
    mesh_section,
    model_section,
    readings_section,
    stiffness_section,
)
from tautwire.reproductions.song2021.pages.page_steps import steps_section
from tautwire.version import __version__

if TYPE_CHECKING:
    from tautwire.reproductions.song2021.reproduction import SongRecord

OUTCOMES = {
    REPRODUCED: "passed",
    CONDITIONAL: "unverified",
    NOT_REPRODUCED: "failed",
    NO_VALUE: "unverified",
}
SHORT = {CONDITIONAL: "conditional"}
MOST_NAMED = 6
"""More conditions than these are counted, and named below with the evidence."""

MOST_NUMBERS = 400
"""Longest table of evidence; the CSV file has all."""


def page_html(record: SongRecord) -> str:
    """Return the reproduction as one page that needs no network.

    Parameters
    ----------
    record
    """
    material = record.material
    contents = [
        _summary(record),
        readings_section(material),
        model_section(material),
        mesh_section(material),
        stiffness_section(material),
        sources_section(material),
        steps_section(material),
        _evidence(record.claims),
        _conditions(record),
    ]
    return render(contents, _masthead(record))


def _masthead(record: SongRecord) -> dict[str, object]:
    scope = {"full": "full", "quick": "quick: fewer readings, coarser mesh"}
    return {
        "title": "The high-frequency programme of Song, Rønnquist, Nåvik (2021), repeated",
        "description": record.title,
        "facts": {
            "Line": "AC simple, world benchmark 2015",
            "Passages": f"{record.cost['passages']:g}",
            "Scope": scope.get(record.scope, record.scope),
            "Status": record.status,
            "Processor time": duration(record.cost["cpu_s"]),
        },
        "version": __version__,
        "case_hash": "ac-simple",
    }


def _summary(record: SongRecord) -> Section:
    found = counts(record.claims)
    words = {REPRODUCED: "reproduced", CONDITIONAL: "reproduced under stated conditions",
             NOT_REPRODUCED: "not reproduced", NO_VALUE: "not evaluated"}  # fmt: skip
    keys = tuple(Key(str(found[v]), "", word) for v, word in words.items() if v in found)
    blocks: list[object] = [Text(record.statement, "statement"), Keys(keys), Text(RULE)]
    if record.missing:
        lines = tuple(f"{name}: {reason}" for name, reason in record.missing.items())
        blocks.append(Callout(("Missing computations:", *lines[:12])))
    rows = tuple(_claim_row(claim) for claim in record.claims)
    head = ("section", "claim", "verdict", "found here (the paper) [limit]")
    blocks.append(Table("Every claim of sections II to VI.", head, "llll", rows))
    return Section("summary", "Claims and verdicts", tuple(blocks))


def _claim_row(claim: Claim) -> tuple[Cell, ...]:
    return (
        claim.section,
        claim.statement,
        Verdict(SHORT.get(claim.verdict, claim.verdict), OUTCOMES[claim.verdict]),
        brief(claim),
    )


def brief(claim: Claim) -> str:
    """Say in a few numbers what a claim rests on.

    Parameters
    ----------
    claim
    """
    if not claim.evidence:
        return claim.remark or "not computed in this scope"
    if claim.explanation:
        return " ".join(part for part in (_conditional(claim), claim.remark) if part)
    ranges: list[str] = []
    for name in dict.fromkeys(item.quantity for item in claim.evidence):
        items = [item for item in claim.evidence if item.quantity == name]
        low, high = min(i.found for i in items), max(i.found for i in items)
        ends = [f"{round(v, 6):.4g}".replace("-", "\N{MINUS SIGN}") for v in (low, high)]
        shown = " to ".join(dict.fromkeys(ends))
        unit = "" if items[0].unit in ("1", "") else f" {items[0].unit}"
        wanted = {i.published for i in items if i.published is not None}
        own = f" ({wanted.pop():g})" if len(wanted) == 1 else _limit(items)
        ranges.append(f"{name} {shown}{unit}{own}")
    text = "; ".join(ranges[:4])
    more = f"; and {len(ranges) - 4} more" if len(ranges) > 4 else ""
    return f"{text}{more}. {claim.remark}".strip()


def _limit(items: Sequence[Evidence]) -> str:
    """Write the limit of some numbers if it is one for all of them."""
    limits = {item.requirement for item in items}
    if len(limits) != 1 or not items[0].is_judged:
        return ""
    return f" [{limits.pop()}]"


def _conditional(claim: Claim) -> str:
    """Name the conditions under which a claim holds, or only count them when there are many."""
    outcomes = claim.by_condition
    if len(outcomes) <= MOST_NAMED:
        return claim.explanation
    kept = [own.text for own, holds in outcomes.items() if holds]
    named = f": {'; '.join(kept[:MOST_NAMED])}" + ("; …" if len(kept) > MOST_NAMED else "")
    return f"holds under {len(kept)} of {len(outcomes)} conditions{named}."


def _evidence(claims: Sequence[Claim]) -> Section:
    blocks: list[object] = [
        Text("Every number that a verdict rests on, with its limits; record.csv holds the same.")
    ]
    for claim in claims:
        rows = tuple(
            (
                item.condition.text or MISSING,
                item.quantity,
                number(item.found, _digits(item.found)),
                item.unit,
                MISSING if item.published is None else f"{item.published:g}",
                item.requirement,
                Verdict("kept", "passed") if item.holds else Verdict("not kept", "failed"),
            )
            for item in claim.evidence[:MOST_NUMBERS]
        )
        head = ("condition", "quantity", "found", "unit", "paper", "limits", "")
        block = Table(claim.remark, head, "llrlrll", rows)
        blocks.append(Details(f"{claim.section} · {claim.name}: {claim.verdict}", (block,)))
    return Section("evidence", "Evidence", tuple(blocks))


def _digits(value: float) -> int:
    size = abs(value)
    return 1 if size >= 100.0 else 2 if size >= 1.0 else 4


def _conditions(record: SongRecord) -> Section:
    sources = tuple((s.path, s.confidence, s.source) for s in record.doubtful_inputs)
    return Section(
        "conditions",
        "Conditions",
        (
            Text(f"Source: {published.SOURCE}. Filter of the paper: {published.FILTER}."),
            Text(
                "Where nothing else is said: library case ac-simple (steady arms hinged at 10°, "
                "contact stiffness 50 kN/m), time step 1 ms, sharp low-pass over the whole "
                "record, spans 4 to 13. Mean force at other speeds than 320 km/h: the paper does "
                "not say; here 70 N + 0.00097 v² (v in km/h), and 169 N beside it."
            ),
            Table("Inputs that are remembered or calibrated.", ("input", "known from", "source"),
                  "lll", sources),
        ),
    )  # fmt: skip


def duration(seconds: float) -> str:
    """Return a time in minutes."""
    return f"{seconds / 60.0:.1f} min"
