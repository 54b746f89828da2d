"""Ties that slacken, arms that turn and wires under one rigid head, in a line else linear.

Between two iterations a line moves linearly but for its bars. A tie carries either ``raw + k e``
(taut) or nothing (slack), with ``e`` its elongation; a stay has another tangent than at rest. The
linear line counts both as they are at rest; what they carry more, ``a``, pulls on it from outside.
With ``D`` the movements under unit pulls and ``E`` those under unit forces on the wires, the bars
move by ``e = e0 - D a + E s``. The unknowns are the pulls ``a`` and changes ``s`` of the forces of
the head on its wires, which add up to nothing and bring the wires to one height.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.network.parts import Ties

Array = NDArray[Any]
Index = NDArray[np.int64]

_MOST_PASSES = 20
"""Passes until the set of slack ties must have settled; two or three are usual."""


class Wires(NamedTuple):
    """Wires under one rigid head in the linear line.

    Attributes
    ----------
    heights : (n_wire,) m
        With the forces as they are.
    flexibility : (n_wire, n_wire) m/N
        Heights under unit forces on the wires.
    movements : (n_pull, n_wire) m/N
        Of the bars under the same forces.
    """

    heights: Array
    flexibility: Array
    movements: Array


class Step(NamedTuple):
    """A step of the linear line.

    Attributes
    ----------
    raw : (n_tie,) N
        Forces of the ties before it, as if none could slacken.
    movements : (n_pull,) m
        Elongations of the ties in it, then the movements ``x y z`` of the ends of the stays.
    turned : (n_stay, 3, 3) N/m
        What the tangents of the stays are more than at rest.
    wires : Wires, optional
        Those under the head; None where there is but one.
    """

    raw: Array
    movements: Array
    turned: Array
    wires: Wires | None


class Change(NamedTuple):
    """Pulls of some bars in the order of :attr:`Step.movements`, and changes of forces on wires."""

    places: Index
    pulls: Array
    shares: Array


@dataclass(frozen=True, eq=False)
class Bars:
    """The bars of a linear line.

    Attributes
    ----------
    ties : Ties
    taut : (n_tie,) bool
        Ties that have their stiffness in the linear line.
    movements : callable
        Returns what all bars move under one unit pull, ``(n_pull,)`` [m/N].
    """

    ties: Ties
    taut: NDArray[np.bool_]
    movements: Callable[[int], Array]

    def change(self, step: Step) -> Change:
        """Return what a step of the linear line has to be corrected by.

        Raises
        ------
        numpy.linalg.LinAlgError
            When the line with its bars as they are now holds nothing.
        """
        count, size, stiffness = len(self.taut), len(step.movements), self.ties.stiffness
        taut = self.ties.acting(step.raw + stiffness * step.movements[:count])
        change = self._solved(step, taut)
        for _ in range(_MOST_PASSES):
            e = step.movements - self._columns(change.places, size) @ change.pulls
            if step.wires is not None:
                e = e + step.wires.movements @ change.shares
            settled = self.ties.acting(step.raw + stiffness * e[:count])
            if np.array_equal(settled, taut):
                break
            taut = settled
            change = self._solved(step, taut)
        return change

    def _columns(self, places: Index, size: int) -> Array:
        """Return the movements of all bars under some unit pulls, ``(size, n)``."""
        columns = np.empty((size, len(places)))
        for number, place in enumerate(places):
            columns[:, number] = self.movements(int(place))
        return columns

    def _solved(self, step: Step, taut: NDArray[np.bool_]) -> Change:
        """Return the correction for given states of the ties.

        A tie that has gone slack has ``a + k e = -f``, with ``f`` its force before the step, one
        that has become taut ``a - k e = raw - f``; in the others ``a`` is known. A stay has
        ``a = K e``, with ``K`` the change of its tangent.
        """
        force = np.where(self.ties.acting(step.raw), step.raw, 0.0)
        given = np.where(self.taut, step.raw, 0.0) - force
        changed = np.flatnonzero(taut != self.taut)
        known = np.flatnonzero((taut == self.taut) & (given != 0.0))
        turned = np.flatnonzero(step.turned.any(axis=(1, 2)))
        count, size, wires = len(changed), len(step.movements), step.wires
        if not count and not len(turned) and wires is None:
            return Change(known, given[known], np.empty(0))
        stays = len(self.taut) + (3 * turned[:, None] + np.arange(3)).ravel()
        sought = np.concatenate([changed, stays])
        columns = self._columns(sought, size)[sought]
        movements = step.movements - self._columns(known, size) @ given[known]
        sign = np.where(taut[changed], -1.0, 1.0) / self.ties.stiffness[changed]
        wanted = np.where(taut[changed], step.raw[changed], 0.0) - force[changed]
        law = _law(count, step.turned[turned])
        matrix = np.diag(np.concatenate([sign, np.ones(len(stays))])) - law @ columns
        rhs = np.concatenate([sign * wanted, np.zeros(len(stays))]) - law @ movements[sought]
        if wires is not None:
            heights = wires.heights - wires.movements[known].T @ given[known]
            reach = wires.movements[sought]
            matrix, rhs = _levelled(matrix, rhs, law @ reach, reach, wires.flexibility, heights)
        x = np.linalg.solve(matrix, rhs)
        pulls = np.concatenate([x[: len(sought)], given[known]])
        return Change(np.concatenate([sought, known]), pulls, x[len(sought) : -1])


def _law(ties: int, turned: Array) -> Array:
    """Return the identity for ties and ``-K`` for stays, ``(n, n)``."""
    size = ties + 3 * len(turned)
    law = np.eye(size)
    for number, block in enumerate(turned):
        own = slice(ties + 3 * number, ties + 3 * number + 3)
        law[own, own] = -block
    return law


def level(flexibility: Array, heights: Array) -> Array:
    """Return changes of the forces on wires, zero in sum, that make their heights equal [N].

    Parameters
    ----------
    flexibility : (n_wire, n_wire) m/N
    heights : (n_wire,) m
    """
    nothing = np.empty((0, len(heights)))
    bare = np.empty((0, 0)), np.empty(0)
    matrix, rhs = _levelled(*bare, nothing, nothing, flexibility, heights)
    return np.linalg.solve(matrix, rhs)[:-1]


def _levelled(
    matrix: Array, rhs: Array, pulled: Array, reach: Array, flexibility: Array, heights: Array
) -> tuple[Array, Array]:
    """Add to the equations of bars those of the wires: one height, no change of the sum."""
    n, w = reach.shape
    out = np.zeros((n + w + 1, n + w + 1))
    out[:n, :n], out[:n, n : n + w] = matrix, pulled
    out[n : n + w, :n], out[n : n + w, n : n + w] = -reach.T, flexibility
    out[n : n + w, -1], out[-1, n : n + w] = -1.0, 1.0
    return out, np.concatenate([rhs, -heights, [0.0]])
