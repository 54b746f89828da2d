"""One case of a study: computed, measured, and made into a row of plain numbers.

A row holds SI numbers only, so it can be written as JSON and sent between machines.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any

from tautwire.errors import ConvergenceError, InputError, ModelError
from tautwire.plain import plain
from tautwire.specs.case import Case
from tautwire.version import __version__

if TYPE_CHECKING:
    from tautwire.results.accuracy import Accuracy
    from tautwire.studies.execution.setup import Lines

DONE, FAILED = "done", "failed"

STANDARD_TASK = "tautwire.studies.execution.task:simulate_case"
"""Where the function that computes a case is found."""

_FORCES = ("mean", "maximum", "minimum", "statistical_maximum", "statistical_minimum")

Values = dict[str, Any]
Task = Callable[[Case, bool], tuple[Values, bytes | None]]
"""Returns the numbers of a case, and its run as the bytes of a netCDF file when asked for."""


@dataclass(frozen=True)
class Job:
    """A case to compute, as plain data.

    Attributes
    ----------
    key : str
        What identifies the result.
    case : mapping
        The case.
    task : str
        ``module:function`` of type :data:`Task`.
    keep_runs : bool
        Whether the histories are kept.
    """

    key: str
    case: Mapping[str, Any]
    task: str = STANDARD_TASK
    keep_runs: bool = False


@dataclass(frozen=True)
class Outcome:
    """What a computed case gives.

    Attributes
    ----------
    row : dict
        ``status``, ``reason``, ``kind`` of a failure, ``values`` and ``cost``.
    run_file : bytes or None
        The run as a netCDF file.
    """

    row: dict[str, Any]
    run_file: bytes | None = None


def perform(job: Job) -> Outcome:
    """Compute a case; whatever goes wrong in it becomes a row with its reason.

    Raises
    ------
    OSError
        When the trouble is not the case but the machine, such as a full disk.
    """
    cpu, wall = time.process_time(), time.perf_counter()
    values: Values = {}
    run_file, kind, reason = None, "", ""
    try:
        compute = find_task(job.task)
        values, run_file = compute(Case.model_validate(dict(job.case)), job.keep_runs)
    except (ConvergenceError, ModelError, InputError) as error:
        kind, reason = type(error).__name__, str(error)
    except OSError:
        raise
    except MemoryError:
        kind, reason = "MemoryError", "there is not enough memory for this case"
    except Exception as error:  # noqa: BLE001  one bad case must not end a study
        kind, reason = type(error).__name__, f"{type(error).__name__}: {error}"
    row = {
        "status": FAILED if kind else DONE,
        "kind": kind,
        "reason": " ".join(reason.split()),
        "version": __version__,
        "values": plain(values),
        "cost": {
            "cpu_s": time.process_time() - cpu,
            "wall_s": time.perf_counter() - wall,
            "peak_memory_mb": peak_memory(),
        },
    }
    return Outcome(row, run_file)


def lost_row(reason: str) -> dict[str, Any]:
    """Return the row of a case that took its worker down."""
    cost = dict.fromkeys(("cpu_s", "wall_s", "peak_memory_mb"))
    return {
        "status": FAILED,
        "kind": "worker lost",
        "reason": reason,
        "version": __version__,
        "values": {},
        "cost": cost,
    }


def find_task(name: str) -> Task:
    """Return the function that a name ``module:function`` stands for."""
    module, _, function = name.partition(":")
    return getattr(import_module(module), function)


def simulate_case(case: Case, keep_run: bool) -> tuple[Values, bytes | None]:  # noqa: FBT001
    """Simulate the passage, mean force tuned where the case asks for it, and evaluate it."""
    from tautwire.analyses.force.cutoff import advise_cutoff, missed_deviation
    from tautwire.analyses.force.statistics import contact_statistics
    from tautwire.analyses.road.dynamics import FEW_FRAMES
    from tautwire.analyses.road.pipeline import run_line
    from tautwire.results.storage import run_image
    from tautwire.signals.filters import Butterworth, SharpLowpass

    interval = None if keep_run else FEW_FRAMES
    run = run_line(*_lines().at_rest(case), frame_interval=interval)
    statistics = contact_statistics(run)
    filters = {"sharp": SharpLowpass(), "butterworth": Butterworth(case.settings.filter_order)}
    pantographs, cutoff = [], advise_cutoff(case).frequency
    for entry in statistics.pantographs:
        loss = entry.contact_loss
        advised = {
            kind: missed_deviation(run, entry.name, lowpass) for kind, lowpass in filters.items()
        }
        pantographs.append(
            {
                "name": entry.name,
                "uplift_force": entry.uplift_force,
                "contact_height_range": entry.contact_height_range,
                "loss_count": loss.count,
                "loss_percent": loss.percent,
                "loss_longest": loss.longest,
                "arc_percent": loss.percent_over(),
                **_error(run.accuracy, "loss_percent", entry.name, "loss"),
                "filters": {
                    kind: _filtered(entry.filtered[kind], advised[kind].advised)
                    | _errors(run.accuracy, entry.filtered[kind], entry.name)
                    for kind in filters
                },
            }
        )
    values = {
        "uplift_max": statistics.uplift.maximum,
        **_error(run.accuracy, "uplift_max", "uplift"),
        "dropper_force_max": _largest(statistics.droppers.maximum),
        "dropper_slack_longest": _largest(statistics.droppers.slack_time),
        "advised_cutoff": cutoff,
        "steps": run.counters.get("steps"),
        "tuning_passes": run.counters.get("tuning_passes", 1),
        "backend": str(run.counters.get("backend", "")),
        "warnings": "; ".join(run.warnings),
        "carried_band": statistics.pantographs[0].headline.carried,
        "marked": ", ".join(_marked(statistics.pantographs[0])),
        "pantographs": pantographs,
    }
    return values, run_image(run) if keep_run else None


def _marked(entry: Any) -> list[str]:
    """Return the columns whose figures mesh and time step do not carry."""
    part = entry.filtered["sharp"]
    bands = [f"std_{band}" for band in part.standard_deviations if not part.carries(band)]
    return bands + ([] if entry.contact_loss.is_carried else ["losses"])


@cache
def _lines() -> Lines:
    """Return the lines that this process knows."""
    from tautwire.studies.execution.setup import Lines

    return Lines()


def peak_memory() -> float | None:
    """Return the largest memory this process has used [MB]; None where it is not known."""
    try:
        import resource
    except ImportError:  # not POSIX
        return None
    import sys

    unit = 1.0 if sys.platform == "darwin" else 1024.0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6


def _filtered(part: Any, advised: float) -> Values:
    bands = {f"std_{band}": value for band, value in part.standard_deviations.items()}
    return {
        **{name: getattr(part, name) for name in _FORCES},
        **bands,
        "std_advised": advised,
    }


def _errors(accuracy: Accuracy | None, part: Any, who: str) -> Values:
    """Return the numerical errors of the statistics through one filter."""
    names = {name: name for name in _FORCES}
    names |= {f"std_{band}": band for band in (*part.standard_deviations, "advised")}
    found: Values = {}
    for column, name in names.items():
        found |= _error(accuracy, column, who, part.kind, name)
    return found


def _error(accuracy: Accuracy | None, column: str, *path: str) -> Values:
    """Return the numerical error of a column; nothing where none was asked for."""
    return {} if accuracy is None else {f"{column}_error": accuracy.of(*path)}


def _largest(values: Any) -> float:
    return float(values.max()) if len(values) else float("nan")
