"""The case: everything that defines one simulation."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from tautwire.specs.base import LIST, MAPPING, Spec, Typical, form_of, refuse
from tautwire.specs.checks import find_contradictions
from tautwire.specs.conditions.condition import Condition
from tautwire.specs.line.catenary import Line
from tautwire.specs.line.dropper import Droppers
from tautwire.specs.line.fitting import Body, Stay
from tautwire.specs.line.irregularity import Irregularities
from tautwire.specs.line.support import Supports
from tautwire.specs.line.tension import Overlap, TensionLength
from tautwire.specs.line.track import Track, TrackInput
from tautwire.specs.line.wire import Wires
from tautwire.specs.line.workshop import Workshop
from tautwire.specs.pantograph import Name, Pantograph
from tautwire.specs.project import Project
from tautwire.specs.requirements import Requirements
from tautwire.specs.scenario import Scenario
from tautwire.specs.schema.upgrade import upgraded
from tautwire.specs.settings import Settings
from tautwire.text import Told

UNHASHED = ("project", "limits", "workshop")
"""Keys that change no number of a result and are left out of its hash."""
MOST_LIMITS = 200_000
"""Letters of a file of limits, which stands in every result: that of the package has 15 kB."""
Confidence = Literal["two sources", "one source", "derived", "memory", "calibrated", "choice"]


class Source(Spec):
    """Where a number of the case comes from."""

    path: Annotated[str, Typical("wires.contact.tension")] = Field(
        min_length=1, description="Path of the value, or of a group of values."
    )
    source: str = Field(min_length=1, description="Document, data set or reasoning.")
    confidence: Confidence = Field(
        description="'two sources', 'one source', 'derived' (computed from sourced values), "
        "'memory' (remembered, no document at hand), 'calibrated' (fitted to results) or 'choice'."
    )
    template: Annotated[str, Typical("ac-simple")] = Field(
        default="",
        description="Case or template from which the number was taken over without a check for "
        "this line; empty when it was given for it.",
    )


class Case(Told, Spec):
    """One simulation: line, wires, supports, droppers, pantographs, scenario, settings."""

    schema_version: Annotated[Literal[2], Typical("2")] = Field(
        default=2, alias="schema", description="Version of the input format; 1 is read too."
    )
    name: Annotated[Name, Typical("my-line")] = Field(
        description="Short name, used in results and file names."
    )
    title: Annotated[str, Field(max_length=200)] = Field(
        default="", description="One line for the report."
    )
    description: str = Field(default="", description="Free text for the report.")
    project: Project = Field(
        default=Project(),
        description="The project block of every page: client, revision, who checked it, logo.",
    )
    limits: Annotated[str, Field(max_length=MOST_LIMITS), Typical("our-limits.yaml")] = Field(
        default="",
        description="File of your own limits, begun with 'tautwire limits --copy', seen from the "
        "file that names it; what it says is kept in the results. Those of the package if left "
        "out.",
    )
    track: TrackInput = Field(
        default=Track(),
        description="The track: a list of straights, transitions and arcs, columns over the "
        "chainage, a profile of gradients; straight and level if left out.",
    )
    line: Line = Field(description="Spans, wire ends and damping.")
    wires: Wires = Field(description="The wires.")
    supports: Supports = Field(description="Where and how the wires are held.")
    droppers: Annotated[
        Annotated[Droppers, Tag(MAPPING)] | Annotated[tuple[Droppers, ...], Tag(LIST)],
        Discriminator(form_of),
    ] = Field(
        description="The droppers: one set, or a list of sets; none for a contact wire alone."
    )
    tension_lengths: tuple[TensionLength, ...] = Field(
        default=(),
        description="Tension lengths from left to right; a single one over all supports, with "
        "line.ends, if left out.",
    )
    overlaps: tuple[Overlap, ...] = Field(
        default=(),
        description="How neighbouring tension lengths overlap, from left to right: one overlap for "
        "all, or one each.",
    )
    bodies: tuple[Body, ...] = Field(
        default=(),
        description="Bodies in the line of wires: splices, insulators, section insulators.",
    )
    stays: tuple[Stay, ...] = Field(
        default=(),
        description="Ropes, bars and struts that hold wires sideways or along the track.",
    )
    pantographs: tuple[Pantograph, ...] = Field(
        min_length=1, max_length=20, description="The pantographs of the train, leading one first."
    )
    irregularities: Irregularities = Field(
        default=Irregularities(),
        description="Irregularities of the contact wire; none if left out.",
    )
    conditions: tuple[Condition, ...] = Field(
        default=(),
        description="States of the line other than its design: weather, wear, defects.",
    )
    condition: str | None = Field(
        default=None,
        description="Name of the condition in which the line is examined; the design if left out.",
    )
    requirements: Requirements = Field(
        default=Requirements(),
        description="What the line has to keep in its design and in all conditions; nothing if "
        "left out.",
    )
    workshop: Workshop = Field(
        default=Workshop(),
        description="How droppers are cut and counted; it changes no result of the line.",
    )
    scenario: Scenario = Field(description="Speed, direction and uplift force.")
    settings: Settings = Field(
        default=Settings(), description="Numerical choices and analysed section."
    )
    sources: tuple[Source, ...] = Field(
        default=(), description="Where the numbers come from, shown in the report."
    )

    @model_validator(mode="before")
    @classmethod
    def _upgrade(cls, data: Any) -> Any:
        if not isinstance(data, Mapping):
            return data
        data, wires = upgraded(data), data.get("wires")
        if isinstance(wires, Mapping) and not wires.get("messenger"):
            data.setdefault("droppers", [])
        return data

    @model_validator(mode="after")
    def _check_parts_together(self) -> Case:
        refuse(find_contradictions({name: getattr(self, name) for name in type(self).model_fields}))
        return self

    @property
    def dropper_sets(self) -> tuple[Droppers, ...]:
        """All sets of droppers."""
        return self.droppers if isinstance(self.droppers, tuple) else (self.droppers,)

    def with_condition(self, name: str | None) -> Case:
        """Return the case with another condition chosen; None chooses the design."""
        return self.with_(condition=name)

    @property
    def chosen_condition(self) -> Condition | None:
        """The condition in which the line is examined; None for the design."""
        return next((one for one in self.conditions if one.name == self.condition), None)

    def facts(self) -> dict[str, str]:
        """Return line, wires, pantographs and speed in words."""
        spans = self.line.span_lengths()
        lengths = f"{min(spans):g} m" if min(spans) == max(spans) else (
            f"{min(spans):g} to {max(spans):g} m"
        )  # fmt: skip
        wires = (f"{name} {1e-3 * wire.tension:g} kN" for name, wire in self.wires.named())
        count = len(self.pantographs)
        return {
            "name": f"{self.name}, {self.title}" if self.title else self.name,
            "line": f"{self.line.spans} spans of {lengths}",
            "wires": ", ".join(wires),
            "condition": self.condition or "as designed",
            "pantographs": f"{count} at {3.6 * self.scenario.speed:g} km/h",
        }

    def hash(self) -> str:
        """Return the SHA-256 of the case in canonical form, as 64 hexadecimal digits.

        Of all but what no number depends on: a result that somebody has signed stays the same.
        """
        told = {key: value for key, value in self.to_dict().items() if key not in UNHASHED}
        text = json.dumps(told, sort_keys=True, separators=(",", ":"), allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()

    def resolved_section(self) -> tuple[int, int]:
        """Return the first and the last analysed span, numbered from 1."""
        return self.settings.resolved_section(self.line.spans)

    def uplift_forces(self) -> tuple[float, ...]:
        """Return the uplift force of each pantograph [N]: prescribed, or the first guess.

        With a mean force to tune to and no ``uplift_guess``, the guess is that mean force.
        """
        scenario = self.scenario
        target = scenario.target_mean_force()
        given = scenario.uplift_force if target is None else (scenario.uplift_guess or target)
        if isinstance(given, tuple):
            return given
        if given is not None:
            return (given,) * len(self.pantographs)
        return tuple(pantograph.uplift_force(scenario.air) for pantograph in self.pantographs)

    def uplift_space(self) -> float | None:
        """Return the free space for uplift at the supports [m], None when nobody says it.

        It is what the requirements state, or else the smallest gap of an uplift stop.
        """
        if self.requirements.uplift_space is not None:
            return self.requirements.uplift_space
        gaps = (kind.stop.gap for kind in self.supports.kinds() if kind.stop is not None)
        return min(gaps, default=None)
