"""Step control: how time steps follow what happens at the contact."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from tautwire.specs.base import Problem, Quantity, Spec, Typical, refuse

Method = Literal["constant", "variable", "adaptive"]
GapTolerance = Annotated[float, Quantity("m", gt=0.0, le=1e-2, typical="0.1 mm")]
ForceTolerance = Annotated[float, Quantity("N", gt=0.0, le=1e3, typical="5 N")]
DurationTolerance = Annotated[float, Quantity("s", gt=0.0, le=1e-2, typical="0.2 ms")]

_BELONGS = {
    "gap_tolerance": "variable",
    "force_tolerance": "variable",
    "duration_tolerance": "adaptive",
}


class StepControl(Spec):
    """How time steps follow losses of contact; settings.time_step stays the sampling interval."""

    method: Method = Field(
        default="constant",
        description="'constant'; 'variable' (steps end where contact opens or closes); 'adaptive' "
        "(steps are refined around losses of contact until their durations settle).",
    )
    gap_tolerance: GapTolerance | None = Field(
        default=None,
        description="Variable: gap at which a change of contact counts as met; 0.1 mm if neither "
        "tolerance is given.",
    )
    force_tolerance: ForceTolerance | None = Field(
        default=None, description="Variable: the same as a contact force; replaces gap_tolerance."
    )
    duration_tolerance: DurationTolerance | None = Field(
        default=None,
        description="Adaptive: error of the duration of a loss that is aimed at; 0.2 ms if left "
        "out.",
    )
    corrects_waves: Annotated[bool, Field(strict=True)] = Field(
        default=True,
        description="Make up for the loss of wave speed by the time step, at no cost; false is "
        "the plain scheme.",
    )
    most_losses: Annotated[int, Field(ge=1, le=100_000, strict=True), Typical("500")] = Field(
        default=500,  # some hundred times what a line has that is fit for service
        description="Variable, adaptive: losses per pantograph after which the run stops.",
    )

    @model_validator(mode="before")
    @classmethod
    def _as_stored_before(cls, data: Any) -> Any:
        """Read null, of which stored runs are full: it once meant with the adaptive step alone."""
        if isinstance(data, dict) and data.get("corrects_waves", True) is None:
            return {**data, "corrects_waves": data.get("method") == "adaptive"}
        return data

    @model_validator(mode="after")
    def _check_tolerances(self) -> StepControl:
        problems = [
            Problem((name,), f"belongs to 'method: {method}', not to '{self.method}'")
            for name, method in _BELONGS.items()
            if getattr(self, name) is not None and method != self.method
        ]
        if self.gap_tolerance is not None and self.force_tolerance is not None:
            problems.append(Problem(("force_tolerance",), "is given with gap_tolerance; keep one"))
        refuse(problems)
        return self
