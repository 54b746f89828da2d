"""Long histories made small: thinning that keeps extremes, compressed arrays as text."""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

LIMIT = 24_000
"""Largest number of points of one curve; longer ones are thinned."""
PAGE_LIMIT = 200_000
"""Largest number of points of all curves of a figure."""


def share(curves: int, limit: int = LIMIT) -> int:
    """Return the largest number of points of each of several curves of a figure."""
    return min(limit, PAGE_LIMIT // max(curves, 1))


def thinned(values: NDArray[Any], limit: int = LIMIT) -> NDArray[np.int64]:
    """Choose the samples to draw: all, or the smallest and largest of even pieces.

    A curve drawn through them looks as the full one does at any zoom down to the length of a
    piece, and no extreme is lost.

    Parameters
    ----------
    values : (n,)
    limit : int
        Largest number of samples to keep.

    Returns
    -------
    (m,) array
        Increasing indices, the first and the last sample among them.
    """
    count = values.size
    if count <= limit:
        return np.arange(count)
    pieces = max(1, limit // 2 - 1)
    edges = np.linspace(0, count, pieces + 1).astype(np.int64)
    comparable = np.where(np.isfinite(values), values, 0.0)
    chosen = {0, count - 1}
    for start, end in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        piece = comparable[start:end]
        chosen.update((start + int(piece.argmin()), start + int(piece.argmax())))
    return np.array(sorted(chosen), dtype=np.int64)


def even(x: NDArray[np.float32]) -> dict[str, Any]:
    """Return where the points of a curve lie, for its trace; evenly apart, as start and distance.

    Histories that are not thinned lie so, and their places are half of their data. The axis must be
    linear: on a logarithmic one plotly.js takes the distance as that of the logarithms.

    Parameters
    ----------
    x : (n,)
    """
    if x.size < 2:
        return {"x": x}
    start, step = float(x[0]), float(x[-1] - x[0]) / (x.size - 1)
    off = np.abs(start + step * np.arange(x.size) - x).max()
    is_even = off <= 2.0 * np.finfo(x.dtype).eps * np.abs(x).max()
    return {"x0": start, "dx": step} if is_even else {"x": x}


def simplified(points: NDArray[np.float64], tolerance: float) -> NDArray[np.float64]:
    """Return the points of a line that it needs to stay within a tolerance, in their unit.

    References
    ----------
    D. H. Douglas, T. K. Peucker, doi:10.3138/FM57-6770-U75U-7727
    """
    keep = np.zeros(len(points), dtype=bool)
    keep[[0, -1]] = True
    parts = [(0, len(points) - 1)]
    while parts:
        first, last = parts.pop()
        if last - first < 2:
            continue
        chord, own = points[last] - points[first], points[first + 1 : last] - points[first]
        length = max(float(np.hypot(*chord)), 1e-12)  # a closed line has no chord
        off = np.abs(chord[0] * own[:, 1] - chord[1] * own[:, 0]) / length
        worst = int(off.argmax())
        if off[worst] > tolerance:
            keep[first + 1 + worst] = True
            parts += [(first, first + 1 + worst), (first + 1 + worst, last)]
    return points[keep]


def floats(values: ArrayLike) -> dict[str, Any]:
    """Pack numbers as 32-bit floats."""
    return _packed("f4", np.asarray(values, dtype="<f4"))


def counts(values: ArrayLike) -> dict[str, Any]:
    """Pack whole numbers from 0 to 255."""
    return _packed("u1", np.asarray(values, dtype="u1"))


def steps(values: NDArray[Any]) -> dict[str, Any]:
    """Pack numbers, row by row, as 255 even steps between the smallest and the largest.

    Displacements of a wire become exact to about half a millimetre, less than a line is thick in
    the animation. A value that is not finite is packed as the smallest. What is written are the
    changes from row to row, modulo 256, of which most are small.

    Parameters
    ----------
    values : (n_row, n)
    """
    finite = values[np.isfinite(values)]
    low = float(finite.min()) if finite.size else 0.0
    step = (float(finite.max()) - low) / 255 if finite.size else 0.0
    scaled = (np.nan_to_num(values.astype(np.float64), nan=low) - low) / (step or 1.0)
    whole = np.clip(np.rint(scaled), 0, 255).astype(np.uint8)
    changes = np.diff(whole, axis=0, prepend=np.zeros_like(whole[:1]))
    return counts(changes) | {"low": low, "step": step, "row": values.shape[1]}


def _packed(dtype: str, values: NDArray[Any]) -> dict[str, Any]:
    written = zlib.compress(values.tobytes(), level=6)
    return {"dtype": dtype, "data": base64.b64encode(written).decode("ascii")}
