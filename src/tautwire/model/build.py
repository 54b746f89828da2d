"""Turn a case into arrays: mesh, supports, loads and the first guess of the shape."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.model.arms import given_arms
from tautwire.model.guess import StringWire, coupled_shape, string_shape
from tautwire.model.irregularity import draw_irregularities
from tautwire.model.mesh import CONTACT, MESSENGER, Mesh, divide
from tautwire.numerics.network.parts import TENSION_ONLY, Cables, Path, Rayleigh, Ties
from tautwire.numerics.network.system import System
from tautwire.numerics.statics.form_finding import FormProblem
from tautwire.results.irregularity import DrawnIrregularities
from tautwire.specs.case import Case

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class SupportGeometry:
    """Nominal wire positions at the supports, both anchors included, each ``(n_support,)`` [m]."""

    contact_height: Array
    contact_y: Array
    messenger_height: Array
    messenger_y: Array


@dataclass(frozen=True, eq=False)
class Model:
    """A line as arrays, ready for the analyses.

    Attributes
    ----------
    case : Case
        What was described.
    mesh : Mesh
        Stations of both wires.
    supports : SupportGeometry
        Nominal wire positions.
    form : FormProblem
        What is prescribed while the shape is sought, and a first guess.
    """

    case: Case
    mesh: Mesh
    supports: SupportGeometry
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
    mesh = divide(case)
    supports = _support_geometry(case)
    lumped, loads = _lumps(case, mesh)
    drawn = draw_irregularities(case)
    guess = _guess(case, mesh, supports, loads, drawn)
    system = _system(case, mesh, supports, guess, lumped)
    problem = FormProblem(
        system=system.with_(load=_constant_loads(case, mesh, loads)),
        held=_held(case, mesh),
        cable_slot=6 * system.cables.nodes[:, 1],
        tie_slot=_dropper_slots(case, mesh),
        gravity=case.line.gravity,
        taut=np.ones(len(mesh.dropper_x), dtype=bool),
    )
    return Model(case, mesh, supports, drawn, problem)


def _support_geometry(case: Case) -> SupportGeometry:
    count = case.line.spans + 1
    spec = case.supports
    height = np.array(spec.contact_heights(count))
    return SupportGeometry(
        contact_height=height,
        contact_y=np.array(spec.contact_staggers(count)),
        messenger_height=height + np.array(spec.encumbrances(count)),
        messenger_y=np.array(spec.messenger_staggers(count)),
    )


def interior_support_nodes(mesh: Mesh, wire: int) -> Index:
    """Return the nodes of one wire at the supports between the anchors."""
    return 2 * mesh.support_station[1:-1] + wire


def _lumps(case: Case, mesh: Mesh) -> tuple[Array, Array]:
    """Return lumped masses of clamps and spring supports ``(n_node,)`` and their weights [N]."""
    mass = np.zeros(2 * mesh.station_count)
    mass[2 * mesh.dropper_station + CONTACT] += case.droppers.clamp_contact
    mass[2 * mesh.dropper_station + MESSENGER] += case.droppers.clamp_messenger
    inner = interior_support_nodes(mesh, CONTACT)
    mass[inner] += case.supports.clamp
    if case.supports.spring is not None and case.supports.closure == "spring":
        mass[inner] += case.supports.spring.mass
    return mass, mass * case.line.gravity


def arm_half_weight(case: Case) -> float:
    """Return half the weight of one steady arm [N]; the other half hangs on its far end."""
    arm = case.supports.arm
    return 0.5 * arm.mass * arm.length * case.line.gravity


def _constant_loads(case: Case, mesh: Mesh, weights: Array) -> Array:
    """Return the loads that do not depend on the unstrained lengths, ``(n_dof,)``."""
    load = np.zeros((2 * mesh.station_count, 6))
    load[:, 2] -= weights
    load[-2 + CONTACT, 0] = case.wires.contact.tension
    load[-2 + MESSENGER, 0] = case.wires.messenger.tension
    inner = interior_support_nodes(mesh, CONTACT)
    if case.supports.closure == "lift":
        load[inner, 2] += case.supports.lift
    elif case.supports.closure == "arm":
        load[inner, 2] -= arm_half_weight(case)
    return load.ravel()


def _held(case: Case, mesh: Mesh) -> NDArray[np.bool_]:
    """Return the degrees of freedom held while the shape is sought."""
    held = np.zeros((2 * mesh.station_count, 6), dtype=bool)
    held[:2, :3] = True
    held[-2:, 1:3] = True
    held[interior_support_nodes(mesh, MESSENGER), 1:3] = True
    inner = interior_support_nodes(mesh, CONTACT)
    if case.supports.closure in ("height", "spring"):
        held[inner, 1:3] = True
    elif case.supports.closure == "lift":
        held[inner, 1] = True
    return held.ravel()


def _dropper_slots(case: Case, mesh: Mesh) -> Index:
    if case.droppers.mode == "length":
        return np.full(len(mesh.dropper_x), -1)
    return 6 * (2 * mesh.dropper_station + CONTACT) + 2


@dataclass(frozen=True, eq=False)
class _Guess:
    contact_height: Array
    messenger_height: Array
    dropper_length: Array


def _guess(
    case: Case,
    mesh: Mesh,
    supports: SupportGeometry,
    weights: Array,
    drawn: DrawnIrregularities,
) -> _Guess:
    """Guess heights of both wires and unstrained dropper lengths."""
    contact = _string(case, mesh, CONTACT, weights)
    messenger = _string(case, mesh, MESSENGER, weights)
    at, spec = mesh.dropper_station, case.droppers
    spring = 0.0
    if spec.mode == "length":
        given = np.concatenate([np.array(s) for s in spec.lengths_by_span(case.line.spans)])
        lengths = given + drawn.dropper_length
        held_contact = _with_heights(contact, mesh.support_station, supports.contact_height)
        held = _with_heights(messenger, mesh.support_station, supports.messenger_height)
        z_c, z_m = coupled_shape(mesh.x, held_contact, held, at, lengths)
        return _Guess(z_c, z_m, lengths)
    droop = np.concatenate([np.array(s) for s in spec.presag_by_span(case.line.spans)])
    straight = np.interp(mesh.dropper_x, mesh.support_x, supports.contact_height)
    stations = np.concatenate([mesh.support_station, at])
    heights = np.concatenate([supports.contact_height, straight - droop + drawn.dropper_height])
    z_c, reaction = string_shape(mesh.x, _with_heights(contact, stations, heights))
    load = messenger.load.copy()
    load[at] += reaction[at]
    loaded = StringWire(messenger.tension, load, messenger.held, messenger.height)
    z_m, _ = string_shape(
        mesh.x, _with_heights(loaded, mesh.support_station, supports.messenger_height)
    )
    length = z_m[at] - z_c[at]
    if spec.stiffness.spring is not None:
        spring = spec.stiffness.spring
        length = length - reaction[at] / spring
    return _Guess(z_c, z_m, length)


def _string(case: Case, mesh: Mesh, wire: int, weights: Array) -> StringWire:
    spec = case.wires.contact if wire == CONTACT else case.wires.messenger
    dx = np.diff(mesh.x)
    load = weights[wire::2].copy()
    own = 0.5 * spec.mass * case.line.gravity * dx
    load[:-1] += own
    load[1:] += own
    return StringWire(spec.tension, load, np.empty(0, dtype=np.int64), np.empty(0))


def _with_heights(wire: StringWire, held: Index, height: Array) -> StringWire:
    return StringWire(wire.tension, wire.load, held, height)


def _system(
    case: Case, mesh: Mesh, supports: SupportGeometry, guess: _Guess, lumped: Array
) -> System:
    """Assemble the arrays of the line at the guessed shape."""
    n = mesh.station_count
    wires = (case.wires.contact, case.wires.messenger)
    laterals = (supports.contact_y, supports.messenger_y)
    heights = (guess.contact_height, guess.messenger_height)
    position = np.zeros((n, 2, 2, 3))
    lengths = []
    for wire, (spec, y, z) in enumerate(zip(wires, laterals, heights, strict=True)):
        r = np.stack([mesh.x, np.interp(mesh.x, mesh.support_x, y), z], axis=1)
        stretch = 1.0 + spec.tension / spec.axial_stiffness
        chord = np.linalg.norm(np.diff(r, axis=0), axis=1)
        lengths.append(chord / stretch)
        direction = np.gradient(r, mesh.x, axis=0)
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        position[:, wire, 0] = r
        position[:, wire, 1] = stretch * direction
    per_wire = np.repeat([[w.axial_stiffness, w.bending_stiffness, w.mass] for w in wires],
                         n - 1, axis=0)  # fmt: skip
    nodes = [np.stack([mesh.nodes(w)[:-1], mesh.nodes(w)[1:]], 1) for w in (CONTACT, MESSENGER)]
    return System(
        cables=Cables(
            np.concatenate(nodes),
            np.concatenate(lengths),
            axial=per_wire[:, 0],
            bending=per_wire[:, 1],
            mass=per_wire[:, 2],
        ),
        ties=_droppers(case, mesh, guess.dropper_length),
        stays=given_arms(case, mesh, supports.contact_height, supports.contact_y),
        node_mass=lumped,
        load=np.zeros(12 * n),
        fixed=np.zeros(12 * n, dtype=bool),
        position=position.ravel(),
        paths=(Path("contact", mesh.nodes(CONTACT), np.arange(n - 1)),),
        damping=Rayleigh(case.line.damping.mass, case.line.damping.stiffness),
    )


def _droppers(case: Case, mesh: Mesh, lengths: Array) -> Ties:
    """Return the droppers at guessed unstrained lengths."""
    spec, count = case.droppers, len(lengths)
    stiffness = [spec.stiffness.of_length(length) for length in lengths]
    return Ties(
        nodes=2 * mesh.dropper_station[:, None] + np.array([MESSENGER, CONTACT]),
        length=lengths,
        stiffness=np.array(stiffness),
        axial=np.full(count, np.nan if spec.stiffness.axial is None else spec.stiffness.axial),
        mass=np.full(count, spec.mass),
        law=np.full(count, TENSION_ONLY),
    )
