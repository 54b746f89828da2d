"""First guess of the shape: taut strings that hang on each other."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tautwire.line.fittings import sections
from tautwire.line.pieces import At, GivenHeight, GivenLength, Hanger, Line, Role
from tautwire.model.mesh import Mesh, Strand

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_FROM_BELOW: tuple[Role, ...] = ("contact", "auxiliary", "messenger", "stitch")
"""Order in which strings are hung: each carries what hangs below it. A stitch wire comes after the
messenger wire that holds its ends; until then the messenger wire carries its droppers."""

_STIFF, _RIGID = 1e3, 1e9
"""Stiffness of a dropper of given length and of a held point, in units of the largest stiffness of
the strings: stiff enough for a guess, far from the limits of double precision."""


@dataclass(frozen=True, eq=False)
class Guess:
    """Guessed heights of all nodes ``(n_node,)`` and lengths of the hangers ``(n_hanger,)`` [m]."""

    height: Array
    length: Array


@dataclass(frozen=True, eq=False)
class _String:
    """One wire as a string.

    Attributes
    ----------
    x : (n,) m
    tension : float N
    load : (n,) N
        Downward load lumped at the nodes.
    held : (n_held,)
        Nodes at prescribed height.
    height : (n_held,) m
    """

    x: Array
    tension: float
    load: Array
    held: Index
    height: Array


def guess_shape(
    line: Line, mesh: Mesh, weights: Array, gravity: float, errors: tuple[Array, Array]
) -> Guess:
    """Guess the heights of all wires and the unstrained lengths of the hangers.

    Parameters
    ----------
    line, mesh
        The pieces and their nodes.
    weights : (n_node,) N
        Weights of clamps and other lumped masses.
    gravity
        [m/s2]
    errors : ((n_hanger,), (n_hanger,)) m
        Errors of installation of heights and of lengths.
    """
    strings = {strand.run.name: _string(line, strand, weights, gravity) for strand in mesh.strands}
    if any(isinstance(hanger.given, GivenLength) for hanger in line.hangers):
        return _network(line, mesh, strings, errors)
    return _hung_from_below(line, mesh, strings, errors[0])


def _string(line: Line, strand: Strand, weights: Array, gravity: float) -> _String:
    """Return a run under its own weight, held where it is anchored, registered, suspended.

    Heights count from the rails: where these bend up, a taut wire falls behind them as under less
    weight.
    """
    dx = np.diff(strand.s)
    load = weights[strand.nodes].copy()
    own = 0.5 * sections(line, strand.run, strand.s).mass * gravity * dx
    load -= strand.run.wire.tension * line.track.rise_curvature(strand.s) * np.gradient(strand.s)
    load[:-1] += own
    load[1:] += own
    run = strand.run
    held = [(end.s, end.z) for end in (run.start, run.end) if end.kind != "clamped"]
    pieces = (*line.registrations, *line.suspensions)
    held += [(piece.at.s, piece.z) for piece in pieces if piece.at.run == run.name]
    places = np.array([strand.position(s) for s, _ in held], dtype=np.int64)
    return _String(strand.s, run.wire.tension, load, places, np.array([z for _, z in held]))


def _hung_from_below(line: Line, mesh: Mesh, strings: dict[str, _String], errors: Array) -> Guess:
    """Hang wire by wire, the lowest first; what a hanger needs below loads the wire above."""
    height = np.zeros(mesh.node_count)
    forces = np.zeros(len(line.hangers))
    order = sorted(line.runs, key=lambda run: _FROM_BELOW.index(run.role))
    hosts = {joint.other.run: joint.host.run for joint in line.joints}
    for run in order:
        strand, string = mesh.strand(run.name), strings[run.name]
        below = [i for i, hanger in enumerate(line.hangers) if hanger.lower.run == run.name]
        at = np.array([strand.position(line.hangers[i].lower.s) for i in below], dtype=np.int64)
        wanted = np.array([_wanted(line.hangers[i], errors[i]) for i in below])
        clamped = [joint for joint in line.joints if joint.other.run == run.name]
        ends = np.array([strand.position(joint.other.s) for joint in clamped], dtype=np.int64)
        at_host = height[mesh.nodes(joint.host for joint in clamped)]
        string = replace(
            string,
            held=np.concatenate([string.held, at, ends]),
            height=np.concatenate([string.height, wanted, at_host]),
        )
        z, reaction = _hang(string)
        height[strand.nodes] = z
        forces[below] = reaction[at]
        for i in below:
            _load(line.hangers[i].upper, mesh, strings, hosts, reaction_of=forces[i])
    return Guess(height, _lengths(line, mesh, height, forces))


def _wanted(hanger: Hanger, error: float) -> float:
    given = hanger.given
    assert isinstance(given, GivenHeight)
    return given.level - given.drop + error


def _load(
    at: At, mesh: Mesh, strings: dict[str, _String], hosts: dict[str, str], *, reaction_of: float
) -> None:
    """Put the force of a hanger on the wire above, and on the host of a stitch wire."""
    for name in (at.run, hosts.get(at.run)):
        if name is not None:
            strings[name].load[mesh.strand(name).position(at.s)] += reaction_of


def _lengths(line: Line, mesh: Mesh, height: Array, forces: Array) -> Array:
    upper = height[mesh.nodes(hanger.upper for hanger in line.hangers)]
    lower = height[mesh.nodes(hanger.lower for hanger in line.hangers)]
    springs = np.array([hanger.stiffness.spring or np.inf for hanger in line.hangers])
    return upper - lower - forces / springs


def _hang(wire: _String) -> tuple[Array, Array]:
    """Return the heights of a string and the upward force it needs at its nodes.

    Zero force at free nodes.
    """
    from scipy.linalg import solveh_banded

    diagonal, upper = _string_matrix(wire.x, wire.tension)
    band, rhs = _hold(np.stack([upper, diagonal]), -wire.load, wire.held, wire.height)
    z = solveh_banded(band, rhs)
    reaction = diagonal * z + wire.load
    reaction[:-1] += upper[1:] * z[1:]
    reaction[1:] += upper[1:] * z[:-1]
    free = np.ones(len(wire.x), dtype=bool)
    free[wire.held] = False
    reaction[free] = 0.0
    return z, reaction


def _network(
    line: Line, mesh: Mesh, strings: dict[str, _String], errors: tuple[Array, Array]
) -> Guess:
    """Return the heights of strings that hang on each other by hangers of given lengths.

    Hangers of sought length only hold the wire below them.
    """
    from scipy.linalg import solveh_banded

    links, lengths = _links(line, mesh, errors[1])
    steps = [np.diff(strand.nodes) for strand in mesh.strands]
    width = int(max(np.concatenate([*steps, np.abs(np.diff(links, axis=1)).ravel()])))
    band, rhs = np.zeros((width + 1, mesh.node_count)), np.zeros(mesh.node_count)
    free = [i for i, h in enumerate(line.hangers) if isinstance(h.given, GivenHeight)]
    heels = mesh.heels[mesh.heels >= 0]  # at no string; where they are follows from their arms
    held = [mesh.nodes(line.hangers[i].lower for i in free), heels]
    heights = [np.array([_wanted(line.hangers[i], errors[0][i]) for i in free]), 0.0 * heels]
    for strand in mesh.strands:
        string = strings[strand.run.name]
        diagonal, upper = _string_matrix(string.x, string.tension)
        band[-1, strand.nodes] = diagonal
        band[width - np.diff(strand.nodes), strand.nodes[1:]] = upper[1:]
        rhs[strand.nodes] = -string.load
        held.append(strand.nodes[string.held])
        heights.append(string.height)
    stiff = _STIFF * float(band[-1].max())
    for (above, under), length in zip(links, lengths, strict=True):
        band[-1, [above, under]] += stiff
        band[width - abs(above - under), max(above, under)] -= stiff
        rhs[under] -= stiff * length
        rhs[above] += stiff * length
    z = solveh_banded(*_hold(band, rhs, np.concatenate(held), np.concatenate(heights)))
    found = _lengths(line, mesh, z, np.zeros(len(line.hangers)))
    for i, hanger in enumerate(line.hangers):
        if isinstance(hanger.given, GivenLength):
            found[i] = hanger.given.length + errors[1][i]
    return Guess(z, found)


def _links(line: Line, mesh: Mesh, errors: Array) -> tuple[Index, Array]:
    """Return nodes (upper, lower) and lengths of hangers of given length and of joints."""
    ends = [(mesh.node(j.host), mesh.node(j.other)) for j in line.joints]
    lengths = [0.0] * len(line.joints)
    for hanger, error in zip(line.hangers, errors, strict=True):
        if isinstance(hanger.given, GivenLength):
            ends.append((mesh.node(hanger.upper), mesh.node(hanger.lower)))
            lengths.append(hanger.given.length + error)
    return np.array(ends, dtype=np.int64).reshape(-1, 2), np.array(lengths)


def _string_matrix(x: Array, tension: float) -> tuple[Array, Array]:
    """Return diagonal and upper diagonal (first entry unused) of a string's stiffness matrix."""
    k = tension / np.diff(x)
    diagonal = np.zeros(len(x))
    diagonal[:-1] += k
    diagonal[1:] += k
    return diagonal, np.concatenate([[0.0], -k])


def _hold(band: Array, rhs: Array, held: Index, height: Array) -> tuple[Array, Array]:
    """Prescribe unknowns of a symmetric upper banded system by a penalty on the diagonal."""
    band, rhs = band.copy(), rhs.copy()
    penalty = _RIGID * float(band[-1].max())
    band[-1, held] += penalty
    rhs[held] += penalty * height
    return band, rhs
