"""What temperature and load do to a tension length.

Symbols: T tension [N], L length [m], EA axial stiffness [N], alpha thermal expansion [1/K], dT
change of temperature [K], w load per length [N/m].
"""

from __future__ import annotations

import math


def thermal_travel(length: float, expansion: float, warming: float) -> float:
    """Return how far the free end of a wire moves away from its fixed point [m].

    ``alpha L dT``, positive when the wire grows (warmer).

    Parameters
    ----------
    length : float m
        From the fixed point to the free end, or to the cantilever that is asked for.
    expansion : float 1/K
    warming : float K
    """
    return expansion * length * warming


def weight_travel(length: float, expansion: float, warming: float, ratio: float) -> float:
    """Return how far the weights of a tensioning wheel sink [m]; negative when they rise.

    Parameters
    ----------
    length : float m
        From the fixed point to the wheel.
    expansion : float 1/K
    warming : float K
    ratio : float
        Travel of the weights per travel of the wire, 5 for a wheel 1:5.
    """
    return ratio * thermal_travel(length, expansion, warming)


def friction_loop(tension: float, efficiency: float) -> float:
    """Return the work that a tensioning device loses per metre there and back [J/m].

    ``T0 (1/eta - eta)``: the wire pulls T0/eta where it lifts the weights and T0 eta where it
    lowers them.

    Parameters
    ----------
    tension : float N
        Without friction.
    efficiency : float
        eta of one direction.
    """
    return tension * (1.0 / efficiency - efficiency)


def tension_at_fixed_point(
    tension: float, distance: float, strain: float, radius: float, arm: float
) -> float:
    """Return the tension that hinged cantilevers in a curve leave at the fixed point [N].

    The cantilevers turn with the wire. At distance s from the fixed point the wire has travelled
    ``alpha s dT``; a support then takes its radial load ``T L / R`` with a component
    ``alpha s dT / d`` along the track. Summed over the supports, with the changed tension acting
    on the next one::

        T_fixed = T_device exp(-alpha dT s**2 / (2 R d))

    Parameters
    ----------
    tension : float N
        At the tensioning device.
    distance : float m
        From the fixed point to the device, s.
    strain : float
        ``alpha dT``, positive when warm.
    radius : float m
        Positive where the cantilevers pull off, negative where they push off.
    arm : float m
        From the hinge of the cantilever to the wire, across the track, d.
    """
    return tension * math.exp(-strain * distance**2 / (2.0 * radius * arm))


def fixed_wire_tension(
    tension: float, span: float, axial_stiffness: float, loads: tuple[float, float], strain: float
) -> float:
    """Return the tension of a wire held at both ends after a change of temperature or load [N].

    State equation of a flat parabola, within 0.1 % of the elastic catenary::

        H**2 (H - H0 + EA (w0 L)**2 / (24 H0**2) + EA alpha dT) = EA (w L)**2 / 24

    Parameters
    ----------
    tension : float N
        H0, before the change.
    span : float m
    axial_stiffness : float N
    loads : (float, float) N/m
        Load per length across the wire before (w0) and after (w) the change.
    strain : float
        ``alpha dT``, positive when warm.
    """
    before, after = ((load * span) ** 2 * axial_stiffness / 24.0 for load in loads)
    shift = before / tension**2 + axial_stiffness * strain - tension
    # H**3 + shift H**2 - after = 0 is convex right of its positive root: Newton comes down to it.
    found = max(-shift, 0.0) + after ** (1.0 / 3.0)
    for _ in range(100):
        step = (found**3 + shift * found**2 - after) / (3.0 * found**2 + 2.0 * shift * found)
        found -= step
        if abs(step) <= 1e-14 * found:  # rounding
            break
    return found
