"""ANCF cable element: energy, force, tangent, length derivative, mass, weight (paper eqs. 1-6).

Strain energy ``U = 1/2 int_0^L0 (EA eps^2 + EI kappa^2) dchi`` with the Green strain
``eps = (r'.r' - 1)/2`` and ``kappa^2 = |r' x r''|^2 / |r'|^6``.

Symbols
-------
p : r'(chi), (g, 3, n)            s : L0 r''(chi), (g, 3, n), at g Gauss points
P : p.p, (g, n)                   c : p x s, W : c.c
L : unstrained length L0          w : quadrature weight
f_p, f_s : derivative of the energy density with respect to p and s

All arrays put the element last, so that each operation runs over contiguous elements. The kernels
accept complex input and contain no operation that breaks a complex-step derivative.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.elements.hermite import derivative_tables
from tautwire.numerics.elements.quadrature import gauss_unit

Array = NDArray[Any]


class _Rule(NamedTuple):
    """A quadrature rule: weights (g,), and tables of r' and L0 r'' on (d, r1', r2'), (g, 3)."""

    weights: Array
    first: Array
    second: Array

    @classmethod
    def gauss(cls, count: int) -> _Rule:
        points, weights = gauss_unit(count)
        return cls(weights, *derivative_tables(points))


_STRETCH = _Rule.gauss(5)
"""For eps^2, which has degree 8: exact to degree 9."""
_BEND = _Rule.gauss(2)
"""For kappa^2, which is rational and near to degree 2 in a taut wire: exact to degree 3. With five
points the contact force of AC simple changes by less than 0.001 N."""

_BLOCK = 1024
"""Elements whose second derivatives are formed at once: their intermediate arrays, some 4 kB an
element, stay in the cache. 512 and 2048 take as long, all of 300,000 elements three times as
long."""


class CableSection(NamedTuple):
    """Unstrained length and stiffness of cable elements, ``(n,)``: L [m], EA [N], EI [N m2]."""

    length: Array
    axial_stiffness: Array
    bending_stiffness: Array


class _Stretched(NamedTuple):
    p: Array
    P: Array
    strain: Array


class _Bent(NamedTuple):
    p: Array
    s: Array
    P: Array
    c: Array
    W: Array


def _cross(a: Array, b: Array) -> Array:
    """Cross product along axis 1 of ``(g, 3, n)`` arrays."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape), dtype=np.result_type(a, b))
    out[:, 0] = a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1]
    out[:, 1] = a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]
    out[:, 2] = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return out


def _dot(a: Array, b: Array) -> Array:
    return a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]


def _apply(table: Array, e: Array, length: Array) -> Array:
    """Return what a table on (d, r1', r2') makes of the coordinates, ``(g, 3, n)``."""
    n = e.shape[-1]
    basis = np.empty((3, 3, n), dtype=e.dtype)
    basis[0] = (e[2] - e[0]) / length
    basis[1] = e[1]
    basis[2] = e[3]
    return (table @ basis.reshape(3, 3 * n)).reshape(len(table), 3, n)


def _stretched(e: Array, length: Array) -> _Stretched:
    """Evaluate r' and the strain at the points of the axial energy."""
    p = _apply(_STRETCH.first, e, length)
    P = _dot(p, p)
    return _Stretched(p, P, 0.5 * (P - 1.0))


def _bent(e: Array, length: Array) -> _Bent:
    """Evaluate r', L0 r'' and what follows from them at the points of the bending energy."""
    p, s = _apply(_BEND.first, e, length), _apply(_BEND.second, e, length)
    c = _cross(p, s)
    return _Bent(p, s, _dot(p, p), c, _dot(c, c))


def energy(e: Array, section: CableSection) -> Array:
    """Return the strain energy of each element (paper eq. 4).

    Parameters
    ----------
    e : (4, 3, n)
        r1 [m], r1', r2 [m], r2' of each element.
    section
        Lengths and stiffnesses.

    Returns
    -------
    (n,) J
    """
    f = _bent(e, section.length)
    stretch2 = _STRETCH.weights @ _stretched(e, section.length).strain ** 2
    curvature2 = _BEND.weights @ (f.W / (section.length**2 * f.P**3))
    density = section.axial_stiffness * stretch2 + section.bending_stiffness * curvature2
    return 0.5 * section.length * density


def _axial_force(e: Array, section: CableSection) -> Array:
    """Return the forces of the axial energy on the basis (d, r1', r2'), ``(3, 3, n)``."""
    f = _stretched(e, section.length)
    return _project(_STRETCH, _STRETCH.first, (section.axial_stiffness * f.strain)[:, None] * f.p)


def _bending_force(e: Array, section: CableSection) -> Array:
    """Return those of the bending energy."""
    f = _bent(e, section.length)
    stiffness = section.bending_stiffness / section.length**2 / f.P**3
    f_p = stiffness[:, None] * (_cross(f.s, f.c) - (3.0 * f.W / f.P)[:, None] * f.p)
    f_s = stiffness[:, None] * _cross(f.c, f.p)
    return _project(_BEND, _BEND.first, f_p) + _project(_BEND, _BEND.second, f_s)


def _project(rule: _Rule, table: Array, density: Array) -> Array:
    """Return ``sum_w B' density`` on the basis (d, r1', r2'), ``(3, 3, n)``."""
    n = density.shape[-1]
    flat = (rule.weights[:, None] * table).T @ density.reshape(-1, 3 * n)
    return flat.reshape(3, 3, n)


def force(e: Array, section: CableSection) -> Array:
    """Return the elastic nodal forces Q = dU/de (paper eq. 5).

    Parameters
    ----------
    e : (4, 3, n)
        r1 [m], r1', r2 [m], r2' of each element.
    section
        Lengths and stiffnesses.

    Returns
    -------
    (4, 3, n)
        Work-conjugate to ``e``: N for positions, N m for slopes.
    """
    g = _axial_force(e, section) + _bending_force(e, section)
    q = np.empty_like(e, dtype=g.dtype)
    q[2] = g[0]
    q[0] = -g[0]
    q[1] = section.length * g[1]
    q[3] = section.length * g[2]
    return q


def _outer(a: Array, b: Array) -> Array:
    return a[:, :, None] * b[:, None, :]


def _full(a: Array) -> Array:
    return a[:, None, None]


_EYE = np.eye(3)[None, :, :, None]


def _axial_hessian(f: _Stretched, section: CableSection) -> Array:
    """Return the second derivative of the axial energy density, ``(g, 3, 3, n)``."""
    stress = _full(section.axial_stiffness * f.strain)
    return stress * _EYE + section.axial_stiffness * _outer(f.p, f.p)


def _bending_hessian(f: _Bent, section: CableSection) -> tuple[Array, Array, Array]:
    """Return those of the bending energy density: pp, sp, ss, each ``(g, 3, 3, n)``."""
    b = _cross(f.s, f.c)
    ss, ps = _dot(f.s, f.s), _dot(f.p, f.s)
    k = section.bending_stiffness / section.length**2 / f.P**3
    pp = _full(ss - 3.0 * f.W / f.P) * _EYE - _outer(f.s, f.s)
    pp -= _full(6.0 / f.P) * (_outer(b, f.p) + _outer(f.p, b))
    pp += _full(24.0 * f.W / f.P**2) * _outer(f.p, f.p)
    sp = 2.0 * _outer(f.s, f.p) - _outer(f.p, f.s) - _full(ps) * _EYE
    sp -= _full(6.0 / f.P) * _outer(f.s * f.P[:, None] - f.p * ps[:, None], f.p)
    s2 = _full(f.P) * _EYE - _outer(f.p, f.p)
    return _full(k) * pp, _full(k) * sp, _full(k) * s2


def _in_blocks(
    kernel: Callable[[Array, CableSection], Array], e: Array, section: CableSection
) -> Array:
    """Return what a kernel gives for all elements, block by block."""
    count = e.shape[-1]
    blocks = [slice(begin, begin + _BLOCK) for begin in range(0, count, _BLOCK)] or [slice(0, 0)]
    parts = (kernel(e[..., own], CableSection(*(p[own] for p in section))) for own in blocks)
    first = next(parts)
    if len(blocks) == 1:
        return first
    whole = np.empty((*first.shape[:-1], count), dtype=first.dtype)
    for own, part in zip(blocks, chain([first], parts), strict=True):
        whole[..., own] = part
    return whole


def _weigh(weights: Array, left: Array, right: Array, block: Array) -> Array:
    """Return ``sum_w left' block right``, ``(3, 3, 3, 3, n)``: j, k, component, component."""
    g, n = len(weights), block.shape[-1]
    table = (weights[:, None, None] * left[:, :, None] * right[:, None, :]).reshape(g, 9)
    return (table.T @ block.reshape(g, 9 * n)).reshape(3, 3, 3, 3, n)


def _basis_tangent(e: Array, section: CableSection) -> Array:
    """Return the Hessian of the element energy on (d, r1', r2'), ``(3, 3, 3, 3, n)``.

    Axes: basis j, component, basis k, component, element.
    """
    axial = _axial_hessian(_stretched(e, section.length), section)
    pp, sp, ss = _bending_hessian(_bent(e, section.length), section)
    first, second, weights = _BEND.first, _BEND.second, _BEND.weights
    mixed = _weigh(weights, second, first, sp)
    total = _weigh(_STRETCH.weights, _STRETCH.first, _STRETCH.first, axial)
    total += _weigh(weights, first, first, pp) + _weigh(weights, second, second, ss)
    total += mixed + mixed.transpose(1, 0, 3, 2, 4)
    return (section.length * total).transpose(0, 2, 1, 3, 4)


def tangent(e: Array, section: CableSection) -> Array:
    """Return the tangent stiffness K_T = dQ/de (paper eq. 6).

    Parameters
    ----------
    e : (4, 3, n)
        r1 [m], r1', r2 [m], r2' of each element.
    section
        Lengths and stiffnesses.

    Returns
    -------
    (4, 3, 4, 3, n)
        Symmetric in the pairs (0, 1) and (2, 3) of its axes.
    """
    return _in_blocks(_tangent, e, section)


def _tangent(e: Array, section: CableSection) -> Array:
    h = _basis_tangent(e, section)
    length = section.length
    rows = np.empty((4, 3, 3, 3, e.shape[-1]), dtype=h.dtype)
    rows[2] = h[0] / length
    rows[0] = -rows[2]
    rows[1] = h[1]
    rows[3] = h[2]
    k = np.empty((4, 3, 4, 3, e.shape[-1]), dtype=h.dtype)
    k[:, :, 2] = rows[:, :, 0] / length
    k[:, :, 0] = -k[:, :, 2]
    k[:, :, 1] = rows[:, :, 1]
    k[:, :, 3] = rows[:, :, 2]
    return k


def length_derivative(e: Array, section: CableSection) -> Array:
    """Return K_L = dQ/dL0 at fixed nodal coordinates (paper eq. 6), ``(4, 3, n)``."""
    return _in_blocks(_length_derivative, e, section)


def _length_derivative(e: Array, section: CableSection) -> Array:
    axial, bend = _axial_force(e, section), _bending_force(e, section)
    g = (axial + bend) * section.length
    h = _basis_tangent(e, section)
    d = (e[2] - e[0]) / section.length
    g_l = axial - bend  # the bending energy goes with 1/L0^2
    g_l = g_l - np.einsum("jakn,kn->jan", h[:, :, 0], d) / section.length
    q_l = np.empty_like(e, dtype=g_l.dtype)
    q_l[2] = (g_l[0] - g[0] / section.length) / section.length
    q_l[0] = -q_l[2]
    q_l[1] = g_l[1]
    q_l[3] = g_l[2]
    return q_l


def axial_force(e: Array, section: CableSection) -> Array:
    """Return the mean axial force EA*eps*|r'| of each element, ``(n,)`` [N], tension positive."""
    f = _stretched(e, section.length)
    return _STRETCH.weights @ (section.axial_stiffness * f.strain * np.sqrt(f.P))


_MASS = np.array(
    [[156.0, 22.0, 54.0, -13.0], [22.0, 4.0, 13.0, -3.0],
     [54.0, 13.0, 156.0, -22.0], [-13.0, -3.0, -22.0, 4.0]]
) / 420.0  # fmt: skip


def mass_matrix(length: Array, mass: Array) -> Array:
    """Return the consistent mass matrix of one coordinate direction.

    ``M_ij = int m S_i S_j dchi``, in closed form; the same for x, y and z.

    Parameters
    ----------
    length : (n,) m
        Unstrained length.
    mass : (n,) kg/m
        Mass per unstrained length.

    Returns
    -------
    (4, 4, n)
    """
    scale = np.stack([np.ones_like(length), length, np.ones_like(length), length])
    return _MASS[:, :, None] * scale[:, None] * scale[None, :] * (mass * length)


def weight(length: Array, mass: Array, gravity: float) -> Array:
    """Return the consistent vertical nodal loads of the element's own weight.

    ``G_i = -m g int S_i dchi``.

    Returns
    -------
    (4, n)
        On r1 [N], r1' [N m], r2 [N], r2' [N m]; negative is downward.
    """
    half, twelfth = 0.5 * length, length**2 / 12.0
    return -mass * gravity * np.stack([half, twelfth, half, -twelfth])


def weight_length_derivative(length: Array, mass: Array, gravity: float) -> Array:
    """Return the derivative of :func:`weight` with respect to the unstrained length, ``(4, n)``."""
    half, sixth = np.full_like(length, 0.5), length / 6.0
    return -mass * gravity * np.stack([half, sixth, half, -sixth])
