"""What exists and what is chosen: frozen, validated descriptions in SI units."""

from tautwire.specs.case import Case, Source
from tautwire.specs.line.catenary import Damping, Ends, Line
from tautwire.specs.line.dropper import Droppers, DropperStiffness
from tautwire.specs.line.fitting import Body, Stay
from tautwire.specs.line.irregularity import Installation, Irregularities, Unevenness
from tautwire.specs.line.support import Arm, Supports, SupportSpring
from tautwire.specs.line.wire import Wire, Wires
from tautwire.specs.pantograph import Pantograph, RoofMotion, Stage
from tautwire.specs.scenario import MeanForceLaw, Scenario
from tautwire.specs.schema.json_schema import case_json_schema
from tautwire.specs.settings import Integrator, Settings
from tautwire.specs.step_control import StepControl

__all__ = [
    "Arm",
    "Body",
    "Case",
    "Damping",
    "DropperStiffness",
    "Droppers",
    "Ends",
    "Installation",
    "Integrator",
    "Irregularities",
    "Line",
    "MeanForceLaw",
    "Pantograph",
    "RoofMotion",
    "Scenario",
    "Settings",
    "Source",
    "Stage",
    "Stay",
    "StepControl",
    "SupportSpring",
    "Supports",
    "Unevenness",
    "Wire",
    "Wires",
    "case_json_schema",
]
