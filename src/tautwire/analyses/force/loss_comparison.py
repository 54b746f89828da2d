"""Comparison of runs loss by loss."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from tautwire.analyses.force.contact_loss import contact_loss
from tautwire.errors import InputError
from tautwire.results.loss_comparison import LossComparison, LossMatch, LossPair
from tautwire.results.run import Run
from tautwire.results.statistics import ARC_DURATION, ContactLoss, LossEvent

SHORTEST = 1e-3
"""Shortest loss that counts in errors, as missed or as spurious [s]: the usual time step."""

_FARTHEST = ARC_DURATION
"""Losses that do not overlap are partners when their middles are nearer than this [s]: two losses
further apart than an arc that counts are two arcs."""


def compare_losses(
    runs: Mapping[str, Run | ContactLoss],
    reference: str | None = None,
    *,
    pantograph: str | None = None,
    section: tuple[int, int] | None = None,
    shortest: float = SHORTEST,
) -> LossComparison:
    """Compare the contact losses of several runs of the same passage with those of a reference.

    Losses are matched in time: those that overlap most first, then those whose middles are nearest
    and less than 5 ms apart. What stays alone was missed, or is spurious. The error of a duration
    is ``|t - t_ref| / t_ref``, as in Table 3 of the paper, with the reference in place of its
    variable time step.

    Parameters
    ----------
    runs : mapping of label to Run or ContactLoss
        At least two; contact losses that were read in another way may stand for a run.
    reference : str, optional
        Label of the reference; by default the last one.
    pantograph : str, optional
        Its name; the leading one by default.
    section : (first, last) span, optional
        1-based, both included; by default that of the case.
    shortest : float s
        Shorter losses are matched, but not counted in errors, as missed or as spurious.

    Returns
    -------
    LossComparison

    Raises
    ------
    InputError
        When there are fewer than two runs, or the reference or the pantograph is not there.

    Examples
    --------
    >>> print(compare_losses({"1 ms": coarse, "0.05 ms": fine}))  # doctest: +SKIP
    """
    labels = list(runs)
    if len(labels) < 2:
        raise InputError("a comparison of losses needs at least two runs")
    chosen = labels[-1] if reference is None else reference
    if chosen not in runs:
        raise InputError(f"no run is labelled {chosen!r}; there are: {', '.join(labels)}")
    losses = {label: _loss_of(run, pantograph, section) for label, run in runs.items()}
    matches = tuple(
        match_losses(label, losses[chosen], loss, shortest)
        for label, loss in losses.items()
        if label != chosen
    )
    return LossComparison(chosen, losses[chosen], matches)


def match_losses(
    label: str, reference: ContactLoss, other: ContactLoss, shortest: float = SHORTEST
) -> LossMatch:
    """Match the losses of a run with those of a reference, one to one.

    Parameters
    ----------
    label : str
        Name of the run.
    reference, other : ContactLoss
    shortest : float s
        Shorter losses are not counted as missed or as spurious.
    """
    partner = _partners(reference.events, other.events)
    pairs = tuple(
        LossPair(event, other.events[partner[i]])
        for i, event in enumerate(reference.events)
        if i in partner
    )
    taken = set(partner.values())
    return LossMatch(
        label=label,
        loss=other,
        pairs=pairs,
        missed=tuple(
            e for i, e in enumerate(reference.events) if i not in partner and e.duration >= shortest
        ),
        spurious=tuple(
            e for i, e in enumerate(other.events) if i not in taken and e.duration >= shortest
        ),
        shortest=shortest,
    )


def _loss_of(
    run: Run | ContactLoss, pantograph: str | None, section: tuple[int, int] | None
) -> ContactLoss:
    if isinstance(run, ContactLoss):
        return run
    name = run.pantographs[0].name if pantograph is None else run.pantograph(pantograph).name
    return next(loss for loss in contact_loss(run, section) if loss.pantograph == name)


def _partners(reference: Sequence[LossEvent], other: Sequence[LossEvent]) -> dict[int, int]:
    """Return the index of the partner of each loss of the reference that has one."""
    candidates = []
    for i, one in enumerate(reference):
        for j, two in enumerate(other):
            overlap = min(_end(one), _end(two)) - max(one.start, two.start)
            distance = abs(0.5 * (one.start + _end(one)) - 0.5 * (two.start + _end(two)))
            if overlap > 0.0:
                candidates.append((0, -overlap, i, j))
            elif distance < _FARTHEST:
                candidates.append((1, distance, i, j))
    partner: dict[int, int] = {}
    taken: set[int] = set()
    for _, _, i, j in sorted(candidates):
        if i not in partner and j not in taken:
            partner[i] = j
            taken.add(j)
    return partner


def _end(event: LossEvent) -> float:
    return event.start + event.duration
