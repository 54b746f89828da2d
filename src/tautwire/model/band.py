"""Highest frequency that the elements of a wire carry.

A head that moves at v along a wire under the tension T, with the mass m per length and the bending
stiffness EI, meets waves of the frequency f with the wave numbers k of

    T k^2 + EI k^4 = m (2 pi f + v k)^2,

of which the largest belongs to the wave ahead of it. Two elements to this wave carry it: with
slopes at their nodes they make it at most a tenth too fast. Wires that no head touches are taken
at rest.
"""

from __future__ import annotations

import math

import numpy as np

from tautwire.line.pieces import Run
from tautwire.specs.line.wire import Wire

ELEMENTS_PER_WAVE = 2.0
"""Chosen: a pinned beam of one element for half a wave vibrates 11 % too fast, a string 0.7 %, and
halving the elements moves no standard deviation of the lines in the table of the page on theory
(section 3) by more than is told there."""
SHORTEST_CHOSEN = 0.1
"""Shortest element that is chosen for a band [m]: below it point loads bend the wire more than they
kink it, and close to the wave speed the waves ahead grow short without limit."""


def wave_length(wire: Wire, frequency: float, speed: float) -> float:
    """Return the length of the wave ahead of a head that meets it with a frequency [m].

    Parameters
    ----------
    wire
    frequency
        [Hz]
    speed
        Of the head, below the wave speed [m/s].
    """
    circular, mass = 2.0 * math.pi * frequency, wire.mass
    equation = (
        wire.bending_stiffness,
        0.0,
        wire.tension - mass * speed**2,
        -2.0 * mass * circular * speed,
        -mass * circular**2,
    )
    roots = np.roots(equation)
    number = max(root.real for root in roots if abs(root.imag) <= 1e-6 * abs(root))
    return 2.0 * math.pi / float(number)


def frequency_of(wire: Wire, length: float, speed: float) -> float:
    """Return the frequency with which a head meets a wave ahead of it [Hz]; see `wave_length`."""
    number = 2.0 * math.pi / length
    own = number * math.sqrt((wire.tension + wire.bending_stiffness * number**2) / wire.mass)
    return (own - speed * number) / (2.0 * math.pi)


def carried_by(run: Run, element: float, speed: float) -> float:
    """Return the highest frequency that elements of a length carry on a run [Hz].

    Parameters
    ----------
    run
    element
        [m]
    speed
        Of the train [m/s].
    """
    return frequency_of(run.wire, ELEMENTS_PER_WAVE * element, _speed_on(run, speed))


def longest_element(run: Run, band: float, speed: float) -> float:
    """Return the longest element with which a run carries a band [m].

    Parameters
    ----------
    run
    band
        Highest frequency [Hz].
    speed
        Of the train [m/s].
    """
    length = wave_length(run.wire, band, _speed_on(run, speed)) / ELEMENTS_PER_WAVE
    return max(SHORTEST_CHOSEN, length)


def _speed_on(run: Run, speed: float) -> float:
    return speed if run.role == "contact" else 0.0
