"""A drawing as SVG, one unit to the millimetre."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

import numpy as np

from tautwire.report.layout_plan.items import LAYERS, Drawing, Image, Label, Stroke
from tautwire.text import printable

FONT = "DejaVu Sans,Verdana,sans-serif"
CAPITAL = 0.729
"""Height of a capital per size of the font: that of DejaVu Sans."""
_GAP = 10.0
"""Between sheets that stand below each other [mm]."""


def svg_of(drawings: Sequence[Drawing], size: tuple[float, float], title: str) -> str:
    """Return drawings of one size as a picture, one below the other.

    Parameters
    ----------
    drawings
        Their origin is at the bottom left.
    size
        Width and height of each [mm].
    title
        What the picture is, for those who do not see it.
    """
    width, height = size
    whole = len(drawings) * (height + _GAP) - _GAP
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}mm" height="{whole:g}mm" '
        f'viewBox="0 0 {width:g} {whole:g}" role="img" font-family="{FONT}">',
        f"<title>{escape(printable(title))}</title>",
        f"<style>path{{fill:none;stroke-linejoin:round}}text{{white-space:pre}}"
        f"{''.join(_styles())}</style>",
    ]
    for number, drawing in enumerate(drawings):
        top = number * (height + _GAP)
        parts.append(f'<g transform="translate(0 {top:g})">')
        parts.append(f'<path d="M0 0H{width:g}V{height:g}H0Z" style="fill:#fff"/>')
        parts += _sheet(drawing, height)
        parts.append("</g>")
    return "\n".join([*parts, "</svg>\n"])


def _styles() -> Iterable[str]:
    for layer in LAYERS.values():
        dashes = f";stroke-dasharray:{_list(layer.dashes)}" if layer.dashes else ""
        yield f".{layer.name}{{stroke:{layer.colour};stroke-width:{layer.width:g}{dashes}}}"


def _list(values: Iterable[float]) -> str:
    return " ".join(f"{value:g}" for value in values)


def _sheet(drawing: Drawing, height: float) -> Iterable[str]:
    yield from (_image(image, height) for image in drawing.images)
    for name in LAYERS:
        strokes = [one for one in drawing.strokes if one.layer == name]
        if strokes:
            path = "".join(_path(one, height) for one in strokes)
            yield f'<path class="{name}" d="{path}"/>'
    kinds = sorted({(t.layer, t.height, t.anchor, t.is_upright) for t in drawing.labels})
    for kind in kinds:
        own = [t for t in drawing.labels if (t.layer, t.height, t.anchor, t.is_upright) == kind]
        layer, size, anchor, _ = kind
        yield (
            f'<g fill="{LAYERS[layer].colour}" font-size="{size / CAPITAL:.3g}" '
            f'text-anchor="{anchor}">'
        )
        yield from (_text(label, height) for label in own)
        yield "</g>"


def _path(stroke: Stroke, height: float) -> str:
    """Return a path in whole hundredths of a millimetre, each point as seen from the one before."""
    points = np.round(100.0 * (stroke.points * [1.0, -1.0] + [0.0, height])).astype(np.int64)
    steps = np.diff(points, axis=0)
    first = f"M{_number(points[0, 0])} {_number(points[0, 1])}"
    return first + "l" + " ".join(f"{_number(x)} {_number(y)}" for x, y in steps)


def _number(hundredths: int) -> str:
    return f"{hundredths / 100.0:.10g}"


def _text(label: Label, height: float) -> str:
    x, y = label.x, height - label.y
    text = escape(label.text, quote=False)
    if label.is_upright:
        return f'<text transform="translate({x:.2f} {y:.2f})rotate(-90)">{text}</text>'
    return f'<text x="{x:.2f}" y="{y:.2f}">{text}</text>'


def _image(image: Image, height: float) -> str:
    x, y, width, high = image.box
    return (
        f'<image href="{escape(image.uri)}" x="{x:g}" y="{height - y - high:g}" '
        f'width="{width:g}" height="{high:g}"/>'
    )
