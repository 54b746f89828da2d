"""Axes of a figure: where they lie, what they show, which series belongs to which."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from tautwire.report.writers.drawing.values import array, colour, is_words, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Layout = Mapping[str, Any]


@dataclass(frozen=True)
class Room:
    """Size of a figure and the rows of its legend; margins follow from them [in]."""

    width: float
    height: float
    legend_rows: int

    LEFT = 0.58  # a title beside tick labels of five signs, of 7 points as all texts
    RIGHT = 0.14  # half of the last tick label
    BOTTOM = 0.40  # tick labels and a title
    UPPER_AXIS = 0.30  # the same above, smaller
    ROW = 0.145  # a line of the legend

    def part(self, x: Sequence[float], y: Sequence[float], *, above: bool, below: bool,
             beside: bool) -> list[float]:  # fmt: skip
        """Return left, bottom, width and height of axes, as shares of the figure.

        Parameters
        ----------
        x, y
            Where the axes lie between the margins, from 0 to 1.
        above, below, beside
            Whether there is an upper axis, are two lines of tick labels, is an axis on the right.
        """
        top = self.ROW * self.legend_rows + 0.10 + (self.UPPER_AXIS if above else 0.0)
        bottom = self.BOTTOM + (0.14 if below else 0.0)
        right = self.RIGHT + (0.5 if beside else 0.0)
        across = self.width - self.LEFT - right
        up = self.height - top - bottom
        return [
            (self.LEFT + x[0] * across) / self.width,
            (bottom + y[0] * up) / self.height,
            (x[1] - x[0]) * across / self.width,
            (y[1] - y[0]) * up / self.height,
        ]


@dataclass
class Found:
    """Axes by the names of their two directions, and places of names along an axis."""

    pairs: dict[tuple[str, str], Axes]
    bases: dict[str, str]
    words: dict[str, list[str]] = field(default_factory=dict)

    def of(self, x: str, y: str) -> Axes:
        """Return the axes of a pair of directions, ``("x", "y9")``."""
        return self.pairs[self.bases.get(x, x), y]

    def any_with(self, name: str) -> Axes:
        """Return axes that have one direction."""
        base = self.bases.get(name, name)
        own = [pair for pair in self.pairs if name in pair] or [p for p in self.pairs if base in p]
        return self.pairs[own[0]]


def spec_of(layout: Layout, name: str) -> Mapping[str, Any]:
    """Return the settings of an axis, ``"x9"``."""
    return layout.get(f"{name[0]}axis{name[1:]}", {})


def names_in(layout: Layout, letter: str) -> list[str]:
    """Return the axes of a direction that the layout has."""
    keys = (re.fullmatch(rf"{letter}axis(\d*)", key) for key in layout)
    return [letter + match[1] for match in keys if match]


def make_axes(
    figure: Figure, traces: Sequence[Mapping[str, Any]], layout: Layout, room: Room
) -> Found:
    """Make the axes that the series of a figure need."""
    wanted = dict.fromkeys((t.get("xaxis", "x"), t.get("yaxis", "y")) for t in traces)
    wanted = wanted or {("x", "y"): None}
    x_names = {x for x, _ in wanted} | set(names_in(layout, "x"))
    bases = {x: str(spec_of(layout, x).get("overlaying", x)) for x in x_names}
    above = any(spec_of(layout, x).get("side") == "top" for x in x_names)
    below = any("<br>" in str(text) for x in x_names
                for text in array(spec_of(layout, x).get("ticktext")))  # fmt: skip
    beside = any(spec_of(layout, y).get("side") == "right" for _, y in wanted)
    found = Found({}, bases)
    pairs = dict.fromkeys((bases[x], y) for x, y in wanted)
    for x, y in sorted(pairs, key=lambda pair: bool(spec_of(layout, pair[1]).get("overlaying"))):
        own = spec_of(layout, y)
        under = own.get("overlaying")
        if under and (x, str(under)) in found.pairs:
            found.pairs[x, y] = found.pairs[x, str(under)].twinx()
            continue
        place = room.part(
            spec_of(layout, x).get("domain", (0, 1)),
            own.get("domain", (0, 1)),
            above=above, below=below, beside=beside,
        )  # fmt: skip
        found.pairs[x, y] = figure.add_axes((place[0], place[1], place[2], place[3]))
    _collect_words(found, traces)
    return found


def _collect_words(found: Found, traces: Sequence[Mapping[str, Any]]) -> None:
    for trace in traces:
        for letter in "xy":
            values = trace.get(letter)
            if is_words(values):
                name = found.bases.get(trace.get(f"{letter}axis", letter), letter)
                known = found.words.setdefault(name, [])
                known += [w for w in dict.fromkeys(map(str, array(values))) if w not in known]


def finish_axes(found: Found, layout: Layout) -> None:
    """Give all axes their ranges, ticks, grids and titles, once the series are drawn."""
    lowest: dict[str, tuple[float, str]] = {}
    for (x, y), axes in found.pairs.items():
        bottom = float(axes.get_position().y0)
        lowest[x] = min(lowest.get(x, (bottom, y)), (bottom, y))
    for (x, y), axes in found.pairs.items():
        _finish(axes, found, layout, "x", x)
        _finish(axes, found, layout, "y", y)
        _spines(axes, is_twin=bool(spec_of(layout, y).get("overlaying")))
        _share_range(axes, found, layout, x)
        if spec_of(layout, x).get("showticklabels") is False:
            axes.tick_params(axis="x", labelbottom=False)
    for name, base in found.bases.items():
        if name != base and spec_of(layout, name).get("side") == "top":
            _add_upper(found, layout, name, base)


def _spines(axes: Axes, *, is_twin: bool) -> None:
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color("#55616e")
        axes.spines[side].set_visible(not is_twin)
    axes.set_axisbelow(True)


def _share_range(axes: Axes, found: Found, layout: Layout, x: str) -> None:
    """Let panels that zoom together show the same part."""
    other = spec_of(layout, x).get("matches")
    if other and not spec_of(layout, x).get("range"):
        source = [own for (name, _), own in found.pairs.items() if name == other]
        limits = spec_of(layout, str(other)).get("range")
        if limits:
            axes.set_xlim(*limits)
        elif source:
            axes.set_xlim(source[0].get_xlim())


def _finish(axes: Axes, found: Found, layout: Layout, letter: str, name: str) -> None:
    own, line = spec_of(layout, name), getattr(axes, f"{letter}axis")
    if own.get("type") == "log":
        getattr(axes, f"set_{letter}scale")("log")
    _set_range(axes, own, letter)
    _set_ticks(axes, own, letter, found.words.get(name))
    title = plain((own.get("title") or {}).get("text", ""))
    getattr(axes, f"set_{letter}label")(title, labelpad=3, color=colour("#16202b"))
    axes.tick_params(axis="x" if letter == "x" else "y", color="#55616e", length=2.5)
    if own.get("visible") is False:
        line.set_visible(False)
    elif own.get("showgrid") is not False and not own.get("overlaying"):
        axes.grid(axis="x" if letter == "x" else "y", color=own.get("gridcolor", "#e6eaee"),
                  linewidth=0.5)  # fmt: skip
    if own.get("side") == "right":
        line.tick_right()
        line.set_label_position("right")
    if own.get("zeroline"):
        line_at = axes.axhline if letter == "y" else axes.axvline
        line_at(0.0, color="#55616e", linewidth=0.5, zorder=1.5)


def _set_range(axes: Axes, own: Mapping[str, Any], letter: str) -> None:
    limits, put = own.get("range"), getattr(axes, f"set_{letter}lim")
    if limits and None not in limits:
        put(*(10.0 ** np.array(limits, dtype=float) if own.get("type") == "log" else limits))
        return
    axes.autoscale(enable=True, axis="x" if letter == "x" else "y")
    low, high = getattr(axes, f"get_{letter}lim")()
    if letter == "x" and axes.get_lines() and not axes.patches:
        axes.margins(x=0.01)
        low, high = axes.get_xlim()
    if own.get("rangemode") == "tozero":
        low, high = min(low, 0.0), max(high, 0.0)
    put(*((high, low) if own.get("autorange") == "reversed" else (low, high)))


def _set_ticks(axes: Axes, own: Mapping[str, Any], letter: str, words: list[str] | None) -> None:
    from matplotlib.ticker import MultipleLocator, NullLocator

    line = getattr(axes, f"{letter}axis")
    if words:
        line.set_ticks(range(len(words)), [plain(word) for word in words])
        if letter == "x" and sum(map(len, words)) > 60:
            axes.tick_params(axis="x", rotation=30)
        return
    places = array(own.get("tickvals"))
    if len(places):
        _set_places(axes, letter, [float(p) for p in places], list(array(own.get("ticktext"))))
    elif own.get("type") != "log" and isinstance(own.get("dtick"), (int, float)):
        low, high = sorted(getattr(axes, f"get_{letter}lim")())
        if 0 < (high - low) / own["dtick"] <= 30:
            line.set_major_locator(MultipleLocator(own["dtick"]))
    line.set_minor_locator(NullLocator())


def _set_places(axes: Axes, letter: str, places: list[float], texts: list[Any]) -> None:
    """Set ticks at places; labels stand only as close as they can be read."""
    low, high = sorted(getattr(axes, f"get_{letter}lim")())
    named = [f"{place:g}" for place in places] if not texts else [plain(text) for text in texts]
    kept = [(p, t) for p, t in zip(places, named, strict=False) if low <= p <= high]
    longest = max((len(part) for _, t in kept for part in t.split("\n")), default=1)
    box = axes.get_window_extent()
    room = (box.width if letter == "x" else box.height) / axes.figure.dpi
    needed = 0.062 * longest + 0.09 if letter == "x" else 0.15  # inches of a label of 7 points
    step = max(1, int(np.ceil(len(kept) * needed / max(room, 0.1))))
    labels = [text if number % step == 0 else "" for number, (_, text) in enumerate(kept)]
    getattr(axes, f"{letter}axis").set_ticks([place for place, _ in kept], labels)


def _add_upper(found: Found, layout: Layout, name: str, base: str) -> None:
    """Add the upper axis of the uppermost panel, and its grid to all panels under it."""
    own = spec_of(layout, name)
    panels = [axes for (x, y), axes in found.pairs.items()
              if x == base and not spec_of(layout, y).get("overlaying")]  # fmt: skip
    if not panels:
        return
    highest = max(panels, key=lambda axes: axes.get_position().y1)
    upper = highest.secondary_xaxis("top")
    upper.spines["top"].set_visible(False)
    places = [float(p) for p in array(own.get("tickvals"))]
    low, high = sorted(highest.get_xlim())
    upper.set_xlim(low, high)
    texts = list(array(own.get("ticktext")))
    inside = [(p, t) for p, t in zip(places, texts, strict=False) if low <= p <= high]
    box = highest.get_window_extent()
    width = box.width / highest.figure.dpi
    labels, last = [], -1.0
    for place, text in inside:
        at = (place - low) / (high - low) * width
        half = 0.031 * len(plain(text)) + 0.03
        labels.append(plain(text) if at - half > last else "")
        last = at + half if labels[-1] else last
    upper.set_xticks([place for place, _ in inside], labels)
    upper.tick_params(length=2, color="#c9d1d9", labelcolor="#55616e", labelsize=6)
    title = plain((own.get("title") or {}).get("text", ""))
    upper.set_xlabel(title, fontsize=6, labelpad=2, color="#55616e")
    if own.get("showgrid"):
        for axes in panels:
            for place, _ in inside:
                axes.axvline(
                    place, color=own.get("gridcolor", "#c9d1d9"), linewidth=0.4, zorder=0.6
                )
