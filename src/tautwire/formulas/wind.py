"""Wind on wires: from the speed of the air to the load per length."""

from __future__ import annotations

AIR_DENSITY = 1.25
"""Air density at sea level and about 9 degC [kg/m3], the value of EN 1991-1-4 (from memory)."""


def dynamic_pressure(speed: float, density: float = AIR_DENSITY) -> float:
    """Return the pressure of the wind, ``q = rho v**2 / 2`` [N/m2].

    Parameters
    ----------
    speed : float m/s
    density : float kg/m3
    """
    return 0.5 * density * speed**2


def wind_load(pressure: float, diameter: float, drag: float = 1.0, shelter: float = 1.0) -> float:
    """Return the load per length of a wire across the wind, ``w = q c d s`` [N/m].

    Parameters
    ----------
    pressure : float N/m2
        Of the wind, gusts included.
    diameter : float m
        Of the wire, ice and wear included.
    drag : float
        Force coefficient of the wire, times a gust or height factor where a rule has one.
    shelter : float
        Share of the wind that reaches the wire.
    """
    return pressure * drag * diameter * shelter
