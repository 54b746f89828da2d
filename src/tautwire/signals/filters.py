"""Low-pass filters without phase shift, as small frozen strategy objects.

A filter is applied to the whole record; the analysed section is cut out afterwards. Both filters
extend the record at its ends by mirroring it (even extension), so a constant passes unchanged and
no jump arises at the ends.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

STANDARD_CUTOFF = 20.0
"""Cut-off of force statistics [Hz] (EN 50317, seen in Song et al. 2021)."""


@runtime_checkable
class Lowpass(Protocol):
    """What every low-pass filter offers."""

    kind: ClassVar[str]

    @property
    def cutoff(self) -> float:
        """Cut-off frequency [Hz]."""
        ...

    def apply(self, signal: ArrayLike, time_step: float) -> Array:
        """Filter a record.

        Parameters
        ----------
        signal : (n_time, ...)
            Uniformly sampled record; axis 0 is time.
        time_step : float s
            Sampling interval.

        Returns
        -------
        (n_time, ...) array

        Raises
        ------
        ValueError
            When the cut-off is not below the Nyquist frequency.
        """
        ...

    def with_cutoff(self, cutoff: float) -> Lowpass:
        """Return the same filter with another cut-off [Hz]."""
        ...

    def describe(self) -> str:
        """Name the filter with every number that decides its output."""
        ...


@dataclass(frozen=True)
class SharpLowpass:
    """Brick-wall low-pass: keep ``|f| <= cutoff``, remove everything above.

    The record is mirrored at its ends and the Fourier coefficients of the mirrored record above
    the cut-off are set to zero. This is computed with the discrete cosine transform (type II),
    the Fourier transform of the mirrored record, whose lines lie at ``k / (2 n dt)``. The filter
    is an orthogonal projection: bands add up to the signal and their energies to its energy.

    Parameters
    ----------
    cutoff : float Hz
        Highest frequency that is kept.
    """

    cutoff: float = STANDARD_CUTOFF
    kind: ClassVar[str] = "sharp"

    def __post_init__(self) -> None:
        _require_positive_cutoff(self.cutoff)

    def apply(self, signal: ArrayLike, time_step: float) -> Array:
        """Filter a record: see :meth:`Lowpass.apply`."""
        from scipy.fft import dct, idct

        record = _checked_record(signal, time_step, self.cutoff)
        last_line = self.cutoff * 2.0 * record.shape[0] * time_step
        kept = math.floor(last_line * (1.0 + 1e-12)) + 1
        spectrum = np.asarray(dct(record, type=2, axis=0, norm="ortho"))
        spectrum[kept:] = 0.0
        return np.asarray(idct(spectrum, type=2, axis=0, norm="ortho"), dtype=np.float64)

    def with_cutoff(self, cutoff: float) -> SharpLowpass:
        """Return the sharp filter with another cut-off [Hz]."""
        return replace(self, cutoff=cutoff)

    def describe(self) -> str:
        """Name the filter with every number that decides its output."""
        return (
            f"sharp low-pass, cut-off {self.cutoff:g} Hz (Fourier brick wall over the whole "
            "record, ends mirrored; bands are exact)"
        )


@dataclass(frozen=True)
class Butterworth:
    """Butterworth low-pass run forward and backward (zero phase).

    The amplitude is ``1 / (1 + (f / cutoff)**(2 order))``: two passes, so the gain at the cut-off
    is 1/2. The cut-off is not corrected for the second pass. The record is extended at both ends
    by mirroring ``order / (cutoff dt)`` samples, or as many as there are.

    Parameters
    ----------
    order : int
        Order of one pass, 1 to 12 (6 in EN 50317:2012, from a secondary source).
    cutoff : float Hz
        Cut-off of one pass (-3 dB).
    """

    order: int = 6
    cutoff: float = STANDARD_CUTOFF
    kind: ClassVar[str] = "butterworth"

    def __post_init__(self) -> None:
        _require_positive_cutoff(self.cutoff)
        if not 1 <= self.order <= 12 or int(self.order) != self.order:
            raise ValueError(
                f"the Butterworth order must be a whole number from 1 to 12, got {self.order!r}"
            )

    def apply(self, signal: ArrayLike, time_step: float) -> Array:
        """Filter a record: see :meth:`Lowpass.apply`."""
        record = _checked_record(signal, time_step, self.cutoff)
        count = record.shape[0]
        extension = min(count - 1, math.ceil(self.order / (self.cutoff * time_step)))
        columns = record.reshape(count, -1)
        mirrored = np.concatenate(
            [columns[extension:0:-1], columns, columns[-2 : -extension - 2 : -1]]
        )
        sections = self._sections(time_step)
        forward = _passed(sections, mirrored)
        backward = _passed(sections, forward[::-1])[::-1]
        return backward[extension : extension + count].reshape(record.shape)

    def _sections(self, time_step: float) -> list[tuple[Array, Array]]:
        """Return numerator and denominator of the sections of first and second order in z^-1.

        Bilinear transform of the analogue sections with the cut-off prewarped.
        """
        k = math.tan(math.pi * self.cutoff * time_step)
        sections = []
        for number in range(self.order // 2):
            damping = 2.0 * math.sin((2 * number + 1) * math.pi / (2 * self.order))
            norm = 1.0 + k * damping + k * k
            below = [1.0, 2.0 * (k * k - 1.0) / norm, (1.0 - k * damping + k * k) / norm]
            sections.append((k * k / norm * np.array([1.0, 2.0, 1.0]), np.array(below)))
        if self.order % 2:
            below = [1.0, (k - 1.0) / (k + 1.0)]
            sections.append((k / (k + 1.0) * np.ones(2), np.array(below)))
        return sections

    def with_cutoff(self, cutoff: float) -> Butterworth:
        """Return the filter of the same order with another cut-off [Hz]."""
        return replace(self, cutoff=cutoff)

    def describe(self) -> str:
        """Name the filter with every number that decides its output."""
        return (
            f"Butterworth low-pass, order {self.order} forward and backward, cut-off "
            f"{self.cutoff:g} Hz not corrected (ends mirrored; bands as differences of low-passes)"
        )


def is_uniform(time: ArrayLike, tolerance: float = 1e-6) -> bool:
    """Say whether the instants are evenly spaced within `tolerance` of the mean step.

    Parameters
    ----------
    time : (n_time,) s
    tolerance : float
        Largest deviation of a step, as a fraction of the mean step.
    """
    steps = np.diff(np.asarray(time, dtype=np.float64))
    if steps.size == 0:
        return True
    mean = float(steps.mean())
    return mean > 0.0 and bool(np.all(np.abs(steps - mean) <= tolerance * mean))


def resample_uniform(
    time: ArrayLike, signals: ArrayLike, time_step: float | None = None
) -> tuple[Array, Array]:
    """Resample a record on evenly spaced instants by linear interpolation.

    Parameters
    ----------
    time : (n_time,) s
        Increasing instants.
    signals : (n_time,) or (n_time, n_signal)
    time_step : float s, optional
        New sampling interval; by default the longest that divides the record evenly and is not
        longer than its smallest step.

    Returns
    -------
    time : (n_new,) s
    signals : (n_new,) or (n_new, n_signal)

    Raises
    ------
    ValueError
        When the instants do not increase.
    """
    instants = np.asarray(time, dtype=np.float64)
    values = np.asarray(signals, dtype=np.float64)
    steps = np.diff(instants)
    if instants.size < 2 or not np.all(steps > 0.0):
        raise ValueError("a record to be resampled needs at least two increasing instants")
    length = float(instants[-1] - instants[0])
    if time_step is None:
        count = math.ceil(length / float(steps.min()) - 1e-6)
        grid = np.linspace(instants[0], instants[-1], count + 1)
    else:
        grid = instants[0] + time_step * np.arange(math.floor(length / time_step + 1e-9) + 1)
    columns: Any = values if values.ndim == 2 else values[:, None]
    resampled = np.column_stack([np.interp(grid, instants, column) for column in columns.T])
    return grid, resampled if values.ndim == 2 else resampled[:, 0]


def evenly_spaced(time: ArrayLike, signals: ArrayLike, time_step: float) -> tuple[Array, Array]:
    """Return a record as it is when its steps are even, else resampled at `time_step`.

    Parameters
    ----------
    time : (n_time,) s
        Increasing instants.
    signals : (n_time,) or (n_time, n_signal)
    time_step : float s
        Sampling interval of a record with uneven steps.

    Returns
    -------
    time : (n_new,) s
    signals : (n_new,) or (n_new, n_signal)
    """
    if is_uniform(time):
        return np.asarray(time, dtype=np.float64), np.asarray(signals, dtype=np.float64)
    return resample_uniform(time, signals, time_step)


def _require_positive_cutoff(cutoff: float) -> None:
    if not (math.isfinite(cutoff) and cutoff > 0.0):
        raise ValueError(f"the cut-off must be a positive frequency in Hz, got {cutoff!r}")


def _passed(sections: list[tuple[Array, Array]], record: Array) -> Array:
    """Run a record ``(n_time, n)`` through sections that have always seen its first value.

    A section is a lower triangular banded system: LAPACK solves it as fast as a filter of its own,
    whose library would take as long to import as a report to write.
    """
    from scipy.linalg.lapack import dtbtrs  # pyright: ignore[reportAttributeAccessIssue]

    first = record[:1]
    out = record - first
    for above, below in sections:
        past = np.concatenate([np.zeros((len(above) - 1, out.shape[1])), out])
        driven = sum(
            b * past[len(above) - 1 - lag : len(past) - lag] for lag, b in enumerate(above)
        )
        band = np.repeat(below[:, None], len(out), axis=1)
        out, info = dtbtrs(band, driven, uplo="L", diag="U")
        if info:
            raise ValueError(f"a filter section was refused (LAPACK info {info})")
    return out + first


def _checked_record(signal: ArrayLike, time_step: float, cutoff: float) -> Array:
    record = np.asarray(signal, dtype=np.float64)
    if not (math.isfinite(time_step) and time_step > 0.0):
        raise ValueError(f"the sampling interval must be positive, got {time_step!r} s")
    if record.ndim == 0 or record.shape[0] < 2:
        raise ValueError("a record to be filtered needs at least two samples")
    nyquist = 0.5 / time_step
    if cutoff >= nyquist:
        raise ValueError(
            f"cut-off {cutoff:g} Hz is not below the Nyquist frequency {nyquist:g} Hz of a "
            f"record sampled every {1e3 * time_step:g} ms: lower the cut-off or sample faster"
        )
    return record
