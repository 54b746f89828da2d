"""Local passages computed side by side, each kept as soon as it is done."""

from __future__ import annotations

import io
import os
import signal
from collections.abc import Callable, Iterable, Iterator, Sequence, Set
from concurrent.futures import (
    FIRST_COMPLETED,
    Executor,
    Future,
    ProcessPoolExecutor,
    as_completed,
    wait,
)
from contextlib import contextmanager
from itertools import starmap
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.process import BaseProcess
from pathlib import Path
from threading import Thread
from typing import Any, TypeVar
from zipfile import BadZipFile

import numpy as np

from tautwire.analyses.survey.local import Felt, Passage, Place, felt_at
from tautwire.files import write_whole

_Result = TypeVar("_Result")

_UNDER_WAY = 64
"""Places that are handed to the processes at a time: enough for each to have one waiting on the
largest machines, and a hundred cases take megabytes."""
_FELT = ("position", "raw", "filtered", "uplift")
_PASSAGE = ("position", "raw", "filtered", "uplift", "cpu")


@contextmanager
def processes(count: int) -> Iterator[Executor | None]:
    """Provide processes that compute places; None for one, which is this process itself.

    When the computation is left by an exception, a signal for instance, the processes end at once;
    only the places that they had begun are lost.

    Parameters
    ----------
    count : int
    """
    if count == 1:
        yield None
        return
    others = set(active_children())
    pool = ProcessPoolExecutor(count, get_context("spawn"), _begin)
    try:
        yield pool
    except BaseException:
        try:
            _terminate(others)
        except BaseException:
            _terminate(others)  # a second signal must not leave the processes at work
            raise
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _terminate(others: Set[BaseProcess]) -> None:
    """End all processes of this one except those that were there before."""
    for process in set(active_children()) - others:
        process.terminate()


def in_order(
    pool: Executor | None, function: Callable[..., _Result], arguments: Sequence[tuple[Any, ...]]
) -> Iterator[_Result]:
    """Call a function with several sets of arguments, side by side where there are processes.

    Parameters
    ----------
    pool
        From :func:`processes`.
    function, arguments

    Yields
    ------
    object
        What it returns, in the order of the arguments.
    """
    if pool is None:
        yield from starmap(function, arguments)
        return
    futures = [pool.submit(function, *own) for own in arguments]
    yield from (future.result() for future in futures)


def computed(
    places: Iterable[Place], pool: Executor | None, folder: Path | None
) -> Iterator[tuple[int, tuple[Felt, ...], float]]:
    """Compute what is felt at some places, or take it from where it is kept.

    Parameters
    ----------
    places
        Asked for as they are needed: those of a long line would fill the memory.
    pool
        From :func:`processes`.
    folder : Path or None
        Where every place is kept once it is done.

    Yields
    ------
    number : int
        Of the place, from 0, in the order in which they are done.
    felt : tuple of Felt
        One per correction.
    cpu : float s
        Processor time that was spent now.
    """
    under_way: dict[Future[tuple[tuple[Felt, ...], float]], int] = {}
    for number, place in enumerate(places):
        kept = None if folder is None else _kept(place, folder)
        if kept is not None:
            yield number, kept, 0.0
        elif pool is None:
            yield number, *_computed(place, folder)
        else:
            under_way[pool.submit(_computed, place, folder)] = number
        if len(under_way) >= _UNDER_WAY:
            for future in wait(under_way, return_when=FIRST_COMPLETED).done:
                yield under_way.pop(future), *future.result()
    for future in as_completed(under_way):
        yield under_way[future], *future.result()


def _begin() -> None:
    """Leave Ctrl-C to the parent, which ends its processes, and end when it is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _computed(place: Place, folder: Path | None) -> tuple[tuple[Felt, ...], float]:
    felt, cpu = felt_at(place)
    if folder is not None:
        _save(_path(place, folder), {f"{name}{n}": getattr(one, name)
                                     for n, one in enumerate(felt) for name in _FELT})  # fmt: skip
    return felt, cpu


def _kept(place: Place, folder: Path) -> tuple[Felt, ...] | None:
    """Return what is kept of a place; None where there is nothing that can be read."""
    numbers = range(len(place.corrected))
    found = _loaded(_path(place, folder), [f"{name}{n}" for n in numbers for name in _FELT])
    if found is None:
        return None
    return tuple(
        Felt(
            found[f"position{n}"], found[f"raw{n}"], found[f"filtered{n}"],
            float(found[f"uplift{n}"]),
        )
        for n in numbers
    )  # fmt: skip


def _path(place: Place, folder: Path) -> Path:
    return folder / f"{place.name()}.npz"


def keep_passage(path: Path, passage: Passage) -> None:
    """Keep a passage, completely or not at all."""
    _save(path, {name: getattr(passage, name) for name in _PASSAGE})


def kept_passage(path: Path) -> Passage | None:
    """Return a kept passage; None where there is none that can be read."""
    found = _loaded(path, _PASSAGE)
    if found is None:
        return None
    return Passage(
        found["position"], found["raw"], found["filtered"], found["uplift"], float(found["cpu"])
    )


def _save(path: Path, arrays: dict[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    content = io.BytesIO()
    np.savez_compressed(content, **arrays)
    write_whole(path, content.getvalue())


def _loaded(path: Path, names: Sequence[str]) -> dict[str, Any] | None:
    """Return the arrays of a file; None where there is none that can be read."""
    try:
        with np.load(path, allow_pickle=False) as data:
            return {name: data[name] for name in names}
    except (OSError, ValueError, KeyError, EOFError, BadZipFile):
        return None
