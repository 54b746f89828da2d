"""Frequency bands of a signal as differences of low-passes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tautwire.signals.filters import Lowpass

Array = NDArray[np.float64]
Band = tuple[float, float]

BANDS: tuple[Band, ...] = (
    (0.0, 2.0),
    (0.0, 5.0),
    (5.0, 20.0),
    (0.0, 20.0),
    (0.0, 50.0),
    (0.0, 100.0),
    (0.0, 200.0),
)
"""Bands [Hz] of the world benchmark (2015) and of Song et al. (2021)."""

WIDEST = BANDS[-1][1]
"""Upper end of the widest band that is reported [Hz]."""


def band_name(band: Band) -> str:
    """Return the key of a band, ``"5_20"`` for 5 to 20 Hz.

    Examples
    --------
    >>> band_name((5.0, 20.0))
    '5_20'
    """
    return f"{band[0]:g}_{band[1]:g}"


def band_signal(
    lowpass: Lowpass, signal: ArrayLike, time_step: float, low: float, high: float
) -> Array:
    """Return the part of a signal in a band: low-passed at `high` minus low-passed at `low`.

    With the sharp filter this is exactly the part with ``low < f <= high``; a band that starts at
    0 contains the mean.

    Parameters
    ----------
    lowpass : Lowpass
        Family and order of the filter; its own cut-off is not used.
    signal : (n_time, ...)
    time_step : float s
    low, high : float Hz

    Returns
    -------
    (n_time, ...) array
    """
    upper = lowpass.with_cutoff(high).apply(signal, time_step)
    if low <= 0.0:
        return upper
    return upper - lowpass.with_cutoff(low).apply(signal, time_step)


def band_standard_deviations(
    lowpass: Lowpass,
    signal: ArrayLike,
    time_step: float,
    inside: NDArray[np.bool_],
    bands: Sequence[Band] = BANDS,
) -> dict[str, float]:
    """Compute the standard deviation of a signal per band over part of the record.

    The whole record is filtered, then the samples marked by `inside` are taken. The divisor is
    the number of samples (ddof 0).

    Parameters
    ----------
    lowpass : Lowpass
        Family and order of the filter; its own cut-off is not used.
    signal : (n_time,)
    time_step : float s
    inside : (n_time,) bool
    bands : sequence of (low, high) Hz

    Returns
    -------
    dict
        Standard deviation by :func:`band_name`; NaN where the band reaches the Nyquist frequency.
    """
    nyquist = 0.5 / time_step
    usable = [band for band in bands if band[1] < nyquist]
    edges = sorted({edge for band in usable for edge in band if edge > 0.0})
    parts = {e: lowpass.with_cutoff(e).apply(signal, time_step)[inside] for e in edges}
    deviations = {band_name(band): float("nan") for band in bands}
    for low, high in usable:
        part = parts[high] - parts[low] if low > 0.0 else parts[high]
        deviations[band_name((low, high))] = float(np.std(part)) if part.size else float("nan")
    return deviations
