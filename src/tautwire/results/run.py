"""What a passage of one or several pantographs left behind."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import InputError, not_installed
from tautwire.results.accessors import made
from tautwire.results.accuracy import Accuracy
from tautwire.results.droppers import DropperHistory
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.irregularity import DrawnIrregularities
from tautwire.specs.case import Case
from tautwire.text import Told

Array = NDArray[np.float64]

_HISTORIES = {"position": "m", "contact_force": "N", "gap": "m", "wire_height": "m"}


@dataclass(frozen=True, eq=False)
class ForceRecord:
    """A contact force over time and position, unfiltered.

    Attributes
    ----------
    time : (n_time,) s
    position : (n_time,) m
    force : (n_time,) N
    """

    time: Array
    position: Array
    force: Array

    @property
    def time_step(self) -> float:
        """Sampling interval [s]; the record is uniform in time."""
        return float(self.time[1] - self.time[0])


@dataclass(frozen=True, eq=False)
class PantographRecord:
    """Histories of one pantograph.

    Attributes
    ----------
    name : str
    uplift_force : float N
        Force applied to the pantograph (static and aerodynamic).
    target_mean : float N or None
        Mean force the uplift force was tuned to; None when it was prescribed.
    position : (n_time,) m
        Position along the track.
    contact_force : (n_time,) N
        Positive when the pantograph lifts the wire; 0 before it enters the line.
    gap : (n_time,) m
        Height of the wire above the head; negative while in contact (penetration).
    wire_height : (n_time,) m
        Height of the contact wire at the pantograph; of several the one next to the head.
    wire_forces : (n_time, n_contact_wire) N
        Share of every contact wire of the line, in the order of ``Equilibrium.wires``; NaN where
        the head does not reach it.
    stage_heights : (n_time, n_stage) m
        Displacement of the stages from their starting position, head first.
    active : (n_time,) bool
        True from the moment the pantograph has entered the line.
    """

    name: str
    uplift_force: float
    target_mean: float | None
    position: Array
    contact_force: Array
    gap: Array
    wire_height: Array
    wire_forces: Array
    stage_heights: Array
    active: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Snapshots:
    """Coarse shapes of all wires during the passage (for the animation).

    Attributes
    ----------
    time : (n_frame,) s
    x : (n_point,) m
        Places along the track, wire by wire.
    wire : (n_point,)
        Number of the wire of each point, in the order of ``Equilibrium.wire_names``.
    z : (n_frame, n_point) m
    """

    time: Array
    x: Array
    wire: NDArray[np.int64]
    z: NDArray[np.float32]

    def of(self, wire: int) -> tuple[Array, NDArray[np.float32]]:
        """Return the points ``(n,)`` and the heights ``(n_frame, n)`` of one wire."""
        own = self.wire == wire
        return self.x[own], self.z[:, own]


@dataclass(frozen=True, eq=False)
class ContactEvents:
    """Instants at which contacts open and close, located between samples.

    Attributes
    ----------
    time : (n_event,) s
        In order.
    pantograph : (n_event,)
        0-based number of the pantograph.
    opens : (n_event,) bool
        True for a separation, False for a re-contact.
    """

    time: Array
    pantograph: NDArray[np.int64]
    opens: NDArray[np.bool_]


@dataclass(frozen=True, eq=False, repr=False)
class Run(Told):
    """Result of :func:`tautwire.simulate`.

    Attributes
    ----------
    case : Case
    equilibrium : Equilibrium
    status : str
        ``"done"``, ``"partial"`` (interrupted, everything up to then is valid) or ``"failed"``.
    message : str
        Reason and cure when the status is not ``"done"``.
    time : (n_time,) s
    pantographs : tuple of PantographRecord
    support_uplift : (n_time, n_support) m
        Vertical displacement of the contact wire at the supports from the static state.
    droppers : DropperHistory
        Axial dropper forces, in the order of the equilibrium, each while a pantograph is near.
    snapshots : Snapshots
    counters : mapping
        ``dof, steps, iterations_mean, refactorisations, full_newton_steps, simulated_s, cpu_s,
        wall_s, real_time_factor, tuning_passes, backend``; of the compiled core ``threads,
        helped_parts, local_iterations, local_rows, solved_rows, overlooked``; of an adaptive step
        ``windows, refined_s, unsettled_windows``.
    warnings : tuple of str
    provenance : mapping
        ``version, commit, created, case_hash, python, platform``.
    events : ContactEvents or None
        Where contacts opened and closed; None when the step control does not locate that.
    irregularities : DrawnIrregularities or None
        What the line was computed with; None when it has none.
    accuracy : Accuracy or None
        Numerical errors of its statistics; None when none were asked for.
    """

    case: Case
    equilibrium: Equilibrium
    status: str
    message: str
    time: Array
    pantographs: tuple[PantographRecord, ...]
    support_uplift: NDArray[np.float32]
    droppers: DropperHistory
    snapshots: Snapshots
    counters: Mapping[str, Any]
    warnings: tuple[str, ...] = ()
    provenance: Mapping[str, Any] = field(default_factory=dict)
    events: ContactEvents | None = None
    irregularities: DrawnIrregularities | None = None
    accuracy: Accuracy | None = None

    @property
    def dropper_force(self) -> NDArray[np.float32]:
        """Axial dropper forces at every sample, ``(n_time, n_dropper)`` [N]; zero while slack.

        NaN where no pantograph was within a kilometre.
        """
        return self.droppers.at(np.arange(self.time.size))

    @property
    def plot(self) -> Any:
        """Figures of the report, as :class:`tautwire.report.pages.notebook.RunPlots`."""
        return made("plot", self)

    def facts(self) -> dict[str, str]:
        """Return line, passage, cost and warnings in words; statistics are made separately."""
        spans, end = self.case.line.spans, self.time[-1] if self.time.size else 0.0
        told = {
            "case": f"{self.case.name} at {3.6 * self.case.scenario.speed:g} km/h, {spans} spans",
            "status": f"{self.status}, {self.message}" if self.message else self.status,
            "passage": f"{end:.2f} s in {self.time.size} samples",
        }
        for record in self.pantographs:
            told[record.name] = f"uplift force {record.uplift_force:.1f} N"
        told["computed with"] = str(self.counters.get("backend", "unknown"))
        return told | ({"warnings": " ".join(self.warnings)} if self.warnings else {})

    def to_xarray(self) -> Any:
        """Return the histories as an ``xarray.Dataset`` over time, pantograph and support.

        Values are in SI units, named in the attribute ``units`` of each.

        Raises
        ------
        InputError
            When xarray is not installed.
        """
        try:
            import xarray
        except ImportError:
            raise not_installed("xarray", "data") from None
        both = ("time", "pantograph")
        histories: dict[str, tuple[tuple[str, str], NDArray[Any], str]] = {
            name: (both, np.column_stack([getattr(p, name) for p in self.pantographs]), unit)
            for name, unit in _HISTORIES.items()
        }
        histories["support_uplift"] = (("time", "support"), self.support_uplift, "m")
        histories["dropper_force"] = (("time", "dropper"), self.dropper_force, "N")
        shape = self.equilibrium
        return xarray.Dataset(
            {name: (axes, values, {"units": u}) for name, (axes, values, u) in histories.items()},
            {
                "time": ("time", self.time, {"units": "s"}),
                "pantograph": [record.name for record in self.pantographs],
                "support_x": ("support", shape.support_x, {"units": "m"}),
                "dropper_x": ("dropper", shape.dropper_x, {"units": "m"}),
            },
            {"case": self.case.name, "status": self.status},
        )

    def to_pandas(self) -> Any:
        """Return the histories of the pantographs as a ``pandas.DataFrame``, one row per sample.

        Columns name pantograph, quantity and unit: ``("front", "contact_force [N]")``. Samples
        before a pantograph has entered the line hold NaN.

        Raises
        ------
        InputError
            When pandas is not installed.
        """
        try:
            import pandas as pd
        except ImportError:
            raise not_installed("pandas", "data") from None
        columns = {
            (record.name, f"{name} [{unit}]"): np.where(
                record.active, getattr(record, name), np.nan
            )
            for record in self.pantographs
            for name, unit in _HISTORIES.items()
        }
        return pd.DataFrame(columns, index=pd.Index(self.time, name="time [s]"))

    def pantograph(self, name: str) -> PantographRecord:
        """Return the record of the named pantograph.

        Raises
        ------
        InputError
            When no pantograph has that name.
        """
        for record in self.pantographs:
            if record.name == name:
                return record
        names = ", ".join(p.name for p in self.pantographs)
        raise InputError(f"no pantograph named {name!r} in this run; there are: {names}")

    def contact_force(self, name: str) -> ForceRecord:
        """Return the unfiltered contact force of the named pantograph since it entered."""
        record = self.pantograph(name)
        on = record.active
        return ForceRecord(self.time[on], record.position[on], record.contact_force[on])
