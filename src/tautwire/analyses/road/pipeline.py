"""The whole road in one call: case, model, shape, tuned passage."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from tautwire.analyses.road.accuracy import with_accuracy
from tautwire.analyses.road.dynamics import Choices, Progress, Simulation, carried_out
from tautwire.analyses.road.mean_force import tune_mean_force
from tautwire.analyses.road.progress_bar import progress_bar
from tautwire.analyses.road.shape import find_shape
from tautwire.analyses.road.validity import judged
from tautwire.inputs.load import load_case, make_case
from tautwire.model.build import Model, build
from tautwire.numerics.motion.backend import Choice
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.run import Run
from tautwire.specs.case import Case


def run(
    case: Case | str | Path,
    *,
    overrides: Mapping[str, Any] | None = None,
    backend: Choice | None = None,
    watch: Callable[[int | str, Progress], bool] | None = None,
    progress: bool = False,
    **scenario: Any,
) -> Run:
    """Find the shape and simulate the passage, mean force tuned where the scenario asks for it.

    Parameters
    ----------
    case
        A case, the name of a library case, or a case file.
    overrides
        Values to replace, by path: ``{"settings.contact_stiffness": "50 kN/m"}``.
    backend
        ``"auto"``, ``"native"`` or ``"reference"``; ``settings.backend`` by default.
    watch
        Called with the number of the passage (from 1), or the name of a companion, and its
        progress; True stops the run.
    progress
        Whether a bar shows how far each passage is, where nothing else watches.
    **scenario
        Fields of the scenario to replace: ``speed="275 km/h"``.

    Returns
    -------
    Run

    Examples
    --------
    >>> run("ac-simple", speed="275 km/h")  # doctest: +SKIP
    """
    changes = dict(overrides or {}) | {f"scenario.{k}": v for k, v in scenario.items()}
    if isinstance(case, Case):
        chosen = make_case(case.to_dict(), changes) if changes else case
    else:
        chosen = load_case(case, changes)
    if watch is not None or not progress:
        return run_case(chosen, backend=backend, watch=watch)
    with progress_bar() as show:
        return run_case(chosen, backend=backend, watch=show)


def run_case(
    case: Case,
    *,
    backend: Choice | None = None,
    watch: Callable[[int | str, Progress], bool] | None = None,
) -> Run:
    """Do the same for a case that is complete."""
    model = build(case)
    return run_line(model, find_shape(model), backend=backend, watch=watch)


def run_line(
    model: Model,
    shape: Equilibrium,
    *,
    backend: Choice | None = None,
    watch: Callable[[int | str, Progress], bool] | None = None,
    frame_interval: float | None = None,
) -> Run:
    """Do the same for a line whose shape is known.

    The warnings of the run name what is outside the model's world, see
    :mod:`tautwire.analyses.road.validity`. Pictures are ``frame_interval`` apart [s], where it is
    given.
    """
    if model.case.scenario.target_mean_force() is not None:
        found = tune_mean_force(
            model, shape, backend=backend, watch=watch, frame_interval=frame_interval
        )
    else:
        once = None if watch is None else lambda progress: watch(1, progress)
        choices = Choices(backend=backend, frame_interval=frame_interval)
        found = carried_out(Simulation(model, shape, choices), once)
    return with_accuracy(judged(found), backend=backend, watch=watch)
