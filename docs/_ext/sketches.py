"""Sketches of the words of a line, drawn to the numbers of lines that the program has found."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import cos, degrees, hypot, sin

import numpy as np

import tautwire as tw

LINE = {"line.spans": 4, "settings.section": [2, 3]}
"""Few spans of the reference line: what is drawn lies between the second and the fourth support."""
INK, SOFT, CONTACT, MESSENGER, ARM = "#16202b", "#55616e", "#0b3d63", "#8d99a5", "#d55e00"


class Sketch:
    """Shapes and texts of one picture; ``x`` and ``y`` are pixels, ``y`` points down."""

    def __init__(self, title: str, width: int, height: int) -> None:
        self.parts: list[str] = []
        self.title, self.width, self.height = title, width, height

    def line(self, points: Sequence[tuple[float, float]], colour: str = INK, width: float = 1.2,
             more: str = "") -> None:  # fmt: skip
        """Draw a polyline."""
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.parts.append(
            f'<polyline points="{path}" fill="none" stroke="{colour}" '
            f'stroke-width="{width}"{more}/>'
        )

    def dot(self, x: float, y: float, colour: str, radius: float = 3.5) -> None:
        """Draw a point."""
        self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{colour}"/>')

    def text(self, x: float, y: float, text: str, colour: str = INK, more: str = "") -> None:
        """Write a text; ``more`` are further attributes."""
        self.parts.append(
            f'<text x="{x:.1f}" y="{y:.1f}" fill="{colour}" stroke="#fff" stroke-width="4" '
            f'paint-order="stroke"{more}>{text}</text>'
        )

    def measure(self, first: tuple[float, float], last: tuple[float, float], text: str) -> None:
        """Draw a dimension line with its text, beside an upright one and above a level one."""
        self.line([first, last], SOFT, 1.0, ' marker-start="url(#tip)" marker-end="url(#tip)"')
        x, y = 0.5 * (first[0] + last[0]), 0.5 * (first[1] + last[1])
        if first[0] == last[0]:
            self.text(x + 8, y + 4, text)
        else:
            self.text(x, y - 6, text, more=' text-anchor="middle"')

    def svg(self) -> str:
        """Return the picture."""
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {self.height}" '
            f'font-family="sans-serif" font-size="13"><title>{self.title}</title>'
            '<defs><marker id="tip" markerWidth="9" markerHeight="9" refX="8" refY="4" '
            'orient="auto-start-reverse"><path d="M0,1 L8,4 L0,7" fill="none" stroke="#55616e"/>'
            f'</marker></defs><rect width="{self.width}" height="{self.height}" fill="#fff"/>'
        )
        return "\n".join([head, *self.parts, "</svg>", ""])


def found_line(**supports: str) -> tuple[tw.Case, tw.Equilibrium]:
    """Return the reference line with few spans and its static state."""
    changes = LINE | {f"supports.{name}": value for name, value in supports.items()}
    case = tw.load_case("ac-simple", changes)
    return case, tw.find_shape(tw.build(case))


def span_sketch() -> Sketch:
    """Draw one span from the side: encumbrance, pre-sag, dropper intervals; heights enlarged."""
    _, shape = found_line()
    left, right = shape.mast_x[1], shape.mast_x[2]
    per_metre, tall = 680.0 / (right - left), 170.0
    ground = float(shape.by_mast(shape.support_heights)[1])

    def at(x: float, z: float) -> tuple[float, float]:
        return 50.0 + per_metre * (x - left), 290.0 - tall * (z - ground)

    sketch = Sketch("One span of the reference line from the side", 800, 420)
    wires = {"contact": (CONTACT, 2.6), "messenger": (MESSENGER, 1.8)}
    for name, (colour, width) in wires.items():
        r = shape.wire(name).position
        inside = (r[:, 0] >= left - 3.5) & (r[:, 0] <= right + 3.5)
        sketch.line([at(x, z) for x, z in r[inside][:, [0, 2]]], colour, width)
    own = shape.dropper_span == 2
    feet = list(zip(shape.dropper_x[own], shape.dropper_heights[own], strict=True))
    for (x, z), length in zip(feet, shape.dropper_lengths[own], strict=True):
        sketch.line([at(x, z), at(x, z + length)], INK, 1.0)
    messenger = shape.wire("messenger").position
    top = float(np.interp(left, messenger[:, 0], messenger[:, 2]))
    for mast in (left, right):
        sketch.line([(at(mast, 0)[0], 40), (at(mast, 0)[0], 330)], "#c9d1d9", 6)
    sketch.measure(at(left + 0.6, ground), at(left + 0.6, top),
                   f"encumbrance {top - ground:.2f} m")  # fmt: skip
    straight, low = at(left, ground), min(z for _, z in feet)
    sketch.line([straight, at(right, ground)], SOFT, 1.0, ' stroke-dasharray="5 4"')
    x, z = feet[len(feet) // 2]
    sketch.line([at(x + 2, ground), at(x + 2, ground + 0.16)], SOFT, 1.0)
    sketch.text(
        at(x + 2, 0)[0] + 6, at(0, ground)[1] - 12, f"pre-sag {1e3 * (ground - low):.0f} mm"
    )
    lower = 350.0
    for a, b, name in ((left, feet[0][0], "SD"), (feet[1][0], feet[2][0], "DD")):
        for edge in (a, b):
            sketch.line([(at(edge, 0)[0], lower + 8), (at(edge, 0)[0], 300)], SOFT, 0.7)
        sketch.measure((at(a, 0)[0], lower), (at(b, 0)[0], lower), f"{name} {b - a:.2f} m")
    sketch.measure((at(left, 0)[0], 392), (at(right, 0)[0], 392), f"span {right - left:g} m")
    sketch.text(at(x, 0)[0] + 40, 120, "messenger wire", MESSENGER)
    sketch.text(at(x, 0)[0] + 90, 325, f"contact wire, {ground:.2f} m above the rails", CONTACT)
    times = tall / per_metre
    sketch.text(
        60, 24, f"Heights drawn {times:.0f} times as large as lengths along the track", SOFT
    )
    return sketch


def stagger_sketch() -> Sketch:
    """Draw the line in plan: stagger left and right, steady arms that pull; widths enlarged."""
    _, shape = found_line()
    masts = shape.mast_x[1:4]
    per_metre, wide = 560.0 / (masts[-1] - masts[0]), 100.0

    def at(x: float, y: float) -> tuple[float, float]:
        return 70.0 + per_metre * (x - masts[0]), 170.0 - wide * y

    sketch = Sketch("Two spans of the reference line in plan", 800, 340)
    sketch.line([at(masts[0] - 8, 0), at(masts[-1] + 8, 0)], SOFT, 1.0, ' stroke-dasharray="9 5"')
    r = shape.contact.position
    inside = (r[:, 0] >= masts[0] - 8) & (r[:, 0] <= masts[-1] + 8)
    sketch.line([at(x, y) for x, y in r[inside][:, :2]], CONTACT, 2.6)
    rows = shape.arm_supports - 1  # they count from 1
    for row, end, force in zip(rows, shape.arm_ends, shape.arm_forces, strict=True):
        x = float(shape.support_x[row])
        if not masts[0] - 1 <= x <= masts[-1] + 1:
            continue
        y = float(shape.running_stagger(np.array([x]))[0])
        sketch.line([at(x, y), at(end[0], end[1])], ARM, 2.2)
        sketch.dot(*at(x, y), CONTACT)
        side = 1.0 if end[1] > y else -1.0
        sketch.text(at(x, 0)[0] + 10, at(0, end[1] - 0.25 * side)[1] + 4,
                    f"arm pulls {force:.0f} N", ARM)  # fmt: skip
        sketch.text(at(x, 0)[0] + 10, at(0, 0.5 * y - 0.28 * side)[1] + 4,
                    f"stagger {1e3 * y:+.0f} mm".replace("-", "\N{MINUS SIGN}"))  # fmt: skip
    sketch.text(690, 174, "track axis", SOFT)
    times = f"widths drawn {wide / per_metre:.0f} times as large as lengths along the track"
    sketch.text(20, 24, f"Seen from above, left of the track is up; {times}", SOFT)
    return sketch


GRAVITY = 9.81
"""[m/s2]; half of the weight of an arm rests on the wire."""
MAST = 3
"""Number of the support that is drawn: the middle one."""
CLOSURES = {
    "height": {"closure": "height"},
    "lift": {"closure": "lift", "lift": "0 N"},
    "arm": {"closure": "arm"},
}
"""What closes the support, and what is given besides."""


def closure_sketch() -> Sketch:
    """Draw the arm of one support across the track, for three closures; given in bold."""
    sketch = Sketch("Three ways to close a support", 800, 260)
    for number, (name, given) in enumerate(CLOSURES.items()):
        for part in _closed(sketch, 20.0 + 262.0 * number, name, given):
            sketch.text(*part)
    return sketch


def _closed(
    sketch: Sketch, left: float, name: str, given: dict[str, str]
) -> Iterator[tuple[float, float, str, str, str]]:
    case, shape = found_line(**given)
    rows = shape.arm_supports - 1  # they count from 1
    arm = int(np.flatnonzero(shape.support_number[rows] == MAST)[0])
    row = int(rows[arm])
    height, angle = float(shape.support_heights[row]), float(shape.arm_angles[arm])
    pull = float(shape.arm_forces[arm])
    y, z, scale = left + 60.0, 145.0, 130.0
    end = shape.arm_ends[arm]
    reach = hypot(end[1] - _stagger(shape, row), end[2] - height)
    tip = (y + scale * reach * cos(angle), z - scale * reach * sin(angle))
    sketch.line([(y, z), tip], ARM, 3.0)
    sketch.line([(tip[0], tip[1] - 60), (tip[0], tip[1] + 20)], INK, 3.0)
    sketch.line([(y, z), (y + 75, z)], SOFT, 0.8, ' stroke-dasharray="4 4"')
    sketch.dot(y, z, CONTACT, 6)
    bold, none = ' font-weight="bold"', ""
    yield left, 28.0, f"closure: {name}", INK, bold
    own = case.supports.arm
    lift = pull * sin(angle) - 0.5 * GRAVITY * own.mass * own.length
    texts = {
        "height": f"height {height:.4f} m",
        "lift": f"carries {abs(round(lift, 1)):.1f} N of the wire",
        "arm": f"{degrees(angle):.1f}° at {reach:.2f} m",
    }
    for line, (what, text) in enumerate(texts.items()):
        yield left, 186.0 + 19.0 * line, text, INK, bold if what == name else none
    yield left, 186.0 + 19.0 * len(texts), f"pulls {pull:.0f} N", INK, none


def _stagger(shape: tw.Equilibrium, row: int) -> float:
    return float(shape.running_stagger(np.array([shape.support_x[row]]))[0])


SKETCHES = {"span": span_sketch, "stagger": stagger_sketch, "closure": closure_sketch}
"""Name of the file, and what draws it."""
