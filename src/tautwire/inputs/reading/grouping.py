"""Many faults of one kind told as a few of them and a count."""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable
from typing import Any, TypeVar

T = TypeVar("T")

SHOWN = 5
"""Faults of one kind that are told one by one: enough to see a pattern, few enough to read."""
_VARIES = re.compile(r"'(?:[^'\\]|\\.)*'|\"(?:[^\"\\]|\\.)*\"|[0-9][0-9.e+-]*")


def thinned(
    items: Iterable[tuple[T, int]], kind: Callable[[T], Hashable], shown: int = SHOWN
) -> list[tuple[T, int]]:
    """Keep the first few items of every kind.

    Parameters
    ----------
    items
        Items, each with the number of items like it that were left out before.
    kind
        Tells the kind of an item.
    shown
        Items of a kind that are kept.

    Returns
    -------
    list of (item, int)
        In the order in which they came; the last kept item of a kind carries the number of items
        left out.
    """
    kept: list[list[Any]] = []
    latest: dict[Hashable, tuple[int, list[Any]]] = {}
    for item, more in items:
        key = kind(item)
        count, before = latest.get(key, (0, None))
        if before is not None and count >= shown:
            before[1] += 1 + more
            continue
        entry = [item, more]
        if before is not None:
            entry[1] += before[1]
            before[1] = 0
        kept.append(entry)
        latest[key] = count + 1, entry
    return [(item, more) for item, more in kept]


def grouped(sentences: Iterable[str]) -> list[str]:
    """Keep the first few of sentences that differ in numbers and quoted words only."""
    once = dict.fromkeys(sentences)
    return [with_count(text, more) for text, more in thinned(((s, 0) for s in once), pattern)]


def pattern(text: str) -> str:
    """Return a text without the numbers and quoted words in it."""
    return _VARIES.sub("#", text)


def with_count(sentence: str, more: int) -> str:
    """Add to a sentence how many more there are like it."""
    return f"{sentence} (and {more:,} more like this)" if more else sentence
