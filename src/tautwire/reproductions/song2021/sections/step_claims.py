"""Verdicts of section V: how long contact losses last, by time step."""

from __future__ import annotations

import math
from collections.abc import Sequence

from tautwire.analyses.force.contact_loss import contact_loss
from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.claims import Claim, Condition, Evidence, least, most
from tautwire.reproductions.song2021.passages import (
    LINES,
    MESHES,
    UNCALIBRATED,
    series,
    standard,
)
from tautwire.reproductions.song2021.sections.forces import Passages
from tautwire.reproductions.song2021.sections.irregular import COARSE, FINE, FINEST, VARIABLE
from tautwire.reproductions.song2021.sections.steps import (
    COUNTED_1,
    COUNTED_5,
    INTERPOLATED,
    PAPER,
    REFERENCE,
    REFINED,
    Trial,
    is_better,
    published_errors,
)
from tautwire.reproductions.song2021.sections.stiffness import ALIKE
from tautwire.results.loss_comparison import LossMatch

SMALL_ERROR = published.LARGEST_ERROR_CONSTANT_5
"""The paper's own bound for a duration that is nearly right [%]."""

BY_CHANCE = 0.05
"""Largest chance at which an advantage counts as shown."""


def claims(passages: Passages, trials: Sequence[Trial]) -> list[Claim]:
    """Judge section V.

    Parameters
    ----------
    passages
    trials
        Irregular wires; those without a loss long enough have nothing to say about durations.
    """
    lossy = [t for t in trials if any(m.judged for m in t.against(PAPER).values())]
    return [
        _no_loss(passages),
        _waveform(trials),
        _large_error(lossy),
        _missed(lossy),
        _beyond(lossy),
        _fine_step(lossy),
        _better(lossy),
        _method(lossy),
    ]


def _no_loss(passages: Passages) -> Claim:
    found = tuple(
        most(
            Condition(f"{reading}, NAD {m}", reading != UNCALIBRATED),
            "contact losses on the ideal line",
            contact_loss(passages.run(standard(m, reading)))[0].count,
            0.0,
            "",
        )
        for line in LINES
        for reading in series(line)
        for m in (MESHES[0], MESHES[-2])
        if passages.has(standard(m, reading))
    )
    text = "Simulations in ideal conditions cannot reproduce contact loss."
    return Claim("losses-ideal", "V.B", text, found)


def _waveform(trials: Sequence[Trial]) -> Claim:
    found: list[Evidence] = []
    for trial in trials:
        for step in (COARSE, FINE):
            text = f"correlation of the force with that of the variable step, {step}"
            found.append(least(trial.condition, text, trial.alike(VARIABLE, step), ALIKE, "1"))
        text = "the same, variable step beside 0.05 ms"
        found.append(Evidence(trial.condition, text, trial.alike(VARIABLE, FINEST), "1"))
    text = "The waveforms of the force by all three time steps are generally similar (Fig. 18)."
    return Claim("losses-waveform", "V.B", text, tuple(found))


def _large_error(trials: Sequence[Trial]) -> Claim:
    found: list[Evidence] = []
    for trial in trials:
        match = trial.against(PAPER)[COUNTED_1]
        found += [
            Evidence(trial.condition, "largest difference of 1 ms, counted, from the variable step",
                     100.0 * match.largest_error, "%", low=SMALL_ERROR,
                     published=published.LARGEST_ERROR_CONSTANT_1),
            Evidence(trial.condition, "median of these differences", 100.0 * match.median_error,
                     "%", published=published_errors(published.LOSS_CONSTANT_1)[0]),
            Evidence(trial.condition, "the same for 1 ms, interpolated",
                     100.0 * trial.against(PAPER)[INTERPOLATED].median_error, "%"),
        ]  # fmt: skip
    text = (
        "Counted at the constant step of 1 ms, durations differ from those of the variable step by "
        f"up to 75.63 % (limit: more than the {SMALL_ERROR:g} % the paper grants the step of 0.2 "
        "ms)."
    )
    return Claim("losses-1ms", "V.B", text, tuple(found))


def _missed(trials: Sequence[Trial]) -> Claim:
    found: list[Evidence] = []
    for trial in trials:
        match = trial.against(PAPER)[COUNTED_1]
        found += [
            Evidence(trial.condition, "losses of the variable step that 1 ms, counted, does not "
                     "see", len(match.missed), "", low=1.0, published=2.0),
            Evidence(trial.condition, "losses of the variable step", match.loss.count, ""),
        ]  # fmt: skip
    text = "Two losses that the variable step sees are not captured by the constant step of 1 ms."
    remark = (
        "Both passages lie within the error of their common step of 1 ms of each other, so a loss "
        "of one is nearly always a loss of the other."
    )
    return Claim("losses-missed", "V.B", text, tuple(found), remark)


def _beyond(trials: Sequence[Trial]) -> Claim:
    found = tuple(
        Evidence(trial.condition, "losses of 0.2 ms, counted, that the variable step does not see",
                 len(trial.against(COUNTED_5)[PAPER].missed), "", low=1.0, published=2.0)
        for trial in trials
    )  # fmt: skip
    text = "Two losses of the constant step of 0.2 ms are not captured by the variable step."
    return Claim("losses-beyond", "V.B", text, found)


def _fine_step(trials: Sequence[Trial]) -> Claim:
    found: list[Evidence] = []
    for trial in trials:
        match = trial.against(PAPER)[COUNTED_5]
        found += [
            Evidence(trial.condition, "largest difference of 0.2 ms, counted, from the variable "
                     "step", 100.0 * match.largest_error, "%", high=SMALL_ERROR, published=18.44),
            Evidence(trial.condition, "median of these differences", 100.0 * match.median_error,
                     "%", published=published_errors(published.LOSS_CONSTANT_5)[0]),
        ]  # fmt: skip
    text = "Durations by the constant step of 0.2 ms and the variable step differ by up to 20 %."
    remark = (
        "The variable step locates instants in a history that its step of 1 ms has already "
        "distorted; the difference is that of the histories."
    )
    return Claim("losses-5khz", "V.B", text, tuple(found), remark)


def _better(trials: Sequence[Trial]) -> Claim:
    found: list[Evidence] = []
    for trial in trials:
        chance = is_better(trial, PAPER, COUNTED_1)
        if math.isnan(chance):  # too few losses to tell
            continue
        found += _errors(trial, trial.against(REFERENCE), (PAPER, INTERPOLATED, COUNTED_1))
        found.append(most(trial.condition, "chance of so clear an advantage over 1 ms, counted, if "
                          "there were none", 100.0 * chance, 100.0 * BY_CHANCE))  # fmt: skip
    text = (
        "The variable step improves the accuracy of durations over counting at the same sampling "
        f"(limit: signed-rank test against 0.05 ms, {100 * BY_CHANCE:g} %)."
    )
    return Claim("losses-better", "V.B", text, tuple(found))


def _method(trials: Sequence[Trial]) -> Claim:
    found: list[Evidence] = []
    for trial in trials:
        matches = trial.against(REFERENCE)
        found += _errors(trial, matches, (PAPER, COUNTED_5, REFINED))
        ratio = matches[PAPER].median_error / matches[COUNTED_5].median_error
        found += [
            most(trial.condition, "median error of the variable step over that of 0.2 ms, counted",
                 ratio, 1.0, "1"),
            most(trial.condition, "processor time of the variable step over that of 0.2 ms",
                 trial.cpu(VARIABLE) / trial.cpu(FINE), 1.0, "1"),
        ]  # fmt: skip
    text = (
        "The variable step captures durations accurately without a very high sampling frequency "
        "(limit: as accurate as 0.2 ms, counted, beside 0.05 ms, and cheaper)."
    )
    return Claim("losses-method", "V.B, VI.5", text, tuple(found))


def _errors(trial: Trial, matches: dict[str, LossMatch], ways: Sequence[str]) -> list[Evidence]:
    """Show median errors against the reference."""
    return [
        Evidence(trial.condition, f"median error of {way}", 100.0 * matches[way].median_error, "%")
        for way in ways
    ]
