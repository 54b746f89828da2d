"""The passage of the pantographs: time integration of the whole, nonlinear line."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.road.recorder import Recorder, Sampling
from tautwire.analyses.threads import single_threaded
from tautwire.errors import ConvergenceError
from tautwire.model.build import Model
from tautwire.model.equations import equations
from tautwire.model.passage import Passage, plan_passage
from tautwire.numerics.events.crossings import Crossing
from tautwire.numerics.events.refinement import AdaptiveStep
from tautwire.numerics.events.step_control import ConstantStep, StepControl, Task, VariableStep
from tautwire.numerics.motion.backend import Choice, backend_of, make_stepper
from tautwire.numerics.motion.dispersion import wave_stiffening
from tautwire.numerics.motion.stepper import StepBlock, StepOptions, Stepper
from tautwire.numerics.newmark import HHT, Extrapolated, Integrator, Newmark
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.irregularity import DrawnIrregularities
from tautwire.results.provenance import provenance
from tautwire.results.run import Run
from tautwire.specs.case import Case
from tautwire.status import Status

Array = NDArray[Any]

FRAME_INTERVAL = 0.02
"""Time between frames of the animation [s]: 50 pictures a second look smooth."""
FEW_FRAMES = 0.1
"""Time between frames where nobody looks at them [s]: with 20 ms a passage of AC simple at NAD 9
takes a tenth longer."""
SHAPE_INTERVAL = 0.005
"""Time between stored shapes [s]: 200 a second show waves of up to 100 Hz."""


@dataclass(frozen=True)
class Progress:
    """How far a passage is.

    Attributes
    ----------
    time, duration : float s
        Simulated time reached and planned.
    elapsed : float s
        Wall time spent.
    """

    time: float
    duration: float
    elapsed: float

    @property
    def share(self) -> float:
        """Share of the passage that is done, 0 to 1."""
        return min(1.0, self.time / self.duration)

    @property
    def remaining(self) -> float:
        """Estimated wall time to go [s]."""
        return self.elapsed * (1.0 - self.share) / max(self.share, 1e-9)


@dataclass(frozen=True, eq=False)
class Block:
    """A number of steps just taken.

    Attributes
    ----------
    steps : StepBlock
        Their histories.
    coordinates : (n_dof,)
        Nodal coordinates at the end of the block.
    progress : Progress
    crossings : tuple of Crossing or None
        Where contacts opened and closed; None when the step control does not locate that.
    """

    steps: StepBlock
    coordinates: Array
    progress: Progress
    crossings: tuple[Crossing, ...] | None = None


@dataclass(frozen=True, eq=False)
class Choices:
    """How a passage is computed; what is not given comes from the case.

    Attributes
    ----------
    integrator : Newmark, HHT or Extrapolated, optional
    stepping : ConstantStep, VariableStep or AdaptiveStep, optional
    uplift_forces : tuple of float N, optional
        One per pantograph.
    backend : str, optional
        ``"auto"``, ``"native"`` or ``"reference"``.
    frame_interval : float s, optional
        Time between pictures, and length of a block; by default 20 ms, and 5 ms where
        ``settings.store_shapes`` wants every shape.
    """

    integrator: Integrator | None = None
    stepping: StepControl | None = None
    uplift_forces: tuple[float, ...] | None = None
    backend: Choice | None = None
    frame_interval: float | None = None


class Simulation:
    """A passage under way: an iterator of blocks that also knows what it has counted.

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.
    choices
        What differs from the case's settings.
    """

    def __init__(self, model: Model, shape: Equilibrium, choices: Choices | None = None) -> None:
        choices = choices or Choices()
        settings = model.case.settings
        self.model, self.shape = model, shape
        self.integrator = choices.integrator or integrator_of(model.case)
        self.stepping = choices.stepping or _stepping(model)
        forces = choices.uplift_forces or model.case.uplift_forces()
        self.passage: Passage = plan_passage(model, shape, forces)
        system = equations(model, shape)
        options = StepOptions(
            self.integrator,
            self.stepping.time_step,
            settings.contact_stiffness,
            tolerance=settings.tolerance,
            stiffening=(
                wave_stiffening(system, self.integrator) if self.stepping.corrects_waves else None
            ),
        )
        step = self.stepping.time_step
        whole = np.ceil(self.passage.duration / step - 1e-9)
        usual = SHAPE_INTERVAL if settings.store_shapes else FRAME_INTERVAL
        interval = choices.frame_interval or usual
        self.sampling = Sampling(
            step, int(min(whole, self.passage.latest // step)), max(1, round(interval / step))
        )
        self.recorder = Recorder(model, shape, self.passage, self.sampling)
        self.stepper: Stepper = make_stepper(
            system,
            self.passage.pantographs,
            options,
            self.recorder.observed,
            choices.backend or settings.backend,
        )
        self.backend = backend_of(self.stepper)

    def blocks(self) -> Iterator[Block]:
        """Advance to the end of the passage, block by block; the last block tells the status."""
        begin, reached = clock.perf_counter(), 0.0
        stiffness = self.model.case.settings.contact_stiffness
        samples = self.sampling
        task = Task(self.stepper, samples.count, samples.frame, stiffness, self._focus())
        for chunk in self.stepping.integrate(task):
            reached = float(chunk.steps.time[-1]) if len(chunk.steps.time) else reached
            progress = Progress(reached, self.passage.duration, clock.perf_counter() - begin)
            yield Block(chunk.steps, chunk.coordinates, progress, chunk.crossings)

    def _focus(self) -> tuple[float, float]:
        """Return when the first pantograph enters the analysed section and the last leaves it."""
        first, last = self.model.case.resolved_section()
        limits = np.array(self.model.case.line.support_positions())[[first - 1, last]]
        times = [
            given.start_time + (limits - given.start_x) / given.velocity
            for given in self.passage.pantographs
        ]
        return float(np.min(times)), float(np.max(times))


def iterate(model: Model, shape: Equilibrium, *, choices: Choices | None = None) -> Iterator[Block]:
    """Run a passage and yield its steps in blocks, for live views and early stops.

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.
    choices
        What differs from the case's settings.

    Yields
    ------
    Block
        About 20 ms of simulated time each.
    """
    return Simulation(model, shape, choices).blocks()


def simulate(
    model: Model,
    shape: Equilibrium,
    *,
    integrator: Integrator | None = None,
    stepping: StepControl | None = None,
    uplift_forces: Sequence[float] | None = None,
    backend: Choice | None = None,
    watch: Callable[[Progress], bool] | None = None,
) -> Run:
    """Simulate the passage of the case's pantographs.

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.
    integrator
        Newmark, HHT or Extrapolated; ``settings.integrator`` by default.
    stepping
        Step control; ``settings.step_control`` with ``settings.time_step`` by default.
    uplift_forces
        Force on each pantograph [N]; prescribed or first-guess forces of the scenario by default.
    backend
        ``"auto"``, ``"native"`` or ``"reference"``; ``settings.backend`` by default.
    watch
        Called after every block; returning True stops the run and keeps what was computed.

    Returns
    -------
    Run
        With status ``"partial"`` when ``watch`` or Ctrl-C stopped it.

    Raises
    ------
    ConvergenceError
        When a step fails; ``error.partial`` is the run up to there.
    """
    forces = None if uplift_forces is None else tuple(uplift_forces)
    return carried_out(
        Simulation(model, shape, Choices(integrator, stepping, forces, backend)), watch
    )


@single_threaded
def carried_out(simulation: Simulation, watch: Callable[[Progress], bool] | None = None) -> Run:
    """Carry out a passage that was begun: see :func:`simulate`.

    Parameters
    ----------
    simulation
    watch
        Called after every block; returning True stops the run and keeps what was computed.
    """
    recorder, status, last = simulation.recorder, Status.DONE, Status.RUNNING
    cpu, wall = clock.process_time(), clock.perf_counter()
    try:
        for block in simulation.blocks():
            recorder.add(block.steps, block.coordinates, block.crossings)
            last = block.steps.status
            if watch is not None and watch(block.progress):
                status = Status.INTERRUPTED
                break
    except KeyboardInterrupt:
        status = Status.INTERRUPTED
    if last is not Status.RUNNING:
        status = last
    spent = (clock.process_time() - cpu, clock.perf_counter() - wall)
    run = _collect(simulation, status, spent)
    if status not in (Status.DONE, Status.INTERRUPTED):
        raise ConvergenceError(run.message, partial=run)
    return run


def integrator_of(case: Case) -> Integrator:
    """Return the time integration that a case asks for."""
    spec = case.settings.integrator
    if spec.method == "extrapolated":
        return Extrapolated()
    return HHT(spec.alpha) if spec.method == "hht" else Newmark()


def _stepping(model: Model) -> StepControl:
    settings = model.case.settings
    spec, step = settings.step_control, settings.step()
    if spec.method == "variable":
        return VariableStep(
            step,
            tolerance=spec.gap_tolerance or VariableStep.tolerance,
            force_tolerance=spec.force_tolerance,
            most_losses=spec.most_losses,
            corrects_waves=spec.corrects_waves,
        )
    if spec.method == "adaptive":
        return AdaptiveStep(
            step,
            tolerance=spec.duration_tolerance or AdaptiveStep.tolerance,
            most_losses=spec.most_losses,
            corrects_waves=spec.corrects_waves,
        )
    return ConstantStep(step, corrects_waves=spec.corrects_waves)


def _collect(simulation: Simulation, status: Status, spent: tuple[float, float]) -> Run:
    """Make a run of what a passage has left behind."""
    model, recorder = simulation.model, simulation.recorder
    time = recorder.time
    words = {Status.DONE: "done", Status.INTERRUPTED: "partial"}
    return Run(
        case=model.case,
        equilibrium=simulation.shape,
        status=words.get(status, "failed"),
        message=_message(status, time),
        time=time,
        pantographs=recorder.pantographs(),
        support_uplift=recorder.support_uplift(),
        droppers=recorder.droppers(),
        snapshots=recorder.snapshots(),
        counters=_counters(simulation, time, spent),
        warnings=tuple(simulation.passage.warnings),
        provenance=provenance(model.case, simulation.backend),
        events=recorder.events(),
        irregularities=_irregularities(model),
    )


def _irregularities(model: Model) -> DrawnIrregularities | None:
    drawn = model.irregularities
    return drawn if drawn.is_installed_wrong or drawn.is_uneven else None


def _message(status: Status, time: Array) -> str:
    if status is Status.DONE:
        return ""
    reached = f"t = {time[-1]:.3f} s" if len(time) else "the start"
    return f"The passage stopped at {reached}. {status.sentence} {status.cure}"


def _counters(simulation: Simulation, time: Array, spent: tuple[float, float]) -> dict[str, Any]:
    """Return the work done, with the keys of the ``cost`` part of the JSON output."""
    counters = simulation.stepper.counters
    simulated = float(time[-1]) if len(time) else 0.0
    return {
        "dof": int(simulation.shape.position.size),
        "steps": counters.steps,
        "iterations_mean": counters.iterations / max(counters.steps, 1),
        "refactorisations": counters.refactorisations,
        "full_newton_steps": counters.full_newton_steps,
        "simulated_s": simulated,
        "cpu_s": spent[0],
        "wall_s": spent[1],
        "real_time_factor": spent[0] / simulated if simulated else float("nan"),
        "tuning_passes": 0,
        "backend": simulation.backend,
        "integrator": simulation.integrator.describe(),
        "time_step": simulation.stepping.time_step,
        "step_control": simulation.stepping.describe(),
        **counters.notes,
    }
