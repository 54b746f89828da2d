"""What a passage leaves behind, taken from its steps as they come.

Only what a run keeps is held, in the precision in which it is kept: coordinates of all nodes at
every picture, or every dropper at every step, would fill the memory on a line of 10 km.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.model.build import Model
from tautwire.model.mesh import Strand
from tautwire.model.passage import Passage
from tautwire.numerics.events.crossings import Crossing
from tautwire.numerics.motion.stepper import SAME_TIME, StepBlock
from tautwire.results.droppers import DropperHistory
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.run import ContactEvents, PantographRecord, Snapshots

Array = NDArray[Any]

NEAR = 1000.0
"""How far from a dropper pantographs are for its force to be kept [m]. Lines up to this length are
kept whole; 10 km under two pantographs takes a fifth of what all samples would."""
_HISTORIES = ("time", "contact_force", "gap", "wire_height", "path_force", "stages")


@dataclass(frozen=True)
class Sampling:
    """How a passage is sampled.

    Attributes
    ----------
    step : float s
    count : int
        Number of samples planned.
    frame : int
        Samples from one picture to the next.
    """

    step: float
    count: int
    frame: int


class Recorder:
    """Takes the steps of a passage and gives the histories of a run.

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.
    passage
        The plan of the passage.
    sampling
        Its samples and pictures.
    """

    def __init__(
        self, model: Model, shape: Equilibrium, passage: Passage, sampling: Sampling
    ) -> None:
        self._model, self._shape, self._passage = model, shape, passage
        supports = model.mesh.nodes(at for _, at in model.line.contact_supports)
        self._supports = model.mesh.frames[supports]
        self.observed = (6 * supports[:, None] + np.arange(3)).ravel()
        self._kept: dict[str, list[Array]] = {name: [] for name in _HISTORIES}
        self._uplift: list[NDArray[np.float32]] = []
        self._crossings: list[Crossing] | None = None
        self._droppers = _Droppers(model, shape, passage, sampling)
        self._frames = _Frames(model, sampling)
        self._frames.add(0.0, shape.position)
        self._samples = 0

    def add(
        self, steps: StepBlock, coordinates: Array, crossings: tuple[Crossing, ...] | None
    ) -> None:
        """Take a number of steps, the coordinates after them and where contacts changed."""
        for name in _HISTORIES:
            self._kept[name].append(np.array(getattr(steps, name)))
        if crossings is not None:
            self._crossings = [*(self._crossings or ()), *crossings]
        heights = self._support_heights(steps.observed)
        self._uplift.append((heights - self._shape.support_heights).astype(np.float32))
        self._droppers.add(
            self._samples, steps.time, steps.dropper_force[:, : len(self._shape.dropper_x)]
        )
        self._samples += len(steps.time)
        self._frames.add(self.reached, coordinates)

    def _support_heights(self, observed: Array) -> Array:
        places = observed.reshape(len(observed), len(self._supports.origin), 3)
        return self._supports.to_local(places)[..., 2]

    @property
    def reached(self) -> float:
        """Time of the last sample [s]; 0 before the first."""
        return next((float(t[-1]) for t in reversed(self._kept["time"]) if len(t)), 0.0)

    @property
    def time(self) -> Array:
        """Times of the samples, ``(n_time,)`` [s]."""
        return self._joined("time", ())

    def _joined(self, name: str, shape: tuple[int, ...]) -> Array:
        parts = self._kept[name]
        return np.concatenate(parts) if parts else np.empty((0, *shape))

    def support_uplift(self) -> NDArray[np.float32]:
        """Return the uplift of the contact wires at their supports, ``(n_time, n_support)`` [m]."""
        none = np.empty((0, len(self._supports.origin)), dtype=np.float32)
        return np.concatenate([none, *self._uplift])

    def droppers(self) -> DropperHistory:
        """Return the forces of the droppers."""
        return self._droppers.history().until(self._samples)

    def snapshots(self) -> Snapshots:
        """Return the pictures of the line."""
        return self._frames.snapshots()

    def events(self) -> ContactEvents | None:
        """Return where contacts opened and closed; None when that was not located."""
        if self._crossings is None:
            return None
        crossings = sorted(self._crossings, key=lambda c: c.time)
        return ContactEvents(
            time=np.array([c.time for c in crossings], dtype=float),
            pantograph=np.array([c.pantograph for c in crossings], dtype=np.int64),
            opens=np.array([c.opens for c in crossings], dtype=bool),
        )

    def pantographs(self) -> tuple[PantographRecord, ...]:
        """Return the histories of the pantographs."""
        case, passage, time = self._model.case, self._passage, self.time
        count = len(case.pantographs)
        wires = len(self._shape.of_role("contact"))
        force, gap, height = (
            self._joined(name, (count,)) for name in ("contact_force", "gap", "wire_height")
        )
        shares = self._joined("path_force", (count, wires))
        stages = self._joined("stages", (sum(len(p.stages) for p in case.pantographs),))
        ends = np.cumsum([len(p.stages) for p in case.pantographs])
        return tuple(
            PantographRecord(
                name=spec.name,
                uplift_force=passage.uplift_forces[i],
                target_mean=case.scenario.target_mean_force(),
                position=given.start_x + given.velocity * (time - given.start_time),
                contact_force=force[:, i],
                gap=gap[:, i],
                wire_height=height[:, i],
                wire_forces=shares[:, i],
                stage_heights=stages[:, ends[i] - len(spec.stages) : ends[i]],
                active=time >= given.start_time - SAME_TIME,
            )
            for i, (spec, given) in enumerate(
                zip(case.pantographs, passage.pantographs, strict=True)
            )
        )


class _Droppers:
    """Forces of droppers near the pantographs, and their extremes elsewhere."""

    def __init__(
        self, model: Model, shape: Equilibrium, passage: Passage, sampling: Sampling
    ) -> None:
        self._step, self._heads = sampling.step, passage.pantographs
        arrivals = np.array(
            [
                given.start_time + (shape.dropper_x - given.start_x) / given.velocity
                for given in passage.pantographs
            ]
        )
        ahead = NEAR / abs(passage.pantographs[0].velocity)
        begin = (arrivals.min(axis=0) - ahead) / sampling.step
        way = np.ptp(arrivals, axis=0).max(initial=0.0) + 2.0 * ahead
        kept = min(sampling.count, int(np.ceil(way / sampling.step)) + 2)
        # sample k is that of the time (k + 1) step
        self._first = np.clip(np.floor(begin) - 1, 0, sampling.count - kept).astype(np.int64)
        count, self._is_whole = len(self._first), not self._first.any()
        self._force = np.full((kept, count), np.nan, dtype=np.float32)
        self._least, self._largest = np.full(count, np.inf), np.full(count, -np.inf)
        self._slack = np.zeros(count)
        first, last = model.case.resolved_section()
        masts = np.array(model.case.line.support_positions())
        self._limits = (
            1.5 * masts[first - 1] - 0.5 * masts[first],
            1.5 * masts[last] - 0.5 * masts[last - 1],
        )

    def add(self, sample: int, time: Array, force: Array) -> None:
        """Take the forces ``(n, n_dropper)`` of some samples, the first of which is given."""
        force = force.astype(np.float32)
        if self._is_whole and sample + len(time) <= len(self._force):
            self._force[sample : sample + len(time)] = force
            return
        row = sample + np.arange(len(time))[:, None] - self._first
        is_kept = (row >= 0) & (row < len(self._force))
        at, dropper = np.nonzero(is_kept)
        self._force[row[at, dropper], dropper] = force[at, dropper]
        counts = ~is_kept & self._passes(time)[:, None]
        if counts.any():
            self._least = np.minimum(self._least, np.where(counts, force, np.inf).min(axis=0))
            largest = np.where(counts, force, -np.inf).max(axis=0)
            self._largest = np.maximum(self._largest, largest)
            self._slack += self._step * (counts & (force <= 0.0)).sum(axis=0)

    def _passes(self, time: Array) -> NDArray[np.bool_]:
        """Tell at which times a pantograph is in the analysed section, or half a span from it."""
        low, high = self._limits
        places = np.array([given.position(time) for given in self._heads])
        entered = time >= np.array([given.start_time for given in self._heads])[:, None] - SAME_TIME
        return ((places >= low) & (places <= high) & entered).any(axis=0)

    def history(self) -> DropperHistory:
        """Return what was kept."""
        return DropperHistory(
            self._force,
            self._first,
            np.where(np.isfinite(self._least), self._least, np.nan),
            np.where(np.isfinite(self._largest), self._largest, np.nan),
            self._slack,
        )


class _Frames:
    """Pictures of the line: attachments and middles between them; or every node."""

    def __init__(self, model: Model, sampling: Sampling) -> None:
        every = model.case.settings.store_shapes
        strands = model.mesh.strands
        kept = [np.arange(len(s.s)) if every else _coarse(model, s) for s in strands]
        nodes = [strand.nodes[own] for strand, own in zip(strands, kept, strict=True)]
        self._nodes = np.concatenate(nodes)
        self._wire = np.repeat(np.arange(len(nodes)), [len(own) for own in nodes])
        self._x = model.mesh.s[self._nodes]
        self._frames = model.mesh.frames[self._nodes]
        most = 2 + -(-sampling.count // sampling.frame)  # at rest, whole chunks, and a last one
        self._z = np.empty((most, len(self._nodes)), dtype=np.float32)
        self._time: list[float] = []

    def add(self, time: float, coordinates: Array) -> None:
        """Take the coordinates ``(n_dof,)`` of all nodes at some time."""
        places = coordinates.reshape(-1, 6)[self._nodes, :3]
        self._z[len(self._time)] = self._frames.to_local(places)[:, 2]
        self._time.append(time)

    def snapshots(self) -> Snapshots:
        """Return the pictures taken."""
        taken = self._z[: len(self._time)]
        return Snapshots(np.array(self._time), self._x, self._wire, taken)


def _coarse(model: Model, strand: Strand) -> NDArray[np.int64]:
    """Return which nodes of a strand are attachments or lie midway between two."""
    points = np.array([strand.position(s) for s in model.line.points(strand.run.name)])
    return np.unique(np.concatenate([points, (points[:-1] + points[1:]) // 2]))
