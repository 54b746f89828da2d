"""The pictures of the documentation, made by the program itself: ``make pictures``."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from sketches import SKETCHES

import tautwire as tw
from tautwire.analyses.vibration.modes import modes
from tautwire.report.figures.design_figures import elasticity_figure
from tautwire.report.figures.mode_figures import mode_figure
from tautwire.report.writers.drawing.figure import figure_svg

FOLDER = Path(__file__).parents[1] / "pictures"
WIDTH = 170.0
"""Of the figures [mm]."""
LINE = {"line.spans": 10, "settings.section": [4, 7], "settings.band": "50 Hz"}
"""The reference line, short and with a coarse mesh: pictures show the kind, reports the numbers."""


def figures() -> Iterator[tuple[str, str]]:
    """Yield name and data of the figures, as reports draw them."""
    run = tw.run(tw.load_case("ac-simple", LINE))
    for name in ("force", "line", "spectrum"):
        yield name, str(getattr(run.plot, name)().to_json())
    model, shape = tw.build(run.case), run.equilibrium
    given = [("", tw.elasticity(model, shape, force=100.0))]
    yield "elasticity", elasticity_figure(given, run.case.line, shape).to_json()
    first = modes(model, shape)
    vertical = int(first.ranked()[0])
    yield (
        "mode",
        mode_figure(first, vertical, shape.mast_x, run.case.line.support_marks()).to_json(),
    )


def main() -> None:
    """Write all pictures."""
    for name, draw in SKETCHES.items():
        (FOLDER / f"{name}.svg").write_text(draw().svg(), encoding="utf-8")
    for name, data in figures():
        (FOLDER / f"{name}.svg").write_bytes(figure_svg(data, WIDTH))


if __name__ == "__main__":
    main()
