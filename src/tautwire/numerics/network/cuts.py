"""A stretch of a line cut out of it, and copies of a line beside each other."""

from __future__ import annotations

from typing import Any

import numpy as np

from tautwire.numerics.network.system import System

_GROUPS = ("cables", "ties", "clamps", "stays", "grounds")


def between(system: System, first: int, last: int) -> System:
    """Return the nodes from ``first`` to ``last - 1`` and the parts that hang on them alone.

    Parameters
    ----------
    system
        The line.
    first, last
        Numbers of nodes; the first node of the stretch is node 0 of the result.

    Returns
    -------
    System
        Without paths.
    """
    dofs = slice(6 * first, 6 * last)
    return system.with_(
        **{group: _inside(getattr(system, group), first, last) for group in _GROUPS},
        node_mass=system.node_mass[first:last],
        load=system.load[dofs],
        fixed=system.fixed[dofs],
        position=system.position[dofs],
        paths=(),
    )


def _inside(part: Any, first: int, last: int) -> Any:
    """Return the parts of one group that hang on nodes of a stretch, numbered within it."""
    name = _ends_of(part)
    ends = getattr(part, name)
    is_inside = (ends >= first) & (ends < last)
    keep = is_inside if ends.ndim == 1 else is_inside.all(axis=1)
    return part.chosen(keep).with_(**{name: ends[keep] - first})


def _ends_of(part: Any) -> str:
    return "nodes" if hasattr(part, "nodes") else "node"


def copies(system: System, count: int) -> System:
    """Return a line several times over, not connected, one after the other in all arrays."""
    return system.with_(
        **{group: _repeated(getattr(system, group), count, system.node_count) for group in _GROUPS},
        node_mass=np.tile(system.node_mass, count),
        load=np.tile(system.load, count),
        fixed=np.tile(system.fixed, count),
        position=np.tile(system.position, count),
        paths=(),
    )


def _repeated(part: Any, count: int, node_count: int) -> Any:
    name = _ends_of(part)
    ends = getattr(part, name)
    shift = np.repeat(node_count * np.arange(count), len(ends))
    moved = np.concatenate([ends] * count) + shift.reshape(-1, *(1,) * (ends.ndim - 1))
    return part.joined(*(part,) * (count - 1)).with_(**{name: moved})
