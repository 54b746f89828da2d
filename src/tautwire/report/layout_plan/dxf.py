"""A drawing as DXF, in metres along the track."""

from __future__ import annotations

import io
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np

from tautwire.errors import not_installed
from tautwire.report.layout_plan.items import LAYERS, Drawing, Label

if TYPE_CHECKING:
    from ezdxf.layouts.layout import Modelspace

_METRES = 6
"""$INSUNITS of a drawing in metres (DXF reference)."""
_DIGITS = 3
"""Decimals of a coordinate [m]: a millimetre, the accuracy of what the plan says in figures."""


def require_dxf() -> None:
    """Refuse to begin work for a DXF that cannot be written.

    Raises
    ------
    InputError
        When the package is missing.
    """
    if find_spec("ezdxf") is None:
        raise not_installed("ezdxf", "dxf")


def dxf_of(drawing: Drawing, scale: int) -> str:
    """Return a drawing as DXF (AutoCAD 2010).

    A unit is a metre along the track, so that the plot scale is that along the track and all else
    keeps its size on the paper.

    Parameters
    ----------
    drawing
        In millimetres on the paper.
    scale
        Scale number along the track.

    Raises
    ------
    InputError
        When the package is missing.
    """
    require_dxf()
    from ezdxf.filemanagement import new

    document = new("R2010", units=_METRES)
    document.header["$LTSCALE"] = 1.0
    metre = 1e-3 * scale
    for layer in LAYERS.values():
        entry = document.layers.add(layer.name)
        entry.color = layer.index
        entry.dxf.lineweight = round(100.0 * layer.width)
        if layer.dashes:
            signs = [metre * part * (-1) ** number for number, part in enumerate(layer.dashes)]
            document.linetypes.add(layer.name, pattern=[metre * sum(layer.dashes), *signs])
            entry.dxf.linetype = layer.name
    space = document.modelspace()
    order = {name: number for number, name in enumerate(LAYERS)}
    for stroke in sorted(drawing.strokes, key=lambda one: order[one.layer]):
        points = np.round(metre * stroke.points, _DIGITS).tolist()
        look = {"layer": stroke.layer}
        if len(points) == 2:
            space.add_line(*points, dxfattribs=look)
        else:
            space.add_lwpolyline(points, dxfattribs=look)
    for label in drawing.labels:
        _text(space, label, metre)
    with io.StringIO() as out:
        document.write(out)
        return _terse(out.getvalue())


def _terse(text: str) -> str:
    """Return a DXF without what readers take for granted, a quarter of the file.

    The padding of group codes, and of the entities the height 0 of points, the decimals of whole
    numbers and that they belong to the model space.
    """
    lines = text.split("\n")
    codes, values = [code.strip() for code in lines[::2]], lines[1::2]
    pairs = list(zip(codes, values, strict=False))
    begin = pairs.index(("2", "ENTITIES"))
    end = pairs.index(("0", "ENDSEC"), begin)
    entities = [
        (code, value.removesuffix(".0") if len(code) == 2 and code[0] in "1245" else value)
        for code, value in pairs[begin:end]
        if code != "330" and (code, value) not in (("30", "0.0"), ("31", "0.0"))
    ]
    told = [*pairs[:begin], *entities, *pairs[end:]]
    return "\n".join(f"{code}\n{value}" for code, value in told) + "\n"


def _text(space: Modelspace, label: Label, metre: float) -> None:
    from ezdxf.enums import TextEntityAlignment as Place

    places = {"middle": Place.CENTER, "end": Place.RIGHT}
    x, y = (round(metre * value, _DIGITS) for value in (label.x, label.y))
    look = {"layer": label.layer, "rotation": 90.0} if label.is_upright else {"layer": label.layer}
    text = label.text.replace("%%", "% %").replace("^", "^ ")  # they begin control codes
    entity = space.add_text(text, height=round(metre * label.height, _DIGITS), dxfattribs=look)
    if label.anchor == "start":
        entity.dxf.insert = (x, y)  # a second point, which only the others need, is left out
    else:
        entity.set_placement((x, y), align=places[label.anchor])
