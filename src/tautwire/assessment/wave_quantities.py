"""Closed-form quantities of waves on the wires, for a line that has not been computed yet.

Symbols: T tension [N], m mass per length [kg/m], v speed [m/s], c wave speed of the contact wire.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from tautwire.line.expand import expand
from tautwire.line.measures import droppers_of_spans, recurring, span_lengths
from tautwire.line.pieces import Line
from tautwire.model.preflight import SPEED_SHARE
from tautwire.model.resolution import resolution
from tautwire.plain import Plain
from tautwire.specs.case import Case


def doppler_factor(speed: float, wave: float) -> float:
    """Return the Doppler factor ``(c - v) / (c + v)``.

    Parameters
    ----------
    speed, wave : float m/s
        Speed of the pantograph and of waves on the contact wire.
    """
    return (wave - speed) / (wave + speed)


def reflection_coefficient(
    contact_tension: float, contact_mass: float, messenger_tension: float, messenger_mass: float
) -> float:
    """Return the share of a wave that a dropper reflects.

    ``r = sqrt(T_m m_m) / (sqrt(T_m m_m) + sqrt(T_c m_c))``

    Parameters
    ----------
    contact_tension, messenger_tension : float N
    contact_mass, messenger_mass : float kg/m
    """
    messenger = math.sqrt(messenger_tension * messenger_mass)
    return messenger / (messenger + math.sqrt(contact_tension * contact_mass))


def amplification_factor(reflection: float, doppler: float) -> float:
    """Return the growth ``r / alpha`` of a wave between pantograph and dropper.

    Infinite at the wave speed.

    Parameters
    ----------
    reflection, doppler : float
    """
    return reflection / doppler if doppler > 0.0 else math.inf


def midspan_elasticity(
    span_length: float, contact_tension: float, messenger_tension: float, factor: float = 4.0
) -> float:
    """Estimate the elasticity at mid-span, ``L / (k (T_c + T_m))`` [m/N].

    Parameters
    ----------
    span_length : float m
    contact_tension, messenger_tension : float N
    factor : float
        4.0 without stitch wire, 3.5 with (translation of a textbook, one secondary source).
    """
    return span_length / (factor * (contact_tension + messenger_tension))


@dataclass(frozen=True)
class WaveQuantity(Plain):
    """One line of the wave-quantity sheet.

    Attributes
    ----------
    name : str
    value : float
        In `unit`.
    unit : str
        SI unit; ``"1"`` for a ratio.
    formula : str
    """

    name: str
    value: float
    unit: str
    formula: str


def wave_quantities(case: Case) -> tuple[WaveQuantity, ...]:
    """Evaluate the wave-quantity sheet of a case; nothing is simulated.

    Parameters
    ----------
    case : Case

    Returns
    -------
    tuple of WaveQuantity
        Wave speeds, speed ratio, Doppler, reflection and amplification factors, mid-span
        elasticity, resonance on the contact spring, passing frequencies.
    """
    line = expand(case)
    return (*_wave_rows(case), *_static_rows(case, line), *_passing_rows(case, line))


def _wave_rows(case: Case) -> list[WaveQuantity]:
    contact, speed = case.wires.contact, case.scenario.speed
    wave = contact.wave_speed()
    doppler = doppler_factor(speed, wave)
    rows = [WaveQuantity("wave speed of the contact wire", wave, "m/s", "c = sqrt(T/m)")]
    messenger = case.wires.messenger
    if messenger is not None:
        speed_above = messenger.wave_speed()
        name = "wave speed of the messenger wire"
        rows.append(WaveQuantity(name, speed_above, "m/s", "sqrt(T/m)"))
    rows += [
        WaveQuantity(
            f"{SPEED_SHARE:g} of the wave speed", SPEED_SHARE * wave, "m/s", f"{SPEED_SHARE:g} c"
        ),
        WaveQuantity("speed over wave speed", speed / wave, "1", "v/c"),
        WaveQuantity("Doppler factor", doppler, "1", "(c - v)/(c + v)"),
    ]
    if messenger is not None:
        reflection = reflection_coefficient(
            contact.tension, contact.mass, messenger.tension, messenger.mass
        )
        amplification = amplification_factor(reflection, doppler)
        law = "sqrt(T_m m_m)/(sqrt(T_m m_m) + sqrt(T_c m_c))"
        rows += [
            WaveQuantity("reflection coefficient of a dropper", reflection, "1", law),
            WaveQuantity("amplification factor", amplification, "1", "reflection / Doppler"),
        ]
    return rows


def _static_rows(case: Case, line: Line) -> list[WaveQuantity]:
    contact = sum(wire.tension for _, wire in case.wires.of_role("contact"))
    above = sum(wire.tension for _, wire in case.wires.of_role("messenger", "auxiliary"))
    softest = max(
        midspan_elasticity(length, contact, above if droppers else 0.0)
        for length, droppers in zip(span_lengths(line), droppers_of_spans(line), strict=True)
    )
    law = "L/(4 sum(T)), softest span; wires above count where droppers hang"
    rows = [WaveQuantity("mid-span elasticity, estimate", softest, "m/N", law)]
    for pantograph in case.pantographs:
        head = pantograph.stages[0]
        stiffness = case.settings.contact_stiffness + head.stiffness
        rows.append(
            WaveQuantity(
                f"head of {pantograph.name} on the contact spring",
                math.sqrt(stiffness / head.mass) / (2.0 * math.pi),
                "Hz",
                "sqrt((k_contact + k_head)/m_head)/(2 pi), wire and frame held",
            )
        )
    return rows


def _passing_rows(case: Case, line: Line) -> list[WaveQuantity]:
    speed = case.scenario.speed
    rows = []
    for name, length in passing_lengths(case, line).items():
        rows.append(WaveQuantity(f"passing of the {name}", speed / length, "Hz", f"v/{length:g} m"))
    element = resolution(case, line).longest
    rows.append(
        WaveQuantity(
            "passing of the longest element of the contact wire (numerical)",
            speed / element,
            "Hz",
            f"v/{element:g} m",
        )
    )
    return rows


def passing_lengths(case: Case, line: Line) -> dict[str, float]:
    """Return the lengths that recur along the line, by name, for spectra and their lines.

    Where spans or intervals of the analysed section differ, the commonest is taken; droppers in
    pairs count as one.

    Parameters
    ----------
    case : Case
    line : Line
        Its pieces.

    Returns
    -------
    dict of str to float m
        Keys ``span``, ``dropper interval``, ``support-dropper interval``.
    """
    found = recurring(line, *case.resolved_section())
    lengths = {"span": found.span}
    if found.between is not None:
        lengths["dropper interval"] = found.between
    if found.beside is not None:
        lengths["support-dropper interval"] = found.beside
    return lengths
