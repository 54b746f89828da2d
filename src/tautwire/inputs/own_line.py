"""A line of one's own to begin with: every value plausible, every choice with its reason.

What is chosen here is written into the file as a source that states its value: as long as the value
stands, it counts as taken over from the template and not checked for the line.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from tautwire.inputs.paths import format_path
from tautwire.signals.bands import WIDEST
from tautwire.specs.schema.upgrade import SCHEMA_VERSION
from tautwire.units import to_unit

TEMPLATE = "tautwire new"
USUAL_SPEED = 160.0 / 3.6
"""Speed where none is given [m/s]: that of most electrified lines."""
System = Literal["ac", "dc-1.5kv", "dc-3kv"]
Ends = Literal["mid-point", "weighted", "anchored"]


@dataclass(frozen=True)
class Wish:
    """What is known of the line; everything else is chosen.

    Attributes
    ----------
    name : str
    system : str
        Supply system, which decides the mean force.
    speed : float or None
        m/s.
    span : float or None
        m.
    spans : int
    contact, messenger : str or None
        Catalogue names.
    contact_tension, messenger_tension : float or None
        N.
    ends : str
        What is modelled: from the ``mid-point`` of a tension length to its weights, a whole tension
        length ``weighted`` at both ends, or wires ``anchored`` at both ends.
    band : float
        Highest frequency that mesh and time step carry [Hz].
    arm_share : float or None
        Share of the contact wire between the droppers beside a support that its arm carries.
    """

    name: str
    system: System = "ac"
    speed: float | None = None
    span: float | None = None
    spans: int = 14
    contact: str | None = None
    messenger: str | None = None
    contact_tension: float | None = None
    messenger_tension: float | None = None
    ends: Ends = "mid-point"
    band: float = WIDEST
    arm_share: float | None = None

    def running(self) -> float:
        """Return the speed [m/s], chosen where none is known."""
        return USUAL_SPEED if self.speed is None else self.speed


@dataclass(frozen=True)
class Choice:
    """One value of the template: where it goes, what it is, why; no reason where it was given."""

    path: tuple[str, ...]
    value: Any
    reason: str = ""
    confidence: str = "choice"


@dataclass(frozen=True)
class _Usual:
    """What lines for a speed are usually built of."""

    up_to: float
    contact: str
    contact_tension: float
    messenger: str
    messenger_tension: float
    span: float
    after: str


_USUAL = (
    _Usual(100.0 / 3.6, "AC-100 Cu", 7.1e3, "Cu 50/7", 7.1e3, 60.0, "Norwegian system 35"),
    _Usual(200.0 / 3.6, "AC-100 Cu", 10e3, "Bz II 50/19", 10e3, 60.0, "Norwegian system 20B"),
    _Usual(250.0 / 3.6, "AC-120 CuAg0.1", 15e3, "Bz II 70/19", 15e3, 60.0, "Norwegian system 25"),
    _Usual(math.inf, "AC-120 CuMg0.5", 27e3, "Bz II 120/19", 21e3, 55.0, "SICAT H1.0"),
)
_MEAN_FORCE: dict[str, tuple[tuple[float, float, float], ...]] = {
    "ac": ((200.0, 90.0, 0.00047), (math.inf, 70.0, 0.00097)),
    "dc-1.5kv": ((200.0, 140.0, 0.00097), (math.inf, 90.0, 0.00228)),
    "dc-3kv": ((math.inf, 110.0, 0.00097),),
}
"""Upper curves of the mean force by supply system: up to a speed [km/h], N, N/(km/h)^2."""
FIRST_DROPPER = 4.5
"""Distance of the first dropper from the support [m], as in AC simple; 2.25 to 5.5 m are built."""
SPACING = 7.0
"""Longest distance of droppers aimed at [m]; 5 to 7 m in Spain, up to 11 m in Norway."""


def template(wish: Wish) -> tuple[Choice, ...]:
    """Return every value of a line of one's own, chosen where the wish leaves it open."""
    usual = next(one for one in _USUAL if wish.running() <= one.up_to + 1e-9)
    span = usual.span if wish.span is None else wish.span
    positions = dropper_positions(span)
    return (
        *_line(wish, span, usual),
        *_wires(wish, usual),
        *_supports(wish),
        *_droppers(wish, span, positions),
        Choice(("pantographs",), [{"use": "benchmark-2015", "name": "front"}],
               "pantograph of the world benchmark; take your own: tautwire catalogue --kind "
               "pantograph"),
        *_scenario(wish),
        *_settings(wish),
    )  # fmt: skip


def dropper_positions(span: float) -> list[float]:
    """Return dropper positions in a span [m]: the first at 4.5 m, the others evenly between."""
    first = min(FIRST_DROPPER, span / 3.0)
    intervals = max(1, math.ceil((span - 2.0 * first) / SPACING - 1e-9))
    step = (span - 2.0 * first) / intervals
    return [round(first + step * number, 3) for number in range(intervals + 1)]


def presag_of(wish: Wish, span: float, positions: Sequence[float]) -> list[float]:
    """Return a parabolic pre-sag [m] that is 0 at the first and last dropper of a span."""
    first, half = positions[0], (positions[-1] - positions[0]) / 2.0
    if half <= 0.0:
        return [0.0 for _ in positions]
    depth = _presag_share(wish) * span
    return [round(max(depth * (1.0 - ((x - first - half) / half) ** 2), 0.0), 6) for x in positions]


def _presag_share(wish: Wish) -> float:
    """Return the pre-sag over the span: 0.4 to 0.6 per mille in Spain, 1 in AC simple."""
    return 0.5e-3 if wish.running() <= 250.0 / 3.6 + 1e-9 else 1e-3


def as_data(choices: Sequence[Choice]) -> dict[str, Any]:
    """Return the template as plain data with its sources, as a file would hold it."""
    data: dict[str, Any] = {"schema": SCHEMA_VERSION}
    for choice in choices:
        node = data
        for step in choice.path[:-1]:
            node = node.setdefault(step, {})
        node[choice.path[-1]] = choice.value
    return {**data, "sources": _sources(choices)}


def as_text(choices: Sequence[Choice]) -> str:
    """Return the template as a commented case file."""
    lines = [
        "# A line of your own, begun with 'tautwire new'. The program chose what is not marked",
        "# 'given'; the reason stands beside it. Change what you know better: 'tautwire check'",
        "# lists what is still as it was chosen.",
        "",
        f"schema: {SCHEMA_VERSION}",
    ]
    above: tuple[str, ...] = ()
    for choice in choices:
        shared = 0
        while shared < len(choice.path) - 1 and choice.path[: shared + 1] == above[: shared + 1]:
            shared += 1
        for depth in range(shared, len(choice.path) - 1):
            lines += [""] * (depth == 0) + [f"{'  ' * depth}{choice.path[depth]}:"]
        lines += [""] * (len(choice.path) == 1 and bool(above[1:]))
        indent = "  " * (len(choice.path) - 1)
        lines += _explained(f"{indent}{choice.path[-1]}: {written(choice.value)}", indent, choice)
        above = choice.path
    lines += ["", "# The reasons again, for the report; each holds for the value that it states.",
              "sources:"]  # fmt: skip
    for source in _sources(choices):
        lines.append(f"  - {written(source)}")
    return "\n".join(lines) + "\n"


def written(value: Any) -> str:
    """Return a value as YAML on one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {written(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(written(item) for item in value) + "]"
    return json.dumps(value, ensure_ascii=False)


def _explained(line: str, indent: str, choice: Choice) -> list[str]:
    reason = choice.reason or "given"
    if len(line) + len(reason) + 4 <= 100:
        return [f"{line}  # {reason}"]
    return [f"{indent}# {reason}", line]


def _sources(choices: Sequence[Choice]) -> list[dict[str, Any]]:
    return [
        {
            "path": format_path(choice.path),
            "value": choice.value,
            "source": choice.reason,
            "confidence": choice.confidence,
            "template": TEMPLATE,
        }
        for choice in choices
        if choice.reason
    ]


def _line(wish: Wish, span: float, usual: _Usual) -> list[Choice]:
    ends, why = {
        "mid-point": (
            {"left": "anchored", "right": "weighted"},
            "half a tension length: held at its mid-point, weighted at the other end",
        ),
        "weighted": ("weighted", ""),
        "anchored": ("anchored", ""),
    }[wish.ends]
    reason = "" if wish.span is not None else f"as in {usual.after} and lines like it"
    return [
        Choice(("name",), wish.name),
        Choice(("line", "spans"), wish.spans, "three spans to run in, four to run out, the rest "
               "analysed"),
        Choice(("line", "span_length"), span, reason),
        Choice(("line", "ends"), ends, why),
    ]  # fmt: skip


def _wires(wish: Wish, usual: _Usual) -> list[Choice]:
    choices = []
    for wire in ("contact", "messenger"):
        for key, tail in (("use", ""), ("tension", "_tension")):
            given = getattr(wish, wire + tail)
            value = getattr(usual, wire + tail) if given is None else given
            reason = "" if given is not None else f"as in {usual.after}"
            shown = f"{value / 1e3:g} kN" if key == "tension" else value
            choices.append(Choice(("wires", wire, key), shown, reason))
    return choices


def _supports(wish: Wish) -> list[Choice]:
    return [
        Choice(("supports", "use"), "light cantilever", "aluminium cantilever; take your own"),
        Choice(("supports", "contact_height"), "5.3 m", "a usual nominal height"),
        Choice(("supports", "encumbrance"), "1.4 m", "1.2 to 1.8 m are built"),
        Choice(("supports", "contact_stagger"), "0.2 m", "0.2 to 0.3 m are built; alternates"),
        Choice(("supports", "closure"), "lift", "the wire hangs free; an arm that carries it "
               "(height) gives less uplift than published"),
        Choice(("supports", "share"), wish.arm_share or 0.0, "" if wish.arm_share is not None else
               "of the wire between the droppers beside it that an arm carries; 0 fits published "
               "uplifts, practice runs to 0.5"),
    ]  # fmt: skip


def _droppers(wish: Wish, span: float, positions: list[float]) -> list[Choice]:
    sag, share = presag_of(wish, span, positions), _presag_share(wish)
    return [
        Choice(("droppers", "use"), ["Bz II 10/49", "light dropper clamps"], "the usual dropper"),
        Choice(("droppers", "positions"), positions,
               f"first {positions[0]:g} m from the support, then at most {SPACING:g} m apart"),
        Choice(("droppers", "presag"), [f"{1e3 * s:.1f} mm" for s in sag],
               f"parabola, {1e3 * share:g} per mille of the span; Spain 0.4 to 0.6, AC simple 1"),
    ]  # fmt: skip


def _scenario(wish: Wish) -> list[Choice]:
    speed = to_unit(wish.running(), "km/h")
    _, constant, factor = next(row for row in _MEAN_FORCE[wish.system] if speed <= row[0] + 1e-9)
    law = {"constant": f"{constant:g} N", "per_speed_squared": f"{factor:g} N/(km/h)^2"}
    reason = f"upper curve of EN 50367 for {wish.system}, not compared with the standard"
    return [
        Choice(
            ("scenario", "speed"), f"{speed:.6g} km/h", "" if wish.speed else "speed of most lines"
        ),
        Choice(("scenario", "mean_force"), law, reason, "memory"),
    ]


def _settings(wish: Wish) -> list[Choice]:
    return [
        Choice(("settings", "contact_stiffness"), "50 kN/m", "value of EN 50318:2002; 50 to "
               "200 kN/m are usual, 10 % in sigma"),
        Choice(("settings", "band"), f"{wish.band:g} Hz",
               "mesh and time step carry it; losses of contact need 200 Hz"),
    ]  # fmt: skip
