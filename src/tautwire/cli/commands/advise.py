"""``advise``: what high frequencies ask of mesh, contact stiffness and cut-off."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from tautwire.analyses.force.cutoff import Cutoff, advise_cutoff
from tautwire.analyses.road.shape import find_shape
from tautwire.analyses.vibration.transmissibility import (
    CANDIDATES,
    ContactAdvice,
    HeadOnSpring,
    advise_contact_stiffness,
    receptance,
)
from tautwire.analyses.vibration.wavelengths import LineLengths, line_lengths
from tautwire.cli.about import program
from tautwire.cli.interrupts import Interrupts
from tautwire.cli.session import Answer
from tautwire.cli.views.tables import facts, heading, table
from tautwire.errors import InputError
from tautwire.inputs.load import load_case
from tautwire.model.build import build
from tautwire.model.preflight import preflight
from tautwire.report.parts.words import speed
from tautwire.specs.case import Case
from tautwire.version import __version__

LOWEST_BAND, HIGHEST_BAND = 5.0, 1000.0
"""Bands for which advice is given [Hz]: chosen, wider than any record of a contact force."""


def give_advice(answer: Answer, reference: str, overrides: Sequence[str], band: float) -> None:
    """Compute and show the advice for one case."""
    if not LOWEST_BAND <= band <= HIGHEST_BAND:
        raise InputError(f"--band: got {band:g} Hz; give {LOWEST_BAND:g} to {HIGHEST_BAND:g} Hz")
    case = load_case(reference, overrides)
    answer.say(program(case.settings.backend))
    lengths, cutoff = line_lengths(case), advise_cutoff(case)
    with Interrupts().handled():
        model = build(case)
        response = receptance(model, find_shape(model), highest=band)
    contact = advise_contact_stiffness(
        response,
        case.pantographs[0],
        band=band,
        candidates=(*CANDIDATES, case.settings.contact_stiffness),
    )
    mesh = [advice for advice in preflight(case) if advice.topic == "mesh"]
    answer.document.update(_document(case, lengths, cutoff, contact, mesh))
    answer.show(*_view(case, lengths, cutoff, contact, mesh))


def _document(
    case: Case, lengths: LineLengths, cutoff: Cutoff, contact: ContactAdvice, mesh: Sequence[Any]
) -> dict[str, Any]:
    return {
        "case": case.name,
        "case_hash": case.hash(),
        "version": __version__,
        "lengths": [
            {"name": name, "length_m": length, "frequency_hz": case.scenario.speed / length}
            for name, length in lengths.named().items()
        ],
        "cutoff": {
            "shortest_interval_m": cutoff.shortest,
            "wavenumber_per_m": cutoff.wavenumber,
            "frequency_hz": cutoff.frequency,
        },
        "contact_stiffness": contact.as_dict(),
        "mesh": [advice.as_dict() for advice in mesh],
    }


def _view(
    case: Case, lengths: LineLengths, cutoff: Cutoff, contact: ContactAdvice, mesh: Sequence[Any]
) -> list[Any]:
    at = speed(case.scenario.speed)
    rows = [
        (name, f"{length:.4g}", f"{case.scenario.speed / length:.2f}")
        for name, length in lengths.named().items()
    ]
    parts: list[Any] = [
        heading(case.title or case.name, f"at {at}"),
        table(("", "length\n[m]", "passed at\n[Hz]"), "lrr", rows),
        heading("Cut-off", "covers a quarter of the shortest dropper or support interval"),
        facts(
            [
                ("shortest interval", f"{cutoff.shortest:.4g} m"),
                ("wave number", f"{cutoff.wavenumber:g} 1/m"),
                (f"at {at}", f"{cutoff.frequency:.4g} Hz"),
            ]
        ),
        heading("Contact stiffness", f"head and wire together within "
                f"{100 * contact.tolerance:g} % up to {contact.band:g} Hz"),
        _contact_table(case, contact),
    ]  # fmt: skip
    parts += [heading("Mesh")]
    parts += [f"{advice.text}.\n{advice.cure}." for advice in mesh] or [
        "no element length is passed within 0 to 200 Hz"
    ]
    return parts


def _contact_table(case: Case, contact: ContactAdvice) -> Any:
    rows = [(_stiffness(item), *_figures(item), "this case" if _is_own(case, item) else "")
            for item in contact.candidates]  # fmt: skip
    if contact.smallest is not None:
        rows.append((_stiffness(contact.smallest), *_figures(contact.smallest), "smallest"))
    else:
        rows.append(("", "", "", "", "no stiffness keeps them together"))
    heads = ("stiffness\n[kN/m]", "deviation\nin the band", "good up to\n[Hz]",
             "head resonates\nat [Hz]", "")  # fmt: skip
    return table(heads, "rrrrL", rows)


def _is_own(case: Case, item: HeadOnSpring) -> bool:
    return item.stiffness == case.settings.contact_stiffness


def _stiffness(item: HeadOnSpring) -> str:
    return f"{1e-3 * item.stiffness:.4g}"


def _figures(item: HeadOnSpring) -> tuple[str, str, str]:
    return (f"{100 * item.deviation:.0f} %", f"{item.reaches:.1f}", f"{item.resonance:.1f}")
