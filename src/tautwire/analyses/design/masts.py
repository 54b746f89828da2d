"""All states of a line as those who build its masts and install its cantilevers read them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from tautwire.analyses.design.kept import Clearance, clearances, exceeded
from tautwire.analyses.design.supports import (
    Installed,
    SupportForce,
    installation,
    support_forces,
    temperatures,
)
from tautwire.analyses.design.tensions import TensionProfile, tension_profiles
from tautwire.model.build import Model
from tautwire.plain import Plain, named
from tautwire.results.design.conditions import ConditionState
from tautwire.text import DESIGN


@dataclass(frozen=True)
class MastState(Plain):
    """What masts carry in one state of the line.

    Attributes
    ----------
    condition : str
        ``"design"`` for the line without one.
    forces : tuple of SupportForce
    tensions : tuple of TensionProfile
        Along the line.
    clearances : tuple of Clearance
        From the structures over the line.
    exceeded : tuple of str
        Requirements that are not kept, with their places.
    """

    condition: str
    forces: tuple[SupportForce, ...]
    tensions: tuple[TensionProfile, ...]
    clearances: tuple[Clearance, ...]
    exceeded: tuple[str, ...]


@dataclass(frozen=True)
class Masts(Plain):
    """All states of a line for the design of masts.

    Attributes
    ----------
    states : tuple of MastState
    temperatures : tuple of float degC
        Of the conditions that say one, the coldest first.
    conditions : tuple of str
        Names of these conditions.
    installation : tuple of Installed
        With one offset per temperature.
    """

    states: tuple[MastState, ...]
    temperatures: tuple[float, ...] = field(metadata=named("temperatures_degc"))
    conditions: tuple[str, ...]
    installation: tuple[Installed, ...]

    @property
    def exceeded(self) -> tuple[tuple[str, str], ...]:
        """Conditions and what is not kept in them."""
        return tuple((one.condition, text) for one in self.states for text in one.exceeded)


def masts_of(model: Model, states: Sequence[ConditionState]) -> Masts:
    """Return forces on supports, distances and the installation table of some states.

    Parameters
    ----------
    model
        The line.
    states
        Those that cannot be are left out.
    """
    warm = temperatures(states)
    degrees = [one.shape.operated.condition.temperature for one in warm if one.shape is not None
               and one.shape.operated is not None]  # fmt: skip
    return Masts(
        states=tuple(_state(model, one) for one in states if one.shape is not None),
        temperatures=tuple(value for value in degrees if value is not None),
        conditions=tuple(one.name for one in warm),
        installation=installation(model, warm) if warm else (),
    )


def _state(model: Model, state: ConditionState) -> MastState:
    assert state.shape is not None
    name = None if state.name == DESIGN else state.name
    own = replace(model, case=model.case.with_condition(name))
    forces, distances = support_forces(own, state.shape), clearances(own, state.shape)
    tensions, unkept = tension_profiles(own, state.shape), exceeded(own, forces, distances)
    return MastState(state.name, forces, tensions, distances, unkept)
