"""Advice before long work: what the numerical choices of a case can and cannot resolve.

Nothing is computed but closed forms. Every piece of advice has its numbers and its cure.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from tautwire.line.expand import expand
from tautwire.line.pieces import Line
from tautwire.model.resolution import Resolution, fewest_nodes, resolution
from tautwire.plain import Plain
from tautwire.signals.bands import WIDEST
from tautwire.signals.filters import STANDARD_CUTOFF
from tautwire.specs.case import Case
from tautwire.specs.pantograph import Air
from tautwire.specs.settings import NOT_GIVEN, STEPS_PER_PERIOD

Severity = Literal["refused", "warning", "note"]

STEPS_TO_FOLLOW = 10.0
"""Time steps per period below which an oscillation is distorted visibly: Newmark's step lengthens
a period by (2 pi/10)^2/12, 3 %."""

SPANS_AT_ENDS = 1.5
"""Spans next to an anchored end in which the contact force is disturbed. Chosen: with the
two spans that the default section leaves at each end nothing is said."""

SPEED_SHARE = 0.7
"""Share of the wave speed above which waves gather before the pantograph: the
limit of EN 50119 as remembered."""

SPEED_OF_LIFT = 23.0
"""Speed above which the force of the air is missed [m/s]: 85 km/h, where a target of
70 N + 0.00097 N/(km/h)^2 has risen by a tenth."""

_MOST_NODES = 200
"""Most nodes between droppers that the input takes (settings.nodes_between_droppers)."""

_MUCH_MEMORY = 1e9
"""Size of histories that is told [bytes]: an eighth of the memory of a small machine."""

_STEPS_PER_ELEMENT = 2.0
"""Steps per element below which the head passes what the mesh draws without seeing it."""


@dataclass(frozen=True)
class Advice(Plain):
    """One thing to know before computing.

    Attributes
    ----------
    topic : str
        A few words.
    severity : str
        ``"refused"``: a run will be refused; ``"warning"``: headline figures are at risk;
        ``"note"``: only figures above 20 Hz, or one end of the line, are.
    text : str
        What is the matter, with numbers.
    cure : str
    """

    topic: str
    severity: Severity
    text: str
    cure: str

    def __str__(self) -> str:
        return f"{self.topic}: {self.text}; {self.cure}"


def preflight(case: Case) -> tuple[Advice, ...]:
    """Compare mesh, time step, line and speed of a case with what it is asked for.

    Parameters
    ----------
    case
        A validated case.

    Returns
    -------
    tuple of Advice
        Most severe first; empty when there is nothing to say.
    """
    line = expand(case)
    resolved = resolution(case, line)
    found = [
        *_end_of_passage(case),
        *_speed(case),
        *_lift(case),
        *_start_of_section(case),
        *_ends_of_line(case),
        *_mesh(case, line, resolved),
        *_step(case, resolved),
        *_contact_resonance(case),
        *_steps_per_element(case, resolved.longest),
        *_sampling(case),
        *_memory(case, line),
        *_not_given(case),
    ]
    order: tuple[Severity, ...] = ("refused", "warning", "note")
    return tuple(sorted(found, key=lambda advice: order.index(advice.severity)))


def _not_given(case: Case) -> Iterator[Advice]:
    """Tell what the program chose because the input does not say."""
    for source in case.sources:
        if source.path == "settings.contact_stiffness" and source.source.startswith(NOT_GIVEN):
            yield Advice(
                "contact stiffness",
                "warning",
                f"no contact stiffness is given; "
                f"{1e-3 * case.settings.contact_stiffness:g} kN/m is used, as in the reference "
                "model of EN 50318:2002. Forces above 5 Hz and losses of contact depend on it",
                "settings.contact_stiffness: 50 kN/m to 200 kN/m; 'tautwire advise' tells what it "
                "means for the band of interest",
            )


def _end_of_passage(case: Case) -> Iterator[Advice]:
    """Tell that a pantograph is still in the section when the passage ends."""
    first, last = case.resolved_section()
    reach = case.line.length() - case.settings.start
    behind = case.pantographs[-1].behind
    missing = min(_way_through_section(case), reach) + behind - reach
    if missing <= 1e-9:
        return
    cure = "add spans (line.spans) or end the section earlier (settings.section)"
    text = (
        f"when the leading pantograph reaches the end of the line, pantograph "
        f"{case.pantographs[-1].name!r}, {behind:g} m behind, is still {missing:.0f} m inside the "
        f"analysed section (spans {first} to {last})"
    )
    yield Advice("line too short", "refused", text, cure)


def _way_through_section(case: Case) -> float:
    """Return the distance from the anchor behind the train to the far end of the section [m]."""
    first, last = case.resolved_section()
    supports = case.line.support_positions()
    forward = case.scenario.direction == "+x"
    return supports[last] if forward else supports[-1] - supports[first - 1]


def _way_to_section(case: Case) -> float:
    """Return the distance from the anchor behind the train to the section [m]."""
    first, last = case.resolved_section()
    supports = case.line.support_positions()
    forward = case.scenario.direction == "+x"
    return supports[first - 1] if forward else supports[-1] - supports[last]


def _speed(case: Case) -> Iterator[Advice]:
    speed, wave = case.scenario.speed, case.wires.contact.wave_speed()
    if speed > SPEED_SHARE * wave:
        tension = case.wires.contact.mass * (speed / SPEED_SHARE) ** 2
        yield Advice(
            "speed",
            "warning",
            f"{3.6 * speed:.4g} km/h is {speed / wave:.2f} of the wave speed of the contact wire "
            f"({3.6 * wave:.4g} km/h); above {SPEED_SHARE:g} small changes of the input show "
            "strongly",
            f"go below {_rounded_down(3.6 * SPEED_SHARE * wave):g} km/h (scenario.speed) or raise "
            f"wires.contact.tension to {1e-3 * tension:.1f} kN",
        )


def _lift(case: Case) -> Iterator[Advice]:
    """Tell that the air lifts no pantograph of a fast train."""
    scenario = case.scenario
    is_prescribed = scenario.mean_force is not None or scenario.uplift_force is not None
    if is_prescribed or scenario.speed < SPEED_OF_LIFT:
        return
    at_rest, air = Air(0.0, scenario.tunnel_factor), scenario.air
    for number, one in enumerate(case.pantographs, 1):
        by_air = one.uplift_force(air) - one.uplift_force(at_rest)
        if by_air == 0.0 and one.stage_forces(air) == one.stage_forces(at_rest):
            yield Advice(
                "uplift force",
                "warning",
                f"{one.uplift_force(air):g} N lift pantograph {one.name!r} at "
                f"{3.6 * scenario.speed:.4g} km/h as at standstill: no force of the air is given",
                "scenario.mean_force: a force, or {constant: 70 N, per_speed_squared: "
                "0.00097 N/(km/h)^2} (target of EN 50367 for AC lines, remembered); or "
                f"pantographs[{number}].aerodynamic",
            )


def _start_of_section(case: Case) -> Iterator[Advice]:
    """Tell that the uplift force is still growing where the statistics begin."""
    settings = case.settings
    way = _way_to_section(case) - settings.start
    ramp = settings.ramp * case.scenario.speed
    if way < ramp:
        yield Advice(
            "start",
            "warning",
            f"the analysed section begins {max(way, 0.0):.0f} m after the start, and the uplift "
            f"force grows over {ramp:.0f} m (settings.ramp {settings.ramp:g} s)",
            "begin the section later (settings.section), add spans, or shorten settings.ramp",
        )


def _ends_of_line(case: Case) -> Iterator[Advice]:
    """Tell that the section comes close to an end of the line."""
    first, last = case.resolved_section()
    before, after = first - 1, case.line.spans - last
    near = [
        f"{count} span{'' if count == 1 else 's'} {where}"
        for count, where in ((before, "before"), (after, "after"))
        if count < SPANS_AT_ENDS
    ]
    if near:
        yield Advice(
            "ends of the line",
            "warning",
            f"the analysed section (spans {first} to {last} of {case.line.spans}) leaves only "
            f"{' and '.join(near)} it; within {SPANS_AT_ENDS:g} spans of an anchored end the "
            "contact force is disturbed",
            "leave two spans at each end (settings.section) or add spans (line.spans)",
        )


def _mesh(case: Case, line: Line, found: Resolution) -> Iterator[Advice]:
    """Tell that the wire mesh does not carry the band."""
    band = case.settings.band
    if found.mesh >= band * (1.0 - 1e-6):
        return
    nodes = fewest_nodes(line, band, case.scenario.speed)
    finer = f", or give at least {nodes}" if nodes <= _MOST_NODES else ""
    cure = (
        f"leave settings.nodes_between_droppers out for a mesh that carries the band{finer}"
        if case.settings.nodes_between_droppers is not None
        else f"shorter elements are not chosen; {_without_shorter_elements(found.mesh)}"
    )
    yield Advice(
        "mesh",
        "warning" if found.mesh < STANDARD_CUTOFF else "note",
        f"elements of up to {found.element:.3g} m of the wire {found.run!r} carry waves up to "
        f"{found.mesh:.0f} Hz of the band 0-{band:g} Hz, and a head passes those of the contact "
        f"wire at multiples of {case.scenario.speed / found.longest:.0f} Hz; losses of contact and "
        f"figures above {found.mesh:.0f} Hz are marked ‡",
        cure,
    )


def _without_shorter_elements(carried: float) -> str:
    """Return the cure where the mesh would need elements that are too short."""
    if carried >= STANDARD_CUTOFF:
        return f"give settings.band: {_rounded_down(carried):g} Hz, or settings.longest_element"
    return "lower scenario.speed or raise wires.contact.tension"


def _step(case: Case, found: Resolution) -> Iterator[Advice]:
    """Tell that the time step does not carry the band."""
    band = case.settings.band
    if found.step >= band * (1.0 - 1e-6):
        return
    step = 1e3 * case.settings.step()
    yield Advice(
        "time step",
        "note",
        f"steps of {step:g} ms carry {found.step:.4g} Hz of the band 0-{band:g} Hz "
        f"({STEPS_PER_PERIOD:g} steps per period); losses of contact and figures above are "
        "marked ‡",
        f"leave settings.time_step out, or give {1e3 / (STEPS_PER_PERIOD * band):.3g} ms",
    )


def _contact_resonance(case: Case) -> Iterator[Advice]:
    """Tell that the time step cannot follow a head on its contact spring."""
    step = case.settings.step()
    names: dict[float, list[str]] = {}
    for pantograph in case.pantographs:
        head = pantograph.stages[0]
        stiffness = case.settings.contact_stiffness + head.stiffness
        frequency = math.sqrt(stiffness / head.mass) / (2.0 * math.pi)
        names.setdefault(frequency, []).append(repr(pantograph.name))
    for frequency, heads in names.items():
        steps = 1.0 / (frequency * step)
        if steps < STEPS_TO_FOLLOW:
            longest = 1.0 / (frequency * STEPS_TO_FOLLOW)
            yield Advice(
                "time step",
                "warning",
                f"on the contact spring the head of pantograph {' and '.join(heads)} oscillates at "
                f"{frequency:.0f} Hz, {steps:.1f} steps of {1e3 * step:g} ms per period; "
                f"{STEPS_TO_FOLLOW:g} are needed to follow it",
                f"settings.time_step: {1e3 * _rounded_down(longest):g} ms, or a lower "
                "settings.contact_stiffness",
            )


def _steps_per_element(case: Case, element: float) -> Iterator[Advice]:
    """Tell that a pantograph crosses an element of the contact wire in less than two steps."""
    advance = case.scenario.speed * case.settings.step()
    if advance > element / _STEPS_PER_ELEMENT:
        longest = element / _STEPS_PER_ELEMENT / case.scenario.speed
        yield Advice(
            "time step",
            "note",
            f"a pantograph advances {advance:.3g} m per step, more than half of an element of "
            f"the contact wire ({element:.3g} m)",
            f"settings.time_step: {1e3 * _rounded_down(longest):g} ms, or longer elements",
        )


def _sampling(case: Case) -> Iterator[Advice]:
    """Tell that bands reach the Nyquist frequency of the record."""
    nyquist = 0.5 / case.settings.step()
    if nyquist <= WIDEST:
        yield Advice(
            "time step",
            "refused" if nyquist <= STANDARD_CUTOFF else "note",
            f"with {1e3 * case.settings.step():g} ms the record holds nothing from "
            f"{nyquist:.4g} Hz on; bands that reach it have no value",
            f"settings.time_step below {500.0 / WIDEST:g} ms for all bands",
        )


def _memory(case: Case, line: Line) -> Iterator[Advice]:
    """Tell that the histories of a passage fill the memory of a usual machine."""
    droppers, supports = len(line.hangers), len(line.contact_supports)
    stages = sum(len(pantograph.stages) + 3 for pantograph in case.pantographs)
    steps = case.line.length() / case.scenario.speed / case.settings.step()
    size = 2 * 8 * steps * (droppers + supports + stages)
    if size > _MUCH_MEMORY:
        yield Advice(
            "memory",
            "warning",
            f"a passage has {steps:.2g} steps, and its histories take about "
            f"{1e-9 * size:.2g} GB of memory",
            "use fewer spans (line.spans) or a longer settings.time_step, or check scenario.speed",
        )


def _rounded_down(value: float) -> float:
    """Round down to two significant digits."""
    scale = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.floor(value / scale + 1e-9) * scale
