"""Lateral position of a wire under wind in a curve, and the longest span that keeps it on the head.

A wire of tension T between supports with stagger b1 and b2, positive towards the *outside* of the
curve, runs at the distance ::

    y(x) = w x (L - x) / 2T - s (b1 + (b2 - b1) x / L),    w = q + s T / R

from the track axis, measured in the direction of the wind; s is +1 for wind towards the inside and
-1 towards the outside, q the wind load per length. Its largest value is::

    y_max = w L**2 / 8T - s (b1 + b2) / 2 + T (b2 - b1)**2 / (2 w L**2)

where the extreme lies inside the span, ``|b2 - b1| <= w L**2 / 2T``; else it is the larger of the
staggers. Solved for the span at ``y_max = e`` this is the formula of the Norwegian design program
(staspika/python-klmast 2019, after Jernbaneverket's handbook), with c and d as coded below::

    L**2 = (2T / w) (c + sqrt(c**2 - d**2)),   c = 2e + s (b1 + b2),   d = b1 - b2

On straight track the outside is the side on which stagger counts positive.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

Side = Literal["inside", "outside"]
Governs = Literal["wind to the inside", "wind to the outside", "stagger", "radial pull", "limit"]

SIDES: tuple[Side, Side] = ("inside", "outside")


@dataclass(frozen=True)
class Blown:
    """A wire in a curve under wind.

    Attributes
    ----------
    tension : float N
        Of the contact wire, or of both wires together where both swing as one.
    load : float N/m
        Of the wind on what the tension carries.
    radius : float m
        Infinite on straight track.
    stagger : (float, float) m
        At the supports on the left and on the right, positive to the outside of the curve.
    """

    tension: float
    load: float
    radius: float
    stagger: tuple[float, float]

    def lateral_load(self, side: Side) -> float:
        """Return ``q + T/R`` for wind to the inside, ``q - T/R`` to the outside [N/m]."""
        return self.load + _sign(side) * self.tension / self.radius


def _sign(side: Side) -> float:
    return 1.0 if side == "inside" else -1.0


def lateral_position(wire: Blown, span: float, side: Side) -> float:
    """Return the largest distance of the wire from the track axis towards one side [m].

    Parameters
    ----------
    wire
    span : float m
    side
        The side to which the wind blows.

    Returns
    -------
    float
        Negative when the wire stays on the other side of the axis.
    """
    sign, load = _sign(side), wire.lateral_load(side)
    b1, b2 = wire.stagger
    at_supports = max(-sign * b1, -sign * b2)
    reach = load * span**2 / wire.tension  # eight times the sag of the bow
    if reach <= 2.0 * abs(b2 - b1):
        return at_supports
    return reach / 8.0 - sign * 0.5 * (b1 + b2) + (b2 - b1) ** 2 / (2.0 * reach)


def span_within(wire: Blown, permissible: float, side: Side) -> float:
    """Return the span at which the wire just reaches the permissible position on one side [m].

    Parameters
    ----------
    wire
    permissible : float m
    side
        The side to which the wind blows.

    Returns
    -------
    float
        0 when the stagger at a support is already beyond, infinite when the wire never gets there.
    """
    sign, load = _sign(side), wire.lateral_load(side)
    b1, b2 = wire.stagger
    c, d = 2.0 * permissible + sign * (b1 + b2), b1 - b2
    if c < abs(d):  # the stagger at a support is already beyond it
        return 0.0
    if load <= 0.0:
        return math.inf
    return math.sqrt(2.0 * wire.tension / load * (c + math.sqrt(c * c - d * d)))


@dataclass(frozen=True)
class LongestSpan:
    """The longest span and what decides it.

    Attributes
    ----------
    length : float m
        0 when already the stagger exceeds what is permissible; infinite when nothing limits it.
    governs : str
    """

    length: float
    governs: Governs


def longest_span(
    wire: Blown,
    permissible: float,
    *,
    largest_pull: float = math.inf,
    limit: float = math.inf,
    pulling: float | None = None,
) -> LongestSpan:
    """Return the longest span whose wire stays within the permissible lateral position.

    Parameters
    ----------
    wire
    permissible : float m
        Largest distance of the contact wire from the track axis.
    largest_pull : float N
        Radial pull of the curve that the registration bears.
    limit : float m
        Span that must not be exceeded for other reasons.
    pulling : float N, optional
        Tension of all contact wires at one registration; that of the wire by default.
    """
    answers = [LongestSpan(span_within(wire, permissible, side), _wind_to(side)) for side in SIDES]
    if any(answer.length == 0.0 for answer in answers):
        return LongestSpan(0.0, "stagger")
    sine = largest_pull / (2.0 * (pulling or wire.tension))  # of L / 2R
    if sine < 1.0 and math.isfinite(wire.radius):
        answers.append(LongestSpan(2.0 * wire.radius * math.asin(sine), "radial pull"))
    answers.append(LongestSpan(limit, "limit"))
    return min(answers, key=lambda answer: answer.length)


def _wind_to(side: Side) -> Governs:
    return "wind to the inside" if side == "inside" else "wind to the outside"
