"""A page as HTML: the template with its scripts, filled."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Iterable, Sequence
from importlib.resources import files
from importlib.resources.abc import Traversable
from itertools import count
from typing import Any

from tautwire.report.parts.blocks import Animation, Chart, Pair, Section

LIBRARIES = {
    "basic": frozenset({"bar", "pie", "scatter"}),
    "cartesian": frozenset(
        {
            "bar", "box", "contour", "heatmap", "histogram", "histogram2d", "histogram2dcontour",
            "image", "pie", "scatter", "scatterternary", "violin",
        }
    ),
}  # fmt: skip
"""Bundles of plotly.js beside the templates, the smaller first, with the kinds of traces that they
draw. The whole library has four times the size of the first, for maps, volumes and surfaces."""


def render(contents: Sequence[Section], masthead: dict[str, Any]) -> str:
    """Return a whole page: the template with its scripts, filled.

    Parameters
    ----------
    contents : sequence of Section
    masthead : dict
        Heading, description and key facts.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("tautwire.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    own = {
        name: _templates().joinpath(name).read_text(encoding="utf-8")
        for name in ("style.css", "figures.js", "animation.js")
    }
    blocks = [block for part in contents for block in part.blocks]
    charts = [block for block in blocks if isinstance(block, Chart)]
    charts += [
        chart for pair in blocks if isinstance(pair, Pair) for chart in (pair.left, pair.right)
    ]
    scripts = []
    if charts:
        scripts += [chart_library(charts), own["figures.js"]]
    if any(isinstance(block, Animation) for block in blocks):
        scripts.append(own["animation.js"])
    return environment.get_template("page.html.j2").render(
        sections=contents,
        style=own["style.css"],
        scripts=scripts,
        script_hashes=[script_hash(script) for script in scripts],
        figure_number=count(1).__next__,
        **{"project": None, **masthead},
    )


def chart_library(charts: Iterable[Chart]) -> str:
    """Return the script that draws charts: the smallest bundle that has their kinds of traces."""
    kinds = {trace["type"] for chart in charts for trace in json.loads(chart.json)["data"]}
    bundle = next(name for name, traces in LIBRARIES.items() if kinds <= traces)
    return without_addresses(library_file(bundle).read_text(encoding="utf-8"))


def library_file(bundle: str) -> Traversable:
    """Return the file of a bundle of plotly.js, its licence beside it."""
    return _templates().joinpath("plotly", f"plotly-{bundle}.min.js")


def _templates() -> Traversable:
    return files("tautwire.report").joinpath("templates")


def script_hash(script: str) -> str:
    """Return the source expression that allows one script: CSP Level 3, section 2.3.1.

    A browser runs the scripts of the page that have a hash in its policy and no others, so that a
    text which slipped through as HTML stays without effect.
    """
    digest = hashlib.sha256(script.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"


def without_addresses(script: str) -> str:
    """Empty the web addresses in the strings of a script.

    The chart library carries addresses of map servers and services that no chart of the report
    uses. The page's security policy forbids to reach them; with the addresses gone, nothing on
    the page refers to another machine. Names of XML vocabularies, which are not addresses to be
    reached, and licence texts in comments stay. Line ends become those that a browser hashes.
    """
    quoted = re.sub(r"(?<=[\"'`])https?://(?!www\.w3\.org/)", "offline:", script)
    return quoted.replace("</script", "<\\/script").replace("\r\n", "\n").replace("\r", "\n")
