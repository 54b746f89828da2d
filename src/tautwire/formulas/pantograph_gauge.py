"""How far the contact wire may stand off the track axis for a pantograph head of given width.

The calculation subtracts from the half width of the head that may carry the wire everything that
moves the head sideways (terms of EN 50367:2012, 5.2.5.3, as programmed in staspika/python-klmast,
2019)::

    e = b - [c0 + c1 (h - h0)] - c2 / R - c3 - c4 max(0, D - D0) (h - hc)
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class GaugeTerms:
    """Constants of the calculation.

    Attributes
    ----------
    sway : float m
        c0, sideways play of the head at the reference height.
    sway_per_height, sway_height : float 1, m
        c1 and h0: how the play grows with height.
    curve : float m2
        c2, geometric overthrow times radius.
    tolerance : float m
        c3, of track and contact line.
    roll : float 1/m
        c4, quasi-static roll per cant (or deficiency) and height.
    roll_free, roll_centre : float m
        D0, cant that causes no extra roll; hc, height of the roll centre.
    """

    sway: float
    sway_per_height: float
    sway_height: float
    curve: float
    tolerance: float
    roll: float
    roll_free: float
    roll_centre: float


def permissible_lateral_position(
    half_width: float, height: float, radius: float, cant: float, terms: GaugeTerms
) -> float:
    """Return the permissible distance of the contact wire from the track axis [m].

    Parameters
    ----------
    half_width : float m
        Half the part of the head on which the wire may run.
    height : float m
        Of the contact wire above the rails.
    radius : float m
        Infinite on straight track.
    cant : float m
        Cant or cant deficiency, the larger.
    terms
    """
    sway = terms.sway + terms.sway_per_height * (height - terms.sway_height)
    roll = terms.roll * max(0.0, cant - terms.roll_free) * (height - terms.roll_centre)
    return half_width - sway - terms.curve / radius - terms.tolerance - roll
