"""What the pieces of a line are called; the only place that numbers from 1."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class MastLabel:
    """A support.

    Attributes
    ----------
    number : int
        From 1 at the left end.
    """

    number: int

    def __str__(self) -> str:
        return f"support {self.number}"

    @classmethod
    def of_index(cls, index: int) -> MastLabel:
        """Return the label of the support with a 0-based index."""
        return cls(index + 1)


@dataclass(frozen=True)
class HangerLabel:
    """A dropper.

    Attributes
    ----------
    span, number : int
        Span and number within the span, both from 1.
    lower : str
        Wire that it carries; empty where there is only one kind of dropper.
    """

    span: int
    number: int
    lower: str = ""

    def __str__(self) -> str:
        carried = f" (of the wire {self.lower!r})" if self.lower else ""
        return f"dropper {self.number} of span {self.span}{carried}"

    @classmethod
    def of_index(cls, span: int, index: int, lower: str = "") -> HangerLabel:
        """Return the label of a dropper with 0-based span and index in the span."""
        return cls(span + 1, index + 1, lower)


def place(label: MastLabel | HangerLabel, s: float) -> str:
    """Name a piece and where it is, as it is said in messages."""
    return f"{label}, x = {s:.2f} m"


def named_arms(arms: Sequence[tuple[str, str]]) -> str:
    """Return steady arms, each a place and what is wrong with it, in one phrase."""
    (first, what), *others = arms
    phrase = f"the steady arm at {first}, {what}"
    if not others:
        return phrase
    return f"{phrase}, and so at {'; '.join(f'{there}, {fault}' for there, fault in others)}"
