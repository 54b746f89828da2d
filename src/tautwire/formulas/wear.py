"""A contact wire worn from below: what is left of a round section above a chord.

Symbols: phi half the angle of the chord, in units of the radius; the part below it is gone::

    worn share = (phi - sin phi cos phi) / pi
"""

from __future__ import annotations

import math

_BISECTIONS = 60
"""Halvings of an angle after which it is exact to rounding."""


def chord_angle(worn: float) -> float:
    """Return half the angle of the chord above which a share of the section is left [rad].

    Parameters
    ----------
    worn : float
        Share of the section that is gone, 0 to 1.
    """
    low, high = 0.0, math.pi
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        if middle - math.sin(middle) * math.cos(middle) < worn * math.pi:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def height_left(worn: float) -> float:
    """Return the height of the worn section in diameters."""
    return 0.5 * (1.0 + math.cos(chord_angle(worn)))


def bending_left(worn: float) -> float:
    """Return the share of the bending stiffness that is left against vertical bending.

    The second moment of what is left, about its own horizontal axis, over ``pi / 4``::

        I = pi/4 - (phi/4 - sin(4 phi)/16) - (2/3 sin(phi)**3)**2 / A,   A = pi (1 - worn)

    Parameters
    ----------
    worn : float
        Share of the section that is gone.
    """
    phi = chord_angle(worn)
    gone = phi / 4.0 - math.sin(4.0 * phi) / 16.0
    moment = 2.0 / 3.0 * math.sin(phi) ** 3
    left = math.pi / 4.0 - gone - moment**2 / (math.pi * (1.0 - worn))
    return left / (math.pi / 4.0)
