"""The order in which the commands are listed: that in which somebody with a line needs them."""

from __future__ import annotations

import typer

PANELS = {
    "Describe a line": ("new", "cases", "catalogue", "spans", "limits", "check"),
    "Compute it": ("static", "draw", "run", "report", "losses"),
    "Compute many": ("study", "modes", "advise"),
    "Compare with what was measured": ("measured", "compare", "as-built", "rank"),
    "For reference": ("reproduce", "schema"),
}
"""Commands by what they are for; one that is not named stands at the end."""


def in_order_of_work(app: typer.Typer) -> None:
    """Sort the commands of a command line, and give each its panel of the help.

    Parameters
    ----------
    app
    """
    places = {
        name: (place, panel)
        for place, (panel, name) in enumerate((p, n) for p, names in PANELS.items() for n in names)
    }
    last = (len(places), "Others")

    def named(info: typer.models.CommandInfo) -> tuple[int, str]:
        name = info.name or getattr(info.callback, "__name__", "")
        return places.get(name, last)

    app.registered_commands.sort(key=lambda info: named(info)[0])
    for info in app.registered_commands:
        info.rich_help_panel = named(info)[1]
