"""Simulation of the dynamic interaction between railway pantographs and overhead contact lines.

The public names below are imported when they are first used, so that ``import tautwire`` costs
next to nothing.

Examples
--------
>>> import tautwire as tw
>>> case = tw.load_case("ac-simple")
>>> case.line.spans
17
"""

from importlib import import_module
from typing import TYPE_CHECKING

from tautwire.results.accessors import register
from tautwire.version import __version__

if TYPE_CHECKING:
    from tautwire.analyses.force.contact_loss import contact_loss
    from tautwire.analyses.force.loss_comparison import compare_losses
    from tautwire.analyses.force.statistics import contact_statistics
    from tautwire.analyses.road.dynamics import iterate, simulate
    from tautwire.analyses.road.elasticity import elasticity
    from tautwire.analyses.road.operate import operate
    from tautwire.analyses.road.pipeline import run
    from tautwire.analyses.road.shape import find_shape
    from tautwire.analyses.survey.as_built import as_built
    from tautwire.analyses.survey.rank import rank, rank_lines
    from tautwire.analyses.vibration.modes import modes
    from tautwire.assessment.comparison.measurement import compare_with_measurement
    from tautwire.errors import ConvergenceError, InputError, ModelError, TautwireError
    from tautwire.inputs.book.case_book import write_workbook
    from tautwire.inputs.load import load_case
    from tautwire.inputs.reading.recording import load_recording
    from tautwire.inputs.reading.survey import load_survey
    from tautwire.model.build import Model, build
    from tautwire.numerics.events.refinement import AdaptiveStep
    from tautwire.numerics.events.step_control import ConstantStep, VariableStep
    from tautwire.numerics.newmark import HHT, Extrapolated, Newmark
    from tautwire.report.layout_plan.plan import layout_plan
    from tautwire.report.pages.run_page import write_report
    from tautwire.results.equilibrium import Equilibrium
    from tautwire.results.run import Run
    from tautwire.results.storage import (
        load_equilibrium,
        load_run,
        save_equilibrium,
        save_run,
    )
    from tautwire.signals.filters import Butterworth, SharpLowpass
    from tautwire.specs.case import Case
    from tautwire.studies.run import run_study
    from tautwire.studies.study_file import load_study

__all__ = [
    "HHT",
    "AdaptiveStep",
    "Butterworth",
    "Case",
    "ConstantStep",
    "ConvergenceError",
    "Equilibrium",
    "Extrapolated",
    "InputError",
    "Model",
    "ModelError",
    "Newmark",
    "Run",
    "SharpLowpass",
    "TautwireError",
    "VariableStep",
    "__version__",
    "as_built",
    "build",
    "compare_losses",
    "compare_with_measurement",
    "contact_loss",
    "contact_statistics",
    "elasticity",
    "find_shape",
    "iterate",
    "layout_plan",
    "load_case",
    "load_equilibrium",
    "load_recording",
    "load_run",
    "load_study",
    "load_survey",
    "modes",
    "operate",
    "rank",
    "rank_lines",
    "run",
    "run_study",
    "save_equilibrium",
    "save_run",
    "simulate",
    "write_report",
    "write_workbook",
]

_HOMES = {
    "AdaptiveStep": "tautwire.numerics.events.refinement",
    "Butterworth": "tautwire.signals.filters",
    "Case": "tautwire.specs.case",
    "ConstantStep": "tautwire.numerics.events.step_control",
    "ConvergenceError": "tautwire.errors",
    "Equilibrium": "tautwire.results.equilibrium",
    "Extrapolated": "tautwire.numerics.newmark",
    "HHT": "tautwire.numerics.newmark",
    "InputError": "tautwire.errors",
    "Model": "tautwire.model.build",
    "ModelError": "tautwire.errors",
    "Newmark": "tautwire.numerics.newmark",
    "Run": "tautwire.results.run",
    "SharpLowpass": "tautwire.signals.filters",
    "TautwireError": "tautwire.errors",
    "VariableStep": "tautwire.numerics.events.step_control",
    "as_built": "tautwire.analyses.survey.as_built",
    "build": "tautwire.model.build",
    "compare_losses": "tautwire.analyses.force.loss_comparison",
    "compare_with_measurement": "tautwire.assessment.comparison.measurement",
    "contact_loss": "tautwire.analyses.force.contact_loss",
    "contact_statistics": "tautwire.analyses.force.statistics",
    "elasticity": "tautwire.analyses.road.elasticity",
    "find_shape": "tautwire.analyses.road.shape",
    "iterate": "tautwire.analyses.road.dynamics",
    "layout_plan": "tautwire.report.layout_plan.plan",
    "load_case": "tautwire.inputs.load",
    "load_equilibrium": "tautwire.results.storage",
    "load_recording": "tautwire.inputs.reading.recording",
    "load_run": "tautwire.results.storage",
    "load_study": "tautwire.studies.study_file",
    "load_survey": "tautwire.inputs.reading.survey",
    "modes": "tautwire.analyses.vibration.modes",
    "operate": "tautwire.analyses.road.operate",
    "rank": "tautwire.analyses.survey.rank",
    "rank_lines": "tautwire.analyses.survey.rank",
    "run": "tautwire.analyses.road.pipeline",
    "run_study": "tautwire.studies.run",
    "save_equilibrium": "tautwire.results.storage",
    "save_run": "tautwire.results.storage",
    "simulate": "tautwire.analyses.road.dynamics",
    "write_report": "tautwire.report.pages.run_page",
    "write_workbook": "tautwire.inputs.book.case_book",
}

register("plot", "tautwire.report.pages.notebook", "RunPlots")


def __getattr__(name: str) -> object:
    """Import a public name when it is first used (PEP 562)."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """List the public names, loaded or not."""
    return sorted(__all__)
