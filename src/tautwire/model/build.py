"""Turn a case into arrays: pieces, mesh, what is prescribed, and a first guess of the shape."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.line.expand import expand
from tautwire.line.fittings import lumps, sections
from tautwire.line.pieces import GivenHeight, Line, Run
from tautwire.model.guess import Guess, guess_shape
from tautwire.model.irregularity import draw_irregularities
from tautwire.model.mesh import Mesh, Strand, divide
from tautwire.model.registrations import design_stays, groups, pulling_stays
from tautwire.numerics.network.parts import (
    TENSION_ONLY,
    Cables,
    Clamps,
    Path,
    Rayleigh,
    Ties,
)
from tautwire.numerics.network.system import System
from tautwire.numerics.statics.form_finding import FormProblem
from tautwire.results.irregularity import DrawnIrregularities
from tautwire.specs.case import Case

Array = NDArray[np.float64]
Index = NDArray[np.int64]

CLAMP_STIFFNESS = 1e7
"""Stiffness of the joint of two wires [N/m]: under a stitch wire's tension of 3.5 kN it gives way
by a third of a millimetre along the track and under 100 N by 11 micrometres; stiffer joints cost
iterations of the time integration and change nothing."""


@dataclass(frozen=True, eq=False)
class Model:
    """A line as arrays, ready for the analyses.

    Attributes
    ----------
    case : Case
        What was described.
    line : Line
        Its pieces.
    mesh : Mesh
        Nodes and elements of every wire.
    irregularities : DrawnIrregularities
    form : FormProblem
        What is prescribed while the shape is sought, and a first guess.
    """

    case: Case
    line: Line
    mesh: Mesh
    irregularities: DrawnIrregularities
    form: FormProblem


def build(case: Case) -> Model:
    """Turn a case into a model.

    Parameters
    ----------
    case
        A validated case.

    Returns
    -------
    Model
    """
    line = expand(case)
    mesh = divide(line, case.settings, case.scenario.speed)
    drawn = draw_irregularities(case)
    gravity = case.line.gravity
    lumped = _lumped_masses(line, mesh)
    errors = (drawn.dropper_height, drawn.dropper_length)
    guess = guess_shape(line, mesh, lumped * gravity, gravity, errors)
    position = _positions(line, mesh, guess).ravel()
    system = System(
        cables=_cables(line, mesh, guess),
        ties=_hangers(line, mesh, guess.length),
        clamps=_joints(line, mesh),
        stays=design_stays(line, mesh).joined(pulling_stays(line, mesh, position)),
        node_mass=lumped,
        load=_design_loads(line, mesh, lumped, gravity),
        fixed=np.zeros(6 * mesh.node_count, dtype=bool),
        position=position,
        paths=tuple(
            Path(strand.run.name, strand.nodes, strand.cables)
            for strand in mesh.strands
            if strand.run.role == "contact"
        ),
        damping=Rayleigh(case.line.damping.mass, case.line.damping.stiffness),
    )
    problem = FormProblem(
        system=system,
        held=_held(line, mesh),
        cable_slot=_cable_slots(mesh),
        tie_slot=_hanger_slots(line, mesh),
        gravity=gravity,
        taut=np.ones(len(line.hangers), dtype=bool),
        joints=_sought_joints(line, mesh),
        axes=mesh.frames.axes,
    )
    return Model(case, line, mesh, drawn, problem)


def _lumped_masses(line: Line, mesh: Mesh) -> Array:
    """Return the masses of clamps, springs and bodies, ``(n_node,)`` [kg]."""
    mass = np.zeros(mesh.node_count)
    for hanger in line.hangers:
        mass[mesh.node(hanger.upper)] += hanger.clamps[0]
        mass[mesh.node(hanger.lower)] += hanger.clamps[1]
    for joint in line.joints:
        mass[mesh.node(joint.host)] += joint.clamp
    for piece in line.registrations:
        mass[mesh.node(piece.at)] += piece.clamp + piece.kind.mass
    for at, lump in lumps(line):
        mass[mesh.node(at)] += lump
    return mass


def _laterals(line: Line, strand: Strand) -> Array:
    """Return the nominal lateral position of the nodes of a strand: straight between supports.

    A wire that no support holds, only other wires, lies under the one above.
    """
    known = _known_laterals(line, strand.run)
    for hanger in line.hangers:
        if len(known) == 2 and hanger.lower.run == strand.run.name:
            known = _known_laterals(line, line.by_name[hanger.upper.run])
            break
    places = np.array(sorted(known))
    return np.interp(strand.s, places, [known[s] for s in places]) + _inside(line, strand.s, places)


def _inside(line: Line, s: Array, places: Array) -> Array:
    """Return how far to the left of the track's middle its chords between some places run [m]."""
    span = np.clip(np.searchsorted(places, s, side="right") - 1, 0, len(places) - 2)
    ends, here = line.track.frames(places).origin, line.track.frames(s)
    chord = ends[span + 1] - ends[span]
    t, n = here.axes[:, 0], here.axes[:, 1]
    way = np.sum(t * (here.origin - ends[span]), axis=1) / np.sum(t * chord, axis=1)
    return np.sum(n * (ends[span] + way[:, None] * chord - here.origin), axis=1)


def _known_laterals(line: Line, run: Run) -> dict[float, float]:
    pieces = (*line.registrations, *line.suspensions)
    known = {end.s: end.y for end in (run.start, run.end)}
    return known | {piece.at.s: piece.y for piece in pieces if piece.at.run == run.name}


def _points(line: Line, mesh: Mesh, strand: Strand, guess: Guess) -> Array:
    """Return the guessed positions of the nodes of a strand, ``(n, 3)`` [m]."""
    own = [np.zeros(len(strand.s)), _laterals(line, strand), guess.height[strand.nodes]]
    return mesh.frames[strand.nodes].to_world(np.stack(own, axis=1))


def _stretch(run: Run) -> float:
    return 1.0 + run.wire.tension / run.wire.axial_stiffness


def _positions(line: Line, mesh: Mesh, guess: Guess) -> Array:
    """Return guessed coordinates and slopes of all nodes, ``(n_node, 2, 3)``."""
    position = np.zeros((mesh.node_count, 2, 3))
    for strand in mesh.strands:
        r = _points(line, mesh, strand, guess)
        direction = np.gradient(r, strand.s, axis=0)
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        position[strand.nodes, 0] = r
        position[strand.nodes, 1] = _stretch(strand.run) * direction
    for heel, piece in zip(mesh.heels, line.registrations, strict=True):
        if piece.heel is not None:
            position[heel, 0] = mesh.frames[heel].to_world(np.array([0.0, piece.y, piece.z]))
            position[heel, 1] = mesh.frames.axes[heel, 0]
    return position


def _cables(line: Line, mesh: Mesh, guess: Guess) -> Cables:
    """Return all wire elements, strand by strand, at guessed unstrained lengths."""
    parts = []
    for strand in mesh.strands:
        made = sections(line, strand.run, strand.s)
        chord = np.linalg.norm(np.diff(_points(line, mesh, strand, guess), axis=0), axis=1)
        parts.append(
            Cables(
                np.stack([strand.nodes[:-1], strand.nodes[1:]], axis=1),
                chord / (1.0 + strand.run.wire.tension / made.axial),
                axial=made.axial,
                bending=made.bending,
                mass=made.mass,
            )
        )
    return Cables.none().joined(*parts)


def _hangers(line: Line, mesh: Mesh, lengths: Array) -> Ties:
    """Return the hangers at guessed unstrained lengths."""
    pieces = line.hangers
    ends = [(mesh.node(piece.upper), mesh.node(piece.lower)) for piece in pieces]
    stiffness = [p.stiffness.of_length(length) for p, length in zip(pieces, lengths, strict=True)]
    axial = [np.nan if p.stiffness.axial is None else p.stiffness.axial for p in pieces]
    return Ties(
        nodes=np.array(ends, dtype=np.int64).reshape(-1, 2),
        length=lengths,
        stiffness=np.array(stiffness),
        axial=np.array(axial),
        mass=np.array([piece.mass for piece in pieces]),
        law=np.full(len(pieces), TENSION_ONLY),
    )


def _joints(line: Line, mesh: Mesh) -> Clamps:
    """Return the joints of runs, which carry nothing where their nodes coincide."""
    ends = [(mesh.node(joint.host), mesh.node(joint.other)) for joint in line.joints]
    count = len(ends)
    return Clamps(
        np.array(ends, dtype=np.int64).reshape(-1, 2),
        np.full(count, CLAMP_STIFFNESS),
        np.zeros((count, 3)),
    )


def _design_loads(line: Line, mesh: Mesh, lumped: Array, gravity: float) -> Array:
    """Return the loads that do not depend on the unstrained lengths, ``(n_dof,)``."""
    load = np.zeros((mesh.node_count, 6))
    load[:, 2] -= lumped * gravity
    along = mesh.frames.axes[:, 0]
    for strand in mesh.strands:
        for node, side in strand.pulled_ends:
            outward = along[node] if side else -along[node]
            load[node, :3] += strand.run.wire.tension * strand.leads[side] * outward
    for joint in line.joints:
        strand = mesh.strand(joint.other.run)
        if joint.other.s == strand.run.end.s:
            host = mesh.node(joint.host)
            load[host, :3] -= strand.run.wire.tension * strand.leads[1] * along[host]
    for group in groups(line, mesh):
        local = group.kind.design_load(group.gravity(gravity))
        load[group.nodes, :3] += group.frames.turned(local)
    return load.ravel()


def _cable_slots(mesh: Mesh) -> NDArray[np.int64]:
    """Return which coordinate along the track every element's unstrained length replaces.

    That of its node away from where its wire is held.
    """
    slots = [
        np.where(np.arange(len(strand.cables)) < strand.held, strand.nodes[:-1], strand.nodes[1:])
        for strand in mesh.strands
    ]
    return 6 * np.concatenate(slots)


def _held(line: Line, mesh: Mesh) -> NDArray[np.bool_]:
    """Return the degrees of freedom held while the shape is sought."""
    held = np.zeros((mesh.node_count, 6), dtype=bool)
    for strand in mesh.strands:
        held[strand.nodes[strand.held], 0] = strand.run.start.kind != "clamped"
        held[strand.nodes[0], 1:3] = strand.run.start.kind != "clamped"
        held[strand.nodes[-1], 1:3] = strand.run.end.kind != "clamped"
    held[mesh.nodes(piece.at for piece in line.suspensions), 1:3] = True
    for group in groups(line, mesh):
        for direction in group.kind.held:
            held[group.nodes, direction] = True
    held[mesh.heels[mesh.heels >= 0]] = True
    return held.ravel()


def _sought_joints(line: Line, mesh: Mesh) -> Index:
    """Return the joints at the left ends of clamped wires: their force along the track is sought.

    At the right end it is the tension of the wire.
    """
    ends = [
        (6 * mesh.node(joint.host), 6 * mesh.node(joint.other))
        for joint in line.joints
        if joint.other.s == line.by_name[joint.other.run].start.s
    ]
    return np.array(ends, dtype=np.int64).reshape(-1, 2)


def _hanger_slots(line: Line, mesh: Mesh) -> Index:
    """Return the coordinate whose place each hanger's length takes; -1 where it is given."""
    slots = [
        6 * mesh.node(piece.lower) + 2 if isinstance(piece.given, GivenHeight) else -1
        for piece in line.hangers
    ]
    return np.array(slots, dtype=np.int64)
