"""Shape finding: the static state that meets tensions, heights and dropper data."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.road.faults import (
    refuse_bad_arms,
    refuse_crossing_wires,
    refuse_pushing_droppers,
)
from tautwire.analyses.road.operate import operate
from tautwire.analyses.threads import single_threaded
from tautwire.errors import ConvergenceError
from tautwire.line.closures import Held
from tautwire.line.pieces import GivenLength
from tautwire.model.build import Model
from tautwire.model.mesh import Mesh
from tautwire.model.registrations import held_registrations
from tautwire.numerics.statics.form_finding import Form, FormProblem, find_form
from tautwire.results.equilibrium import Equilibrium
from tautwire.status import Status

Array = NDArray[Any]

RESIDUAL = 1e-4
"""Largest force out of balance [N]: a ten-millionth of the weight of a span; Newton's last step
leaves some 1e-8 N, where the rounding of EA times strain begins."""
_RIGID_DROPPER = 1e8
"""Stiffness of droppers that hardly stretch [N/m]: 100 N stretch one by a micrometre."""
_ACTIVE_SET_PASSES = 40
"""Most passes in search of the slack droppers; each changes at least one, few are slack at rest."""
_JOINT_PASSES = 8
"""Passes in which every dropper that is in the wrong state changes; sets that settle do so in two
or three. Beyond that only the one that is furthest off changes: neighbours take each other's
load, and changed together they may swap states for ever."""


def find_shape(model: Model) -> Equilibrium:
    """Find the static state of a line in the condition that its case has chosen.

    That is its design, and with ``case.condition`` what the condition makes of it.

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
        When a dropper or a steady arm would have to push, a wire is slack or wires cross; every
        place is named.
    """
    return operate(model, find_design(model))


@single_threaded
def find_design(model: Model) -> Equilibrium:
    """Find coordinates, unstrained lengths and support data of the line as designed.

    The place of every wire node along the track is given by the mesh, each wire's tension acts on
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
        When a dropper or a steady arm would have to push, or wires cross; all are named.
    """
    form, iterations = solve_design(model)
    shape = _equilibrium(model, form, iterations)
    refuse_crossing_wires(model, shape)
    return shape


def find_cut(model: Model, lengths: Array) -> Equilibrium:
    """Find the line as designed with droppers of other lengths.

    Parameters
    ----------
    model
        The line.
    lengths : (n_dropper,) m
        Unstrained; droppers that would have to push are slack.

    Returns
    -------
    Equilibrium

    Raises
    ------
    ConvergenceError
        When Newton's iteration fails or the slack droppers do not settle.
    """
    design, spent = solve_design(model)
    _, form, more = with_slack(with_lengths(model, design, lengths))
    return _equilibrium(model, form, spent + more)


def solve_design(model: Model) -> tuple[Form, int]:
    """Find the shape with the heights and lengths that are given."""
    given = [h.given for h in model.line.hangers if isinstance(h.given, GivenLength)]
    problem, spent = model.form, 0
    if not given:
        form = _converged(problem)
        spent = form.newton.iterations
        refuse_pushing_droppers(model, _dropper_forces(form))
        if not np.any(model.irregularities.dropper_length):
            return form, spent
        lengths = form.system.ties.length + model.irregularities.dropper_length
        problem = with_lengths(model, form, lengths)
    elif any(length.is_stretched for length in given):
        problem, spent = _with_unstrained_lengths(problem)
    problem, form, more = with_slack(problem)
    refuse_pushing_droppers(model, np.where(problem.tie_slot < 0, 0.0, _dropper_forces(form)))
    return form, spent + more


def with_slack(problem: FormProblem) -> tuple[FormProblem, Form, int]:
    """Find a shape in which the droppers that would have to push are slack.

    Parameters
    ----------
    problem
        ``taut`` is the first guess of those that carry.

    Returns
    -------
    problem : FormProblem
        With the droppers that carry in ``taut``.
    form : Form
    iterations : int

    Raises
    ------
    ConvergenceError
        When Newton's iteration fails or the slack droppers do not settle.
    """
    spent = 0
    for number in range(_ACTIVE_SET_PASSES):
        form = _converged(problem)
        spent += form.newton.iterations
        ties = form.system.ties
        apart = ties.state(form.system.position).length - ties.length
        taut = apart > 0.0
        if np.array_equal(taut, problem.taut):
            return problem, form, spent
        if number >= _JOINT_PASSES:
            furthest = np.argmax(np.where(taut != problem.taut, np.abs(apart), 0.0))
            taut = problem.taut ^ (np.arange(len(taut)) == furthest)
        problem = replace(problem, taut=taut, system=_restart(problem, form))
    raise ConvergenceError(
        "shape finding: the set of slack droppers does not settle; check droppers.lengths"
    )


def with_lengths(model: Model, form: Form, lengths: Array) -> FormProblem:
    """Return the problem in which all dropper lengths are given, a found shape as its guess.

    Parameters
    ----------
    model
    form
        Of the same line.
    lengths : (n_dropper,) m
        Unstrained.
    """
    system = form.system
    given = system.with_(ties=system.ties.of_length(lengths), load=model.form.system.load)
    return replace(model.form, system=given, tie_slot=np.full(len(lengths), -1))


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
    unstrained = np.where(problem.tie_slot < 0, unstrained, form.system.ties.length)
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


def _equilibrium(model: Model, form: Form, iterations: int) -> Equilibrium:
    """Read lengths, forces and support data from a found form."""
    mesh, line, system = model.mesh, model.line, form.system
    held = held_registrations(line, mesh, system.position, form.reactions, model.case.line.gravity)
    refuse_bad_arms(model, held)
    return Equilibrium(
        track=line.track,
        position=_with_heels(mesh, system.position, held),
        cable_lengths=system.cables.length,
        **_wires(mesh),
        **_droppers(model, form),
        **_supports(model, form, held),
        suspension_free_heights=_free_heights(model, form),
        joint_pulls=_joint_pulls(model, form),
        end_pulls=_end_pulls(mesh, form),
        weight=_weight(model, form),
        reaction=_vertical_reaction(model, form, held),
        iterations=iterations,
        residual=form.newton.residual,
    )


def _with_heels(mesh: Mesh, position: Array, held: Held) -> Array:
    """Return the coordinates with elastic far ends of arms where the arms end."""
    rows = np.flatnonzero(mesh.heels >= 0)
    if not len(rows):
        return position
    nodes, found = mesh.heels[rows], position.copy()
    found.reshape(-1, 6)[nodes, :3] = mesh.frames[nodes].to_world(held.end[rows])
    return found


def _wires(mesh: Mesh) -> dict[str, Any]:
    """Return which node belongs to which wire; -1 for that of a support."""
    wire = np.full(mesh.node_count, -1)
    for number, strand in enumerate(mesh.strands):
        wire[strand.nodes] = number
    return {
        "node_s": mesh.s,
        "node_wire": wire,
        "wire_names": tuple(strand.run.name for strand in mesh.strands),
        "wire_roles": tuple(strand.run.role for strand in mesh.strands),
    }


def _droppers(model: Model, form: Form) -> dict[str, Any]:
    """Return where the droppers hang, their lengths and forces."""
    hangers, ties, position = model.line.hangers, form.system.ties, form.system.position
    number = {strand.run.name: i for i, strand in enumerate(model.mesh.strands)}
    wires = [(number[h.upper.run], number[h.lower.run]) for h in hangers]
    return {
        "dropper_span": np.array([h.label.span for h in hangers], dtype=np.int64),
        "dropper_number": np.array([h.label.number for h in hangers], dtype=np.int64),
        "dropper_wires": np.array(wires, dtype=np.int64).reshape(-1, 2),
        "dropper_x": np.array([h.lower.s for h in hangers]),
        "dropper_lengths_unstrained": ties.length,
        "dropper_lengths": ties.state(position).length,
        "dropper_forces": np.maximum(_dropper_forces(form), 0.0),
        "dropper_heights": model.mesh.heights(position)[ties.nodes[:, 1]],
    }


def _supports(model: Model, form: Form, held: Held) -> dict[str, Any]:
    """Return where contact wires are held, and by which arms and springs."""
    mesh, places = model.mesh, model.line.contact_supports
    number = {strand.run.name: i for i, strand in enumerate(mesh.strands)}
    rows = np.array(model.line.registration_rows, dtype=np.int64)
    preloads = np.zeros(len(places))
    preloads[rows] = held.preload
    ends = held.end.copy()
    ends[:, 0] += [piece.at.s for piece in model.line.registrations]
    arms = np.flatnonzero(~np.isnan(held.force))
    nodes = mesh.nodes(at for _, at in places)
    return {
        "support_number": np.array([label.number for label, _ in places], dtype=np.int64),
        "support_wire": np.array([number[at.run] for _, at in places], dtype=np.int64),
        "support_x": np.array([at.s for _, at in places]),
        "support_heights": model.mesh.heights(form.system.position)[nodes],
        "contact_preloads": preloads,
        "arm_supports": rows[arms] + 1,
        "arm_forces": held.force[arms],
        "arm_angles": held.angle[arms],
        "arm_ends": ends[arms],
    }


def _free_heights(model: Model, form: Form) -> Array:
    """Return the heights at which the springs of the suspensions are slack [m]."""
    pieces = model.line.suspensions
    nodes = model.mesh.nodes(piece.at for piece in pieces)
    stiffness = np.array([piece.stiffness for piece in pieces])
    heights = model.mesh.heights(form.system.position)[nodes]
    return heights + form.reactions[6 * nodes + 2] / stiffness


def _end_pulls(mesh: Mesh, form: Form) -> Array:
    """Return the forces along the track on the ends of all wires, ``(2, n_wire)`` [N]."""
    pulls = np.zeros((2, len(mesh.strands)))
    for number, strand in enumerate(mesh.strands):
        if strand.run.start.kind != "clamped":
            pulls[:, number] = form.reactions[6 * strand.nodes[[0, -1]]]
            for _, side in strand.pulled_ends:
                pull = strand.run.wire.tension * strand.leads[side]
                pulls[side, number] = pull if side else -pull
    return pulls


def _joint_pulls(model: Model, form: Form) -> Array:
    """Return the force of every joint on the wire that holds the other, ``(n_joint, 3)`` [N].

    Its share along the track was sought at the left end of a clamped wire and given at the right.
    """
    frames = model.mesh.frames[form.system.clamps.nodes[:, 0]]
    pulls = frames.components(form.system.clamps.pull(form.system.position))
    sought = iter(form.joint_pulls)
    for number, joint in enumerate(model.line.joints):
        strand = model.mesh.strand(joint.other.run)
        is_start = joint.other.s == strand.run.start.s
        pull = strand.run.wire.tension * strand.leads[1]
        pulls[number, 0] = next(sought) if is_start else -pull
    return frames.turned(pulls)


def _weight(model: Model, form: Form) -> float:
    """Return the weight of everything that hangs on the supports [N]."""
    cables, ties, gravity = form.system.cables, form.system.ties, model.case.line.gravity
    mass = float(cables.mass @ cables.length) + float(form.system.node_mass.sum())
    mass += float(ties.mass @ ties.length)
    carried = [piece.kind.carried_weight(gravity) for piece in model.line.registrations]
    return mass * gravity + sum(carried)


def _pulls(model: Model, form: Form, held: Held) -> Array:
    """Return what arms and springs exert on the contact wires, in the frames of the track [N]."""
    mesh, pieces = model.mesh, model.line.registrations
    nodes = mesh.nodes(piece.at for piece in pieces)
    wire = mesh.frames[nodes].to_local(form.system.position.reshape(-1, 6)[nodes, :3])
    offset = held.end - wire
    arm = offset * (held.force / np.linalg.norm(offset, axis=1))[:, None]
    return np.where(np.isnan(held.force)[:, None], form.reactions.reshape(-1, 6)[nodes, :3], arm)


def _vertical_reaction(model: Model, form: Form, held: Held) -> float:
    """Return the sum of the vertical forces from anchors, springs and far ends of the arms [N]."""
    mesh, line, gravity = model.mesh, model.line, model.case.line.gravity
    vertical = mesh.frames.turned(form.reactions.reshape(-1, 6)[:, :3])[:, 2]
    whole = [strand for strand in mesh.strands if strand.run.start.kind != "clamped"]
    total = float(vertical[np.concatenate([strand.nodes[[0, -1]] for strand in whole])].sum())
    pulls = _end_pulls(mesh, form)
    for number, strand in enumerate(mesh.strands):
        for node, side in strand.pulled_ends:
            total += float(pulls[side, number] * mesh.frames.axes[node, 0, 2])
    total += float(vertical[mesh.nodes(piece.at for piece in line.suspensions)].sum())
    nodes = mesh.nodes(piece.at for piece in line.registrations)
    frames, along = mesh.frames[nodes], form.reactions[6 * nodes] * np.isfinite(held.force)
    total += float(np.nansum(frames.turned(_pulls(model, form, held))[:, 2]))
    total += float(along @ frames.axes[:, 0, 2])  # what holds arms at a fixed point
    weights = np.array([piece.kind.carried_weight(gravity) for piece in line.registrations])
    stays = form.system.stays.chosen(
        np.arange(len(form.system.stays)) >= len(form.system.stays) - len(line.stays)
    )
    bars = stays.state(form.system.position)
    total -= float(stays.axial_force(bars.length) @ bars.direction[2])
    return total + 0.5 * float(weights.sum())
