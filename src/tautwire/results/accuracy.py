"""How far the figures of a run may be from those of a fine mesh and a short step."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tautwire.plain import Plain


@dataclass(frozen=True)
class Accuracy(Plain):
    """Numerical errors of the statistics of a run, from mesh and time step.

    The errors of the model and of its inputs are not among them.

    Attributes
    ----------
    kind : str
        ``"estimate"`` or ``"bound"``.
    told : str
        How they were found, in words.
    first_span, last_span : int
        The analysed section that they belong to.
    cpu_s : float s
        What they cost.
    widths : mapping of str to float
        Half width of the error bar by ``pantograph/filter/quantity`` [N], ``pantograph/loss``
        [% of the time] and ``uplift`` [m]; of bounds also ``pantograph/history``, what the time
        step leaves in the unfiltered force over time [N rms].
    """

    kind: str
    told: str
    first_span: int
    last_span: int
    cpu_s: float
    widths: Mapping[str, float]

    def of(self, *path: str) -> float:
        """Return the half width of an error bar; NaN where there is none.

        Examples
        --------
        ``accuracy.of("front", "sharp", "0_20")``
        """
        return self.widths.get("/".join(path), math.nan)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Accuracy:
        """Read what :meth:`as_dict` gave.

        Raises
        ------
        ValueError
            When something is missing or no number.
        """
        try:
            widths = {str(k): float(v) for k, v in data["widths"].items()}
            spans = int(data["first_span"]), int(data["last_span"])
            return cls(str(data["kind"]), str(data["told"]), *spans, float(data["cpu_s"]), widths)
        except (KeyError, TypeError, AttributeError) as error:
            raise ValueError(f"numerical errors are damaged: {error}") from None


def last_place(error: float) -> int:
    """Return the power of ten of the last digit that an error above 0 leaves to a number.

    An error is told to one digit, to two where the first is 1.

    Examples
    --------
    >>> last_place(0.32), last_place(12.0)
    (-1, 0)
    """
    place = math.floor(math.log10(error))
    return place - (error < 2.0 * 10.0**place)


def rounded(value: float, error: float) -> float:
    """Return a number without the digits that its error makes worthless.

    Parameters
    ----------
    value
    error
        Half width of the error bar; where it is 0 or NaN the number is returned as it is.

    Examples
    --------
    >>> rounded(52.3784, 0.32), rounded(1294.3, 45.0)
    (52.4, 1290.0)
    """
    if not (math.isfinite(value) and math.isfinite(error) and error > 0.0):
        return value
    return round(value, -last_place(error))


def error_of(accuracy: Accuracy | None, *path: str) -> float:
    """Return the half width of an error bar; NaN where none was asked for."""
    return math.nan if accuracy is None else accuracy.of(*path)
