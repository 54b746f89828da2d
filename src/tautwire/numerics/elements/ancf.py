"""ANCF cable element: energy, force, tangent, length derivative, mass, weight (paper eqs. 1-6).

Strain energy ``U = 1/2 int_0^L0 (EA eps^2 + EI kappa^2) dchi`` with the Green strain
``eps = (r'.r' - 1)/2`` and ``kappa^2 = |r' x r''|^2 / |r'|^6``.

Symbols
-------
p : r'(chi), (5, 3, n)            s : L0 r''(chi), (5, 3, n)
P : p.p, (5, n)                   c : p x s, W : c.c
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

QUADRATURE_POINTS = 5
"""Gauss points of an element: exact to degree 9; eps^2 has degree 8, and kappa^2, which is
rational, is near to degree 2 in a taut wire. With three points for kappa^2 the contact force of AC
simple with nine nodes between droppers changes by 0.0003 N rms and the time by nothing, with two by
0.003 N (AC simple as plane models see it: 0.005 N) and a sweep takes 0.94 of its time."""
_POINTS, _WEIGHTS = gauss_unit(QUADRATURE_POINTS)
_FIRST, _SECOND = derivative_tables(_POINTS)
_BOTH = np.concatenate([_FIRST, _SECOND])
_W_FIRST_T = (_WEIGHTS[:, None] * _FIRST).T
_W_SECOND_T = (_WEIGHTS[:, None] * _SECOND).T


_BLOCK = 1024
"""Elements whose second derivatives are formed at once: their intermediate arrays, some 4 kB an
element, stay in the cache. 512 and 2048 take as long, all of 300,000 elements three times as
long."""


class CableSection(NamedTuple):
    """Unstrained length and stiffness of cable elements, ``(n,)``: L [m], EA [N], EI [N m2]."""

    length: Array
    axial_stiffness: Array
    bending_stiffness: Array


class _Fields(NamedTuple):
    p: Array
    s: Array
    P: Array
    c: Array
    W: Array
    strain: Array


def _cross(a: Array, b: Array) -> Array:
    """Cross product along axis 1 of ``(g, 3, n)`` arrays."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape), dtype=np.result_type(a, b))
    out[:, 0] = a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1]
    out[:, 1] = a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]
    out[:, 2] = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return out


def _dot(a: Array, b: Array) -> Array:
    return a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]


def _fields(e: Array, length: Array) -> _Fields:
    """Evaluate r', L0 r'' and what follows from them at the quadrature points."""
    n = e.shape[-1]
    basis = np.empty((3, 3, n), dtype=e.dtype)
    basis[0] = (e[2] - e[0]) / length
    basis[1] = e[1]
    basis[2] = e[3]
    values = (_BOTH @ basis.reshape(3, 3 * n)).reshape(2 * QUADRATURE_POINTS, 3, n)
    p, s = values[:QUADRATURE_POINTS], values[QUADRATURE_POINTS:]
    c = _cross(p, s)
    P = _dot(p, p)
    return _Fields(p, s, P, c, _dot(c, c), 0.5 * (P - 1.0))


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
    f = _fields(e, section.length)
    curvature2 = f.W / (section.length**2 * f.P**3)
    density = section.axial_stiffness * f.strain**2 + section.bending_stiffness * curvature2
    return 0.5 * section.length * (_WEIGHTS @ density)


def _densities(f: _Fields, section: CableSection) -> tuple[Array, Array, Array]:
    """Return the axial and bending part of f_p, and f_s."""
    stiffness = section.bending_stiffness / section.length**2 / f.P**3
    axial = (section.axial_stiffness * f.strain)[:, None] * f.p
    bend = stiffness[:, None] * (_cross(f.s, f.c) - (3.0 * f.W / f.P)[:, None] * f.p)
    return axial, bend, stiffness[:, None] * _cross(f.c, f.p)


def _project(f_p: Array, f_s: Array) -> Array:
    """Return ``sum_w (B' f_p + B'' f_s)`` on the basis (d, r1', r2'), ``(3, 3, n)``."""
    n = f_p.shape[-1]
    flat = _W_FIRST_T @ f_p.reshape(-1, 3 * n) + _W_SECOND_T @ f_s.reshape(-1, 3 * n)
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
    axial, bend, f_s = _densities(_fields(e, section.length), section)
    axial += bend
    g = _project(axial, f_s)
    q = np.empty_like(e, dtype=g.dtype)
    q[2] = g[0]
    q[0] = -g[0]
    q[1] = section.length * g[1]
    q[3] = section.length * g[2]
    return q


def _hessian(f: _Fields, section: CableSection) -> tuple[Array, Array, Array]:
    """Return second derivatives of the energy density: pp, sp, ss, each ``(5, 3, 3, n)``."""
    eye = np.eye(3)[None, :, :, None]

    def outer(a: Array, b: Array) -> Array:
        return a[:, :, None] * b[:, None, :]

    def full(a: Array) -> Array:
        return a[:, None, None]

    b = _cross(f.s, f.c)
    ss, ps = _dot(f.s, f.s), _dot(f.p, f.s)
    k = section.bending_stiffness / section.length**2 / f.P**3
    pp = full(section.axial_stiffness * f.strain) * eye
    pp = pp + section.axial_stiffness * outer(f.p, f.p)
    bend = full(ss - 3.0 * f.W / f.P) * eye - outer(f.s, f.s)
    bend -= full(6.0 / f.P) * (outer(b, f.p) + outer(f.p, b))
    bend += full(24.0 * f.W / f.P**2) * outer(f.p, f.p)
    pp = pp + full(k) * bend
    sp = 2.0 * outer(f.s, f.p) - outer(f.p, f.s) - full(ps) * eye
    sp -= full(6.0 / f.P) * outer(f.s * f.P[:, None] - f.p * ps[:, None], f.p)
    s2 = full(f.P) * eye - outer(f.p, f.p)
    return pp, full(k) * sp, full(k) * s2


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


def _basis_tangent(f: _Fields, section: CableSection) -> Array:
    """Return the Hessian of the element energy on (d, r1', r2'), ``(3, 3, 3, 3, n)``.

    Axes: basis j, component, basis k, component, element.
    """
    pp, sp, ss = _hessian(f, section)
    n = pp.shape[-1]
    g = QUADRATURE_POINTS

    def weigh(left: Array, right: Array, block: Array) -> Array:
        table = (_WEIGHTS[:, None, None] * left[:, :, None] * right[:, None, :]).reshape(g, 9)
        return (table.T @ block.reshape(g, 9 * n)).reshape(3, 3, 3, 3, n)

    mixed = weigh(_SECOND, _FIRST, sp)
    total = weigh(_FIRST, _FIRST, pp) + weigh(_SECOND, _SECOND, ss)
    total = total + mixed + mixed.transpose(1, 0, 3, 2, 4)
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
    h = _basis_tangent(_fields(e, section.length), section)
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
    f = _fields(e, section.length)
    axial, bend, f_s = _densities(f, section)
    g = _project(axial + bend, f_s) * section.length
    h = _basis_tangent(f, section)
    d = (e[2] - e[0]) / section.length
    g_l = _project(axial - bend, -f_s)
    g_l = g_l - np.einsum("jakn,kn->jan", h[:, :, 0], d) / section.length
    q_l = np.empty_like(e, dtype=g_l.dtype)
    q_l[2] = (g_l[0] - g[0] / section.length) / section.length
    q_l[0] = -q_l[2]
    q_l[1] = g_l[1]
    q_l[3] = g_l[2]
    return q_l


def axial_force(e: Array, section: CableSection) -> Array:
    """Return the mean axial force EA*eps*|r'| of each element, ``(n,)`` [N], tension positive."""
    f = _fields(e, section.length)
    return _WEIGHTS @ (section.axial_stiffness * f.strain * np.sqrt(f.P))


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
