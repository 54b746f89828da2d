"""Shape finding: the static state that meets tensions, heights and dropper data."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.threads import single_threaded
from tautwire.errors import ConvergenceError, ModelError
from tautwire.model.build import Model, arm_half_weight
from tautwire.model.mesh import CONTACT, MESSENGER
from tautwire.numerics.statics.form_finding import Form, FormProblem, find_form
from tautwire.results.equilibrium import Equilibrium
from tautwire.status import Status

Array = NDArray[Any]

RESIDUAL = 1e-4
_RIGID_DROPPER = 1e8
_SMALLEST_PULL = 10.0
_ACTIVE_SET_PASSES = 20


@single_threaded
def find_shape(model: Model) -> Equilibrium:
    """Find coordinates, unstrained lengths and support data of the static state.

    The longitudinal position of every wire node is given by the mesh, each wire's tension acts on
    its end; in height mode the dropper lengths follow from the pre-sag, in length mode the heights
    follow from the lengths (paper eqs. 6-7).

    Parameters
    ----------
    model
        The line.

    Returns
    -------
    Equilibrium

    Raises
    ------
    ConvergenceError
        When Newton's iteration fails.
    ModelError
        When a dropper or a steady arm would have to push; every one of them is named.
    """
    form, iterations = _solve(model)
    return _equilibrium(model, form, iterations)


def _solve(model: Model) -> tuple[Form, int]:
    """Run the shape finding that the dropper mode asks for."""
    droppers = model.case.droppers
    problem, spent = model.form, 0
    if droppers.mode == "height":
        form = _converged(problem)
        spent = form.newton.iterations
        _refuse_pushing_droppers(model, _dropper_forces(form))
        if not np.any(model.irregularities.dropper_length):
            return form, spent
        problem = _with_length_errors(model, form)
    elif droppers.length_kind == "stretched":
        problem, spent = _with_unstrained_lengths(problem)
    for _ in range(_ACTIVE_SET_PASSES):
        form = _converged(problem)
        spent += form.newton.iterations
        ties = form.system.ties
        taut = ties.state(form.system.position).length > ties.length
        if np.array_equal(taut, problem.taut):
            return form, spent
        problem = replace(problem, taut=taut, system=_restart(problem, form))
    raise ConvergenceError(
        "shape finding: the set of slack droppers does not settle; check droppers.lengths"
    )


def _with_length_errors(model: Model, form: Form) -> FormProblem:
    """Return the problem of the lengths that were found, with their errors of installation."""
    system = form.system
    ties = system.ties.of_length(system.ties.length + model.irregularities.dropper_length)
    given = system.with_(ties=ties, load=model.form.system.load)
    return replace(model.form, system=given, tie_slot=np.full(len(ties), -1))


def _with_unstrained_lengths(problem: FormProblem) -> tuple[FormProblem, int]:
    """Turn given stretched lengths into unstrained ones.

    The shape is first found with droppers that hardly stretch; their forces then give the
    elongation to take off.
    """
    ties = problem.system.ties
    count = len(ties)
    rigid = ties.with_(stiffness=np.full(count, _RIGID_DROPPER), axial=np.full(count, np.nan))
    form = _converged(replace(problem, system=problem.system.with_(ties=rigid)))
    force, length = _dropper_forces(form), form.system.ties.state(form.system.position).length
    unstrained = np.where(
        np.isnan(ties.axial), length - force / ties.stiffness, length / (1.0 + force / ties.axial)
    )
    system = problem.system.with_(
        position=form.system.position, cables=form.system.cables, ties=ties.of_length(unstrained)
    )
    return replace(problem, system=system), form.newton.iterations


def _restart(problem: FormProblem, form: Form) -> Any:
    return problem.system.with_(
        position=form.system.position, cables=form.system.cables, ties=form.system.ties
    )


def _converged(problem: FormProblem) -> Form:
    form = find_form(problem, RESIDUAL)
    newton = form.newton
    if newton.status is not Status.DONE:
        raise ConvergenceError(
            f"shape finding stopped after {newton.iterations} iterations with a residual of "
            f"{newton.residual:.3g} N. {newton.status.sentence} "
            "Check tensions, span lengths, encumbrance and dropper data for extreme values; "
            "'tautwire check' lists what the input says."
        )
    return form


def _dropper_forces(form: Form) -> Array:
    system = form.system
    length = system.ties.state(system.position).length
    return system.ties.stiffness * (length - system.ties.length)


def _refuse_pushing_droppers(model: Model, forces: Array) -> None:
    """Raise when a prescribed height asks a dropper to push."""
    mesh = model.mesh
    drops, errors = _presags(model), 1e3 * model.irregularities.dropper_height
    faults = [
        f"dropper {mesh.dropper_number[i]} of span {mesh.dropper_span[i]}, "
        f"x = {mesh.dropper_x[i]:.2f} m, would have to push ({forces[i]:.1f} N); "
        f"raise the contact wire there (droppers.presag, now {1e3 * drops[i]:.1f} mm; "
        "a few millimetres less are usually enough) or use length mode"
        for i in np.flatnonzero(forces < 0.0)
    ]
    if errors.any():
        faults = [
            f"{fault}; the drawn errors of height are {errors.min():.1f} to {errors.max():.1f} mm: "
            "make irregularities.installation smaller, give errors of length, or draw with another "
            "settings.seed"
            for fault in faults
        ]
    if faults:
        raise ModelError("\n".join(faults))


def _presags(model: Model) -> list[float]:
    values = model.case.droppers.presag_by_span(model.case.line.spans)
    return [v for span in values for v in span]


@dataclass(frozen=True)
class _ArmData:
    supports: NDArray[np.int64]
    forces: Array
    angles: Array
    ends: Array


def _equilibrium(model: Model, form: Form, iterations: int) -> Equilibrium:
    """Read lengths, forces and support data from a found form."""
    mesh, system = model.mesh, form.system
    reactions = form.reactions.reshape(-1, 2, 6)
    nodes = system.position.reshape(-1, 2, 2, 3)
    state = system.ties.state(system.position)
    forces = np.where(model.form.taut, _dropper_forces(form), 0.0)
    arms = _arm_data(model, form)
    inner = mesh.support_station[1:-1]
    spec = model.case.supports
    lift = reactions[inner, MESSENGER, 2]
    preloads = np.zeros(len(inner))
    if spec.closure == "spring":
        preloads = reactions[inner, CONTACT, 2]
    wires = (model.case.wires.contact, model.case.wires.messenger)
    return Equilibrium(
        position=system.position,
        cable_lengths=system.cables.length,
        station_x=mesh.x,
        dropper_span=mesh.dropper_span,
        dropper_number=mesh.dropper_number,
        dropper_x=mesh.dropper_x,
        dropper_lengths_unstrained=system.ties.length,
        dropper_lengths=state.length,
        dropper_forces=np.maximum(forces, 0.0),
        dropper_heights=nodes[mesh.dropper_station, CONTACT, 0, 2],
        support_x=mesh.support_x,
        support_heights=nodes[mesh.support_station, CONTACT, 0, 2],
        arm_supports=arms.supports,
        arm_forces=arms.forces,
        arm_angles=arms.angles,
        arm_ends=arms.ends,
        messenger_free_heights=nodes[inner, MESSENGER, 0, 2] + lift / spec.messenger_stiffness,
        contact_preloads=preloads,
        end_pulls=np.array([reactions[0, :, 0], [w.tension for w in wires]]),
        weight=_weight(model, form),
        reaction=_vertical_reaction(model, form, arms),
        iterations=iterations,
        residual=form.newton.residual,
    )


def _arm_data(model: Model, form: Form) -> _ArmData:
    """Place the far ends of the steady arms (or read the forces of given ones) and check them."""
    spec, mesh = model.case.supports, model.mesh
    if spec.closure == "spring":
        return _ArmData(np.empty(0, np.int64), np.empty(0), np.empty(0), np.empty((0, 3)))
    inner = mesh.support_station[1:-1]
    wire = form.system.position.reshape(-1, 2, 2, 3)[inner, CONTACT, 0]
    if spec.closure == "arm":
        ends = form.system.stays.end
        offset = ends - wire
        length = np.linalg.norm(offset, axis=1)
        force = form.system.stays.axial_force(length)
    else:
        pull = _arm_pull(model, form)
        force = np.linalg.norm(pull, axis=1)
        length = spec.arm.length * (1.0 + force / spec.arm.axial_stiffness)
        offset = pull * (length / np.where(force > 0.0, force, 1.0))[:, None]
        ends = wire + offset
    _refuse_bad_arms(model, force, np.abs(force * offset[:, 1] / spec.arm.length))
    angle = np.arctan2(offset[:, 2], np.abs(offset[:, 1]))
    return _ArmData(np.arange(2, len(inner) + 2), force, angle, ends)


def _arm_pull(model: Model, form: Form) -> Array:
    """Return the axial force of each arm on the wire, ``(n_arm, 3)`` [N]."""
    inner = model.mesh.support_station[1:-1]
    pull = form.reactions.reshape(-1, 2, 6)[inner, CONTACT, :3].copy()
    pull[:, 0] = 0.0
    if model.case.supports.closure == "lift":
        pull[:, 2] = model.case.supports.lift
    pull[:, 2] += arm_half_weight(model.case)
    return pull


def _refuse_bad_arms(model: Model, force: Array, lateral: Array) -> None:
    """Raise when a steady arm would push or has nothing to hold."""
    mesh = model.mesh
    faults = []
    for i in np.flatnonzero((force <= 0.0) | (lateral < _SMALLEST_PULL)):
        what = (
            f"would have to push ({force[i]:.1f} N)"
            if force[i] < 0.0
            else f"pulls sideways with only {lateral[i]:.1f} N"
        )
        faults.append(
            f"the steady arm at support {i + 2}, x = {mesh.support_x[i + 1]:.2f} m, {what}; "
            "give the contact wire more stagger there (supports.contact_stagger), put the arm's "
            "far end on the other side, or use closure 'spring'"
        )
    if faults:
        raise ModelError("\n".join(faults))


def _weight(model: Model, form: Form) -> float:
    """Return the weight of everything that hangs on the supports [N]."""
    case, system = model.case, form.system
    weight = float(system.cables.mass @ system.cables.length) + float(system.node_mass.sum())
    weight += case.droppers.mass * float(system.ties.length.sum())
    total = weight * case.line.gravity
    if case.supports.closure != "spring":
        total += 2.0 * arm_half_weight(case) * (len(model.mesh.support_station) - 2)
    return total


def _vertical_reaction(model: Model, form: Form, arms: _ArmData) -> float:
    """Return the sum of the vertical forces from anchors, springs and far ends of the arms [N]."""
    reactions = form.reactions.reshape(-1, 2, 6)[:, :, 2]
    inner = model.mesh.support_station[1:-1]
    total = float(reactions[[0, -1]].sum()) + float(reactions[inner, MESSENGER].sum())
    if model.case.supports.closure == "spring":
        return total + float(reactions[inner, CONTACT].sum())
    pull = float((arms.forces * np.sin(arms.angles)).sum())
    return total + pull + arm_half_weight(model.case) * len(inner)
