"""How to compute: contact, mesh, time integration, analysed section."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from tautwire.specs.base import Problem, Quantity, Spec, Typical, refuse
from tautwire.specs.step_control import Method as StepMethod
from tautwire.specs.step_control import StepControl

Method = Literal["newmark", "hht", "extrapolated"]
SpanNumber = Annotated[int, Field(ge=1, strict=True)]
HHT_ALPHA = -0.05
"""The mildest of the values in use (-0.05 to -0.3): it takes 1.4 % of the energy per period at 10
steps to a period, 0.2 % at 20."""
COARSEST_STEP = 1e-3
"""Longest time step that the program chooses [s]: that of the published models of AC simple."""
STEPS_PER_PERIOD = 5.0
"""Time steps per period of the highest frequency of the band: on lines of public data halving the
step of 1 ms moves the standard deviation up to 200 Hz by at most 0.8 %, although vibrations of
200 Hz themselves become 12 % slower."""
FEWEST_GRADED = 6
"""Nodes between attachment points that a graded mesh needs: both, four near them, none between."""
USUAL_CONTACT_STIFFNESS = 50e3
"""[N/m]: reference model of EN 50318:2002 and, with hinged arms, the benchmark of 2015 without
calibration (theory page)."""
NOT_GIVEN = "Not given"
"""Beginning of the source of a value that the program chose because the input has none."""


class Integrator(Spec):
    """Time integration: Newmark (average acceleration), HHT-alpha, or Newmark extrapolated."""

    method: Method = Field(
        default="newmark",
        description="'newmark' (gamma 1/2, beta 1/4), 'hht' (damps frequencies that the time step "
        "does not resolve) or 'extrapolated' (Newmark with half and quarter steps, of fourth "
        "order; five times the cost).",
    )
    alpha: Annotated[float, Quantity("", ge=-1.0 / 3.0, le=0.0, typical="-0.05")] = Field(
        default=0.0, description="Parameter of 'hht', -1/3 to 0; 0 is Newmark."
    )

    @model_validator(mode="before")
    @classmethod
    def _default_alpha(cls, data: Any) -> Any:
        if isinstance(data, dict) and data.get("method") == "hht" and "alpha" not in data:
            return {**data, "alpha": HHT_ALPHA}
        return data

    @model_validator(mode="after")
    def _check_alpha(self) -> Integrator:
        if self.method != "hht" and self.alpha != 0.0:
            refuse([Problem(("alpha",), f"got {self.alpha:g}; it belongs to 'method: hht' only")])
        return self


def _integrator_from_word(value: Any) -> Any:
    return {"method": value} if isinstance(value, str) else value


def _step_control_from_word(value: Any) -> Any:
    return {"method": value} if isinstance(value, str) else value


class Settings(Spec):
    """Numerical choices; every one is recorded in the results."""

    contact_stiffness: Annotated[
        float, Quantity("N/m", gt=0.0, le=1e9, typical="50 to 200 kN/m")
    ] = Field(
        default=USUAL_CONTACT_STIFFNESS,
        description="Stiffness of the penalty contact between head and wire, a property of the "
        "model rather than of a line. If left out, that of the reference model of EN 50318:2002; a "
        "warning says so.",
    )
    band: Annotated[float, Quantity("Hz", ge=20.0, le=2000.0, typical="200 Hz")] = Field(
        default=200.0,
        description="Highest frequency that mesh and time step carry: the longest element is half "
        "of the wave of this frequency ahead of the head, where mesh and step are not given.",
    )
    nodes_between_droppers: (
        Annotated[int, Field(ge=2, le=200, strict=True), Typical("9 or 15, as in publications")]
        | None
    ) = Field(
        default=None,
        description="Nodes from one attachment point (dropper, support) to the next, both counted "
        "(NAD), in place of a mesh for the band.",
    )
    graded_mesh: Annotated[bool, Field(strict=True)] | None = Field(
        default=None,
        description="Whether nodes gather at 0.15 and 0.5 m from every attachment point, where "
        "point loads bend the wire. If left out, a mesh for the band is graded and one of "
        "nodes_between_droppers, which needs 6 of them for it, is not.",
    )
    longest_element: (
        Annotated[float, Quantity("m", ge=0.02, le=50.0, typical="0.5 to 1 m")] | None
    ) = Field(
        default=None,
        description="Longest wire element, where it is to be shorter than the band or "
        "nodes_between_droppers ask for.",
    )
    time_step: Annotated[float, Quantity("s", gt=0.0, le=0.1, typical="1 ms")] | None = Field(
        default=None,
        description="Time step; with a step control other than 'constant', sampling interval. If "
        "left out, a fifth of a period of the band, at most 1 ms.",
    )
    section: tuple[SpanNumber, SpanNumber] | None = Field(
        default=None,
        description="First and last span of the analysed section, [first, last]. If left out, up "
        "to 3 spans at the start and 4 at the end of the line are not analysed.",
    )
    elasticity_force: Annotated[float, Quantity("N", gt=0.0, le=1e4, typical="100 N")] = Field(
        default=100.0, description="Vertical force at which the elasticity is evaluated."
    )
    integrator: Annotated[
        Integrator,
        BeforeValidator(_integrator_from_word, json_schema_input_type=Method | Integrator),
    ] = Field(
        default=Integrator(),
        description="Time integration: 'newmark', 'hht', 'extrapolated' or {method: hht, alpha: "
        "-0.05}.",
    )
    seed: Annotated[int, Field(ge=0, le=2**32 - 1, strict=True), Typical("0")] = Field(
        default=0, description="Seed of everything random."
    )
    tolerance: Annotated[float, Quantity("m", ge=1e-12, le=1e-3, typical="3e-8 m")] = Field(
        default=3e-8,
        description="Largest displacement increment of a converged time step, or what the rounding "
        "of coordinates leaves when that is more.",
    )
    start: Annotated[float, Quantity("m", ge=0.0, le=1e5, typical="5 m")] = Field(
        default=5.0,
        description="Distance from the anchor at which the leading pantograph starts; further "
        "where the wires of the end spans lie beside the heads.",
    )
    ramp: Annotated[float, Quantity("s", ge=0.0, le=100.0, typical="0.5 s")] = Field(
        default=0.5, description="Time over which the uplift force grows from 0 to its value."
    )
    filter: Literal["sharp", "butterworth"] = Field(
        default="sharp",
        description="Low-pass of the headline figures; both are always evaluated and named.",
    )
    filter_order: Annotated[int, Field(ge=1, le=12, strict=True), Typical("6")] = Field(
        default=6, description="Order of the Butterworth filter, applied forward and backward."
    )
    step_control: Annotated[
        StepControl,
        BeforeValidator(_step_control_from_word, json_schema_input_type=StepMethod | StepControl),
    ] = Field(
        default=StepControl(),
        description="Step control: 'constant', 'variable', 'adaptive', or one of them with its "
        "tolerance: {method: adaptive, duration_tolerance: 0.2 ms}.",
    )
    store_shapes: Annotated[bool, Field(strict=True)] = Field(
        default=False, description="Store the full shape of both wires over time."
    )
    error: Literal["none", "estimate", "bound"] = Field(
        default="none",
        description="Numerical error of every statistic, from mesh and step: 'estimate' (one "
        "coarser passage beside the run) or 'bound' (two, and wider).",
    )
    backend: Literal["auto", "native", "reference"] = Field(
        default="auto", description="Kernels to compute with; 'auto' takes the fastest available."
    )

    @model_validator(mode="after")
    def _check_mesh(self) -> Settings:
        nodes = self.nodes_between_droppers
        if self.graded_mesh and nodes is not None and nodes < FEWEST_GRADED:
            text = f"needs nodes_between_droppers of at least {FEWEST_GRADED}"
            refuse([Problem(("graded_mesh",), text)])
        return self

    @model_validator(mode="after")
    def _check_section(self) -> Settings:
        if self.section is not None and self.section[0] > self.section[1]:
            refuse(
                [
                    Problem(
                        ("section",),
                        f"got [{self.section[0]}, {self.section[1]}]; write [first, last] span",
                    )
                ]
            )
        return self

    def step(self) -> float:
        """Return the time step [s], given or for the band."""
        if self.time_step is not None:
            return self.time_step
        return min(COARSEST_STEP, 1.0 / (STEPS_PER_PERIOD * self.band))

    def is_graded(self) -> bool:
        """Return whether nodes gather at attachment points."""
        if self.graded_mesh is not None:
            return self.graded_mesh
        return self.nodes_between_droppers is None

    def mesh(self) -> str:
        """Return in words how the wires are divided."""
        nodes = self.nodes_between_droppers
        if nodes is None:
            words = f"for 0-{self.band:g} Hz"
            graded = "" if self.is_graded() else ", even"
        else:
            words, graded = f"NAD {nodes}", ", graded" if self.is_graded() else ""
        finest = "" if self.longest_element is None else f", at most {self.longest_element:g} m"
        return words + graded + finest

    def resolved_section(self, spans: int) -> tuple[int, int]:
        """Return the first and the last analysed span of a line of ``spans``, from 1."""
        if self.section is not None:
            return self.section
        at_start = min(3, (spans - 1) // 3)
        at_end = min(4, (spans - 1) // 3)
        return at_start + 1, spans - at_end
