"""A taut wire in a curve: what it pulls, and where it runs between its supports.

Symbols: T tension [N], L span [m], R radius of the curve [m], infinite on straight track.
"""

from __future__ import annotations

import math


def radial_pull(tension: float, span: float, radius: float) -> float:
    """Return the pull towards the inside of the curve on a support, ``2 T sin(L / 2R)`` [N].

    Parameters
    ----------
    tension : float N
    span : float m
        Distance of the neighbouring supports along the track (mean of both sides).
    radius : float m
    """
    return 2.0 * tension * math.sin(span / (2.0 * radius))


def stagger_pull(
    tension: float, stagger: tuple[float, float, float], spans: tuple[float, float]
) -> float:
    """Return the lateral pull that the stagger adds, towards smaller stagger values [N].

    ``T ((b1 - b0) / L_left + (b1 - b2) / L_right)``

    Parameters
    ----------
    tension : float N
    stagger : (float, float, float) m
        At the support on the left, at this one, and on the right.
    spans : (float, float) m
        On the left and on the right.
    """
    before, here, after = stagger
    return tension * ((here - before) / spans[0] + (here - after) / spans[1])


def chord_offset(span: float, radius: float) -> float:
    """Return how far inside the track axis a chord runs at mid-span, ``L**2 / 8R`` [m].

    Parameters
    ----------
    span, radius : float m
    """
    return span**2 / (8.0 * radius)
