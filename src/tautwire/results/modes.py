"""Modes of vibration of a line about its static state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.text import csv_text

Array = NDArray[np.float64]

SHARES = (
    "contact x",
    "contact y",
    "contact z",
    "messenger x",
    "messenger y",
    "messenger z",
)
"""Parts of a mode's kinetic energy, in the order of :attr:`Modes.shares`."""

VERTICAL = SHARES.index("contact z")


@dataclass(frozen=True, eq=False)
class ModeWire:
    """The shapes of one wire in some modes.

    Attributes
    ----------
    name : str
    s : (n_node,) m
        Place of its nodes along the track.
    displacements : (n_mode, n_node, 3)
        Components x, y, z.
    """

    name: str
    s: Array
    displacements: Array


@dataclass(frozen=True, eq=False)
class Modes:
    """Some modes of a line, by increasing frequency; undamped, all droppers taut.

    Attributes
    ----------
    case_name, case_hash : str
    frequencies : (n_mode,) Hz
    wires : tuple of ModeWire
        Mode shapes of all wires, scaled to ``phi' M phi = 1 kg m2``.
    x : (n_point,) m
        Evenly spaced points of the contact wire.
    contact_z : (n_mode, n_point)
        Vertical mode shape of the contact wire at these points.
    shares : (n_mode, 6)
        Shares of the kinetic energy by wire and direction, see :data:`SHARES`; all wires that are
        not contact wires count as messenger.
    wavelengths : (n_mode,) m
        Sensitive wavelength: that of the highest peak of the spectrum of `contact_z`.
    residuals : (n_mode,)
        ``|K phi - omega^2 M phi| / |K phi|``.
    orthogonality : float
        Largest entry of ``Phi' M Phi - I``.
    counted : int
        Modes from the lowest to the highest frequency by the inertia of ``K - omega^2 M`` (Sturm
        count), independent of the iteration that found them.
    """

    case_name: str
    case_hash: str
    frequencies: Array
    wires: tuple[ModeWire, ...]
    x: Array
    contact_z: Array
    shares: Array
    wavelengths: Array
    residuals: Array
    orthogonality: float
    counted: int

    @property
    def is_complete(self) -> bool:
        """True when no mode between the lowest and the highest frequency was missed."""
        return self.counted == len(self.frequencies)

    @property
    def participation(self) -> Array:
        """Share of the vertical motion of the contact wire in the kinetic energy, (n_mode,)."""
        return self.shares[:, VERTICAL]

    def ranked(self) -> NDArray[np.int64]:
        """Return the numbers (0-based) of the modes, most vertical contact wire first."""
        return np.argsort(-self.participation, kind="stable")

    def chosen(self, numbers: NDArray[np.int64]) -> Modes:
        """Return some of the modes, by increasing frequency; the count stays that of all.

        Parameters
        ----------
        numbers
            0-based.
        """
        kept = np.sort(numbers)
        return Modes(
            self.case_name,
            self.case_hash,
            self.frequencies[kept],
            tuple(ModeWire(w.name, w.s, w.displacements[kept]) for w in self.wires),
            self.x,
            self.contact_z[kept],
            self.shares[kept],
            self.wavelengths[kept],
            self.residuals[kept],
            self.orthogonality,
            self.counted,
        )

    def rows(self) -> list[dict[str, Any]]:
        """Return one plain row per mode, by increasing frequency."""
        return [
            {
                "frequency_hz": float(self.frequencies[i]),
                "wavelength_m": float(self.wavelengths[i]),
                **{
                    f"share_{name.replace(' ', '_')}": float(share)
                    for name, share in zip(SHARES, self.shares[i], strict=True)
                },
                "residual": float(self.residuals[i]),
            }
            for i in range(len(self.frequencies))
        ]

    def as_dict(self) -> dict[str, Any]:
        """Return the modes without their shapes as plain data for JSON."""
        return {
            "modes": self.rows(),
            "orthogonality": self.orthogonality,
            "largest_residual": float(self.residuals.max(initial=0.0)),
            "counted_by_inertia": self.counted,
        }

    def to_csv(self) -> str:
        """Return the table of the modes as CSV."""
        head = ("frequency [Hz]", "sensitive wavelength [m]",
                *(f"share {name} [1]" for name in SHARES), "residual [1]")  # fmt: skip
        return csv_text(head, [[f"{value:.8g}" for value in row.values()] for row in self.rows()])

    def shapes_csv(self) -> str:
        """Return the vertical mode shape of all wires at their nodes as CSV.

        A wire without a node at a place has no value there.
        """
        head = ["position [m]"]
        s = np.unique(np.concatenate([wire.s for wire in self.wires]))
        columns = [s]
        for number, frequency in enumerate(self.frequencies):
            for wire in self.wires:
                head.append(f"{wire.name} z, {frequency:.4f} Hz [1]")
                column = np.full(len(s), np.nan)
                column[np.searchsorted(s, wire.s)] = wire.displacements[number, :, 2]
                columns.append(column)
        rows = zip(*columns, strict=True)
        return csv_text(head, [["" if np.isnan(v) else f"{v:.6g}" for v in row] for row in rows])
