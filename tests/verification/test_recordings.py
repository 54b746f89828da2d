"""Recordings made from known forces: processing, faults, alignment."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import tautwire as tw
from tautwire.errors import InputError
from tautwire.measured.alignment import Alignment, align
from tautwire.measured.evaluation import Treatment, evaluate
from tautwire.measured.events import force_events, hard_spots
from tautwire.measured.faults import find_faults, without_faulty_samples
from tautwire.measured.processing import (
    AerodynamicCorrection,
    EvenDistance,
    Filtering,
    InertiaCorrection,
    Processed,
    process,
)
from tautwire.measured.recording import Recording
from tautwire.measured.summary import stretch_statistics
from tautwire.report.pages.measured_page import write_measured_page
from tautwire.report.parts.recordings.measured import event_rows
from tautwire.signals.filters import SharpLowpass

from ..recordings import (
    DIALECTS,
    RATE,
    SPANS,
    STRIP_MASS,
    Truth,
    passage,
    passage_run,
    record,
    write_file,
)

Array = NDArray[np.float64]
Spoil = Callable[[Recording, np.random.Generator], Recording]

RECORDINGS = [
    pytest.param(range(4), id="4"),
    pytest.param(range(4, 60), id="60", marks=pytest.mark.slow),
]
SEEDS = [
    pytest.param(range(3), id="3"),
    pytest.param(range(3, 20), id="20", marks=pytest.mark.slow),
]


def _sensors(seed: int) -> int:
    return 2 if seed % 3 == 0 else 4


def _made(seed: int) -> Recording:
    return record(passage(), seed, sensors=_sensors(seed), stagger=seed % 4 != 1)


def _corrected(recording: Recording) -> Processed:
    masses = dict.fromkeys(recording.strips(), STRIP_MASS)
    clean = without_faulty_samples(recording, find_faults(recording))
    return process(clean, [InertiaCorrection(masses), Filtering(SharpLowpass(20.0))])


def _true_20_hz(time: Array) -> Array:
    truth = passage()
    even = np.arange(truth.time[0], truth.time[-1], 1.0 / RATE)
    smooth = SharpLowpass(20.0).apply(np.interp(even, truth.time, truth.force), 1.0 / RATE)
    return np.interp(time, even, smooth)


@pytest.mark.parametrize("seeds", RECORDINGS)
def test_processed_force_is_the_true_one(seeds: range) -> None:
    """Summed, corrected for inertia and filtered, the force is within 2 N rms of the truth up to
    20 Hz, its mean and standard deviation within 1 %."""
    for seed in seeds:
        signal = _corrected(_made(seed))
        truth = _true_20_hz(signal.time)
        known = ~np.isnan(signal.force)
        assert known.all(), seed
        assert np.sqrt(np.mean((signal.force - truth)[known] ** 2)) < 2.0
        assert signal.force[known].mean() == pytest.approx(truth[known].mean(), rel=0.01)
        assert signal.force[known].std() == pytest.approx(truth[known].std(), rel=0.01)


@pytest.mark.parametrize("seeds", RECORDINGS)
def test_clean_recordings_raise_no_alarm(seeds: range) -> None:
    """No fault is found in clean recordings with noise, vibration and a wheel that drifts."""
    found = {seed: [f.text for f in find_faults(_made(seed))] for seed in seeds}
    assert not {seed: texts for seed, texts in found.items() if texts}


@pytest.mark.parametrize("quantum", [0.5, 1.0, 5.0])
@pytest.mark.parametrize("rate", [200.0, 5000.0])
def test_smooth_coarse_forces_raise_no_alarm(rate: float, quantum: float) -> None:
    """A force that was filtered at 20 Hz before it was written in steps of 0.5 to 5 N stands still
    on its crests: neither a drop-out nor a clipped sensor. (The filter's flat ends are cut off.)"""
    truth = passage()
    time = np.arange(0.1, truth.time[-1] - 0.1, 1.0 / rate)
    smooth = np.interp(time, truth.time, _true_20_hz(truth.time))
    recording = Recording(
        "coarse", time, quantum * np.round(smooth / quantum)[None], np.array([1]),
        np.empty((0, len(time))), np.empty(0, dtype=np.int64),
    )  # fmt: skip
    assert find_faults(recording) == ()


def _on_sensor(change: Callable[[Array, np.random.Generator], Array]) -> Spoil:
    def spoil(recording: Recording, rng: np.random.Generator) -> Recording:
        forces = recording.forces.copy()
        row = int(rng.integers(len(forces)))
        forces[row] = change(forces[row].copy(), rng)
        return recording.with_(forces=forces)

    return spoil


def _frozen(force: Array, rng: np.random.Generator) -> Array:
    start = int(rng.integers(500, len(force) - 1500))
    length = int(rng.integers(50, 800))
    force[start : start + length] = (np.nan, 0.0, force[start])[int(rng.integers(3))]
    return force


def _spiked(force: Array, rng: np.random.Generator) -> Array:
    at = rng.integers(100, len(force) - 100, 5)
    force[at] += rng.choice([-1.0, 1.0], 5) * rng.uniform(60.0, 400.0, 5)
    return force


def _clipped(force: Array, rng: np.random.Generator) -> Array:
    return np.minimum(force, np.quantile(force, rng.uniform(0.9, 0.98)))


def _swapped_strips(recording: Recording, rng: np.random.Generator) -> Recording:
    return recording.with_(accelerations=recording.accelerations[::-1])


def _in_another_unit(recording: Recording, rng: np.random.Generator) -> Recording:
    return recording.with_(forces=recording.forces / rng.choice([1e3, 10.0, 9.80665]))


def _slow_clock(recording: Recording, rng: np.random.Generator) -> Recording:
    return recording.with_(
        time=recording.time * (1.0 + rng.choice([-1, 1]) * rng.uniform(0.012, 0.03))
    )


def _jumping(recording: Recording, rng: np.random.Generator) -> Recording:
    assert recording.distance is not None
    distance = recording.distance.copy()
    distance[int(rng.integers(1000, len(distance) - 1000)) :] += rng.uniform(3.0, 40.0)
    return recording.with_(distance=distance)


FAULTS: dict[str, Spoil] = {
    "drop-out": _on_sensor(_frozen),
    "spike": _on_sensor(_spiked),
    "saturation": _on_sensor(_clipped),
    "swapped sign": _on_sensor(lambda force, _: -force),
    "wrong unit": _in_another_unit,
    "dead sensor": _on_sensor(
        lambda force, rng: 20.0 + np.round(rng.normal(0, 0.3, len(force)), 2)
    ),
    "gain": _on_sensor(lambda force, rng: force * (1.0 + rng.choice([-0.1, 0.1]))),
    "swapped strips": _swapped_strips,
    "clock drift": _slow_clock,
    "position jump": _jumping,
}


@pytest.mark.parametrize("seeds", SEEDS)
@pytest.mark.parametrize("kind", FAULTS)
def test_faults_are_named(kind: str, seeds: range) -> None:
    """An injected fault is found by its name; at most one in twenty may be missed."""
    missed = []
    for seed in seeds:
        sensors = 4 if kind == "swapped strips" else _sensors(seed)
        spoiled = FAULTS[kind](
            record(passage(), seed, sensors=sensors), np.random.default_rng(seed)
        )
        if kind not in {fault.kind for fault in find_faults(spoiled)}:
            missed.append(seed)
    assert len(missed) <= len(seeds) // 20, missed


FILES = [
    pytest.param(range(3), id="3"),
    pytest.param(range(3, 60), id="60", marks=pytest.mark.slow),
]


@pytest.mark.parametrize("seeds", FILES)
def test_the_force_is_the_true_one_through_files(seeds: range, tmp_path: Path) -> None:
    """Written in the dialects of three recorders and read without a mapping, recordings raise no
    alarm and give the force within 2 N rms, mean and standard deviation within 1 %."""
    for seed in seeds:
        dialect = DIALECTS[seed % len(DIALECTS)]
        path = write_file(_made(seed), tmp_path / f"{seed}.{_ENDING[dialect]}", dialect)
        recording = tw.load_recording(path)
        assert find_faults(recording) == (), (seed, dialect)
        signal = _corrected(recording)
        truth = _true_20_hz(signal.time)
        known = ~np.isnan(signal.force)
        assert known.all(), seed
        assert np.sqrt(np.mean((signal.force - truth) ** 2)) < 2.0
        assert signal.force.mean() == pytest.approx(truth.mean(), rel=0.01)
        assert signal.force.std() == pytest.approx(truth.std(), rel=0.01)


_ENDING = {"plain": "csv", "German": "txt", "MAT": "mat"}


ONE_OF_20 = [
    pytest.param(range(1), id="1"),
    pytest.param(range(1, 20), id="20", marks=pytest.mark.slow),
]
ONE_AND_ALL_20 = [ONE_OF_20[0], pytest.param(range(20), id="20", marks=pytest.mark.slow)]


@pytest.mark.parametrize("seeds", ONE_OF_20)
@pytest.mark.parametrize("kind", FAULTS)
def test_faults_are_named_through_files(kind: str, seeds: range, tmp_path: Path) -> None:
    """An injected fault is found in what was read from a file; one in twenty may be missed."""
    missed = []
    for seed in seeds:
        sensors = 4 if kind == "swapped strips" else _sensors(seed)
        clean = record(passage(), seed, sensors=sensors)
        dialect = DIALECTS[seed % len(DIALECTS)]
        spoiled = FAULTS[kind](clean, np.random.default_rng(seed))
        path = write_file(spoiled, tmp_path / f"{seed}.{_ENDING[dialect]}", dialect)
        recording = tw.load_recording(path)
        if kind not in {fault.kind for fault in find_faults(recording)}:
            missed.append(seed)
    assert len(missed) <= len(seeds) // 20, missed


def _turned(recording: Recording) -> Recording:
    """Return a record whose positions run against its readings."""
    return recording.with_(
        forces=recording.forces[:, ::-1],
        accelerations=recording.accelerations[:, ::-1],
        stagger=None if recording.stagger is None else recording.stagger[::-1],
    )


def _of_another_line(seed: int) -> Recording:
    """Return a record of a track whose spans are up to 12 % longer and shorter."""
    truth = passage()
    order = np.random.default_rng(seed).permutation(len(SPANS))
    place = truth.position * (1.0 + 0.12 * np.sin(truth.position / 170.0 + order[0]))
    force = np.interp(truth.position, place, truth.force)
    return record(Truth(truth.time, truth.position, force, truth.speed), seed)


@pytest.mark.parametrize("seeds", ONE_AND_ALL_20)
@pytest.mark.parametrize("verdict", ["wrong direction", "does not match", "aligned"])
def test_places_are_judged_through_files(verdict: str, seeds: range, tmp_path: Path) -> None:
    """Read from a file and compared with the run, a record of the wrong direction and one of the
    neighbouring track are named in at least 19 of 20 files, and right ones are aligned."""
    missed = []
    for seed in seeds:
        made = {"wrong direction": lambda s: _turned(_made(s)), "aligned": _made,
                "does not match": _of_another_line}[verdict](seed)  # fmt: skip
        dialect = DIALECTS[seed % len(DIALECTS)]
        path = write_file(made, tmp_path / f"{seed}.{_ENDING[dialect]}", dialect)
        found = tw.compare_with_measurement(
            passage_run(), tw.load_recording(path), offset=60.0, search=30.0
        )
        if found.placement.verdict != verdict:
            missed.append((seed, found.placement.text))
    assert len(missed) <= len(seeds) // 20, missed


def _rows(recording: Recording, rows: NDArray[np.bool_] | Array) -> Recording:
    """Return some rows of a recording."""
    names = ("time", "speed", "distance", "height", "stagger")
    return recording.with_(
        forces=recording.forces[:, rows],
        accelerations=recording.accelerations[:, rows],
        **{name: getattr(recording, name)[rows] for name in names},
    )


def _with_height(seed: int) -> Recording:
    made = record(passage(), seed, sensors=_sensors(seed))
    assert made.distance is not None
    noise = np.random.default_rng(seed).normal(0.0, 1e-3, len(made.time))
    return made.with_(height=5.3 - 0.02 * np.cos(2.0 * np.pi * made.distance / 53.0) + noise)


def _jumped(recording: Recording, rng: np.random.Generator, by: float) -> Recording:
    assert recording.distance is not None
    at = int(rng.integers(len(recording.time) // 10, 9 * len(recording.time) // 10))
    later = np.arange(len(recording.time)) >= at
    return recording.with_(distance=recording.distance + by * later)


def _without_rows(recording: Recording, rng: np.random.Generator) -> Recording:
    way = recording.distance
    assert way is not None
    start = float(rng.choice(way[len(way) // 10 : 9 * len(way) // 10]))
    return _rows(recording, (way < start) | (way > start + rng.uniform(3.0, 40.0)))


def _twice(recording: Recording, _: np.random.Generator) -> Recording:
    half = np.arange(len(recording.time) // 2)
    return _rows(recording, np.concatenate([half, half]))


WITHOUT_TIME: dict[str, tuple[str, Spoil]] = {
    "on": ("position jump", lambda r, rng: _jumped(r, rng, rng.uniform(3.0, 40.0))),
    "back": ("position jump", lambda r, rng: _jumped(r, rng, -rng.uniform(10.0, 300.0))),
    "missing rows": ("rows are missing", _without_rows),
    "second passage": ("turns back", _twice),
    "clean": ("", lambda r, _: r),
}
"""What is wrong with files without time, and what is said then."""


@pytest.mark.parametrize("seeds", ONE_AND_ALL_20)
@pytest.mark.parametrize("kind", WITHOUT_TIME)
def test_positions_without_time_through_files(kind: str, seeds: range, tmp_path: Path) -> None:
    """Without a time a position that jumps, on or back, is told from rows that are missing and from
    a second passage by force, height and stagger, in at least 19 of 20 files of each."""
    said, spoil = WITHOUT_TIME[kind]
    missed = []
    for seed in seeds:
        spoiled = spoil(_with_height(seed), np.random.default_rng(100 + seed))
        path = write_file(spoiled, tmp_path / f"{seed}.csv", "plain", time=False)
        try:
            recording = tw.load_recording(path)
        except InputError as error:
            told = [str(error)]
        else:
            told = [*recording.notes, *(fault.kind for fault in find_faults(recording))]
        texts = dict.fromkeys(text for text, _ in WITHOUT_TIME.values() if text)
        known = [text for text in texts if text in " ".join(told)]
        if known != ([said] if said else []):
            missed.append((seed, known))
    assert len(missed) <= len(seeds) // 20, missed


def _struck(
    recording: Recording, seed: int, *, has_accelerometers: bool
) -> tuple[Recording, Array]:
    """Return a recording with three blows of 8 ms, and where they are [m]."""
    rng = np.random.default_rng(seed)
    assert recording.distance is not None
    count, length = len(recording.time), 8
    starts = np.sort(rng.choice(np.arange(1, 10), 3, replace=False)) * count // 10
    blow = np.zeros(count)
    for start in starts:
        blow[start : start + length] = np.sin(np.pi * (np.arange(length) + 0.5) / length)
    shares = 1.0 / len(recording.forces)
    if has_accelerometers:
        hardness = rng.uniform(60.0, 300.0)
        struck = recording.with_(
            accelerations=recording.accelerations + hardness * blow,
            forces=recording.forces + shares * STRIP_MASS * hardness * blow,
        )
    else:
        struck = recording.with_(
            accelerations=np.empty((0, count)),
            acceleration_strips=np.empty(0, dtype=np.int64),
            forces=recording.forces + shares * rng.uniform(300.0, 500.0) * blow,
        )
    return struck, recording.distance[starts + length // 2]


@pytest.mark.parametrize("seeds", ONE_OF_20)
@pytest.mark.parametrize("has_accelerometers", [True, False])
def test_hard_spots_are_found_through_files(
    has_accelerometers: bool, seeds: range, tmp_path: Path
) -> None:
    """Blows on the head, three to a run, are found within a metre by the acceleration, or by the
    force where there is no accelerometer, and nothing else is called hard."""
    for seed in seeds:
        struck, places = _struck(_made(seed), seed, has_accelerometers=has_accelerometers)
        dialect = DIALECTS[seed % len(DIALECTS)]
        path = write_file(struck, tmp_path / f"{seed}.{_ENDING[dialect]}", dialect)
        found = evaluate(tw.load_recording(path))
        hard = [one for one in found.events if one["kind"] == "hard spot"]
        assert len(hard) == 3, (seed, dialect, hard)
        assert np.abs([one["position"] for one in hard] - places).max() < 1.0
        assert {one["unit"] for one in hard} == {"m/s^2" if has_accelerometers else "N"}
        step = found.steps[-1]
        assert step["name"] == "hard spots"
        assert "no clause of a standard" in step["source"]


@pytest.mark.parametrize("seeds", RECORDINGS)
def test_clean_recordings_have_no_hard_spot(seeds: range) -> None:
    """Noise, vibrating strips and losses of contact are no hard spots, with and without
    accelerometers; neither is a glitch of one sample in an accelerometer."""
    for seed in seeds:
        clean = _made(seed)
        accelerations = clean.accelerations.copy()
        accelerations[0, 2000] = 400.0
        glitch = clean.with_(accelerations=accelerations)
        bare = clean.with_(
            accelerations=np.empty((0, len(clean.time))),
            acceleration_strips=np.empty(0, dtype=np.int64),
        )
        force = clean.forces.sum(axis=0)
        for recording in (clean, glitch, bare):
            assert hard_spots(recording, force, None)[0] == (), seed


def test_a_limit_of_ones_own_for_hard_spots() -> None:
    """With a given acceleration only what is beyond it is hard, and the step says that it was
    given; signs less than 5 m apart are one place, the hardest."""
    time = np.arange(0.0, 4.0, 1e-3)
    shock = np.zeros(len(time))
    for start, height in ((500, 300.0), (540, 600.0), (2000, 550.0), (3000, 400.0)):
        shock[start : start + 6] = height
    recording = Recording(
        "struck", time, np.full((1, len(time)), 100.0), np.array([1]), shock[None], np.array([1]),
        distance=70.0 * time,
    )  # fmt: skip
    every, _ = hard_spots(recording, None, 290.0)
    assert [one.extreme for one in every] == [600.0, 550.0, 400.0]
    assert every[0].position == pytest.approx(70.0 * 0.54)
    few, (step,) = hard_spots(recording, None, 490.0)
    assert [one.extreme for one in few] == [600.0, 550.0]
    assert step.parameters == {"by": "acceleration of the head", "limit_m_s2": {1: 490.0},
                               "source": "given", "examined_share": 1.0}  # fmt: skip


def _shaken(accelerations: Array, strips: list[int], **changes: Any) -> Recording:
    """Return a recording of 4 s at 1 kHz with the accelerations, 70 m/s fast, and a force."""
    time = np.arange(0.0, 4.0, 1e-3)
    whole = Recording(
        "shaken", time, 100.0 + np.sin(40.0 * time)[None], np.array([1]), accelerations,
        np.array(strips), distance=70.0 * time,
    )  # fmt: skip
    return whole.with_(**changes)


def _shock(*blows: tuple[int, int, float]) -> Array:
    """Return accelerations of 4 s at 1 kHz with blows: first sample, samples, height [m/s2]."""
    values = np.random.default_rng(5).normal(0.0, 1.0, 4000)
    for first, count, height in blows:
        values[first : first + count] = height
    return values


def test_hard_spots_without_a_way_have_no_position() -> None:
    """Without way and chainage blows a second apart are two, those within 0.1 s one, on the
    acceleration; they have no position, nor have losses, and the force is told over the time."""
    shock = _shock((500, 6, 300.0), (560, 6, 600.0), (2000, 6, 550.0), (2900, 6, 400.0))
    recording = _shaken(shock[None], [1], distance=None)
    hard, _ = hard_spots(recording, None, 290.0)
    assert [one.extreme for one in hard] == pytest.approx([600.0, 550.0, 400.0], abs=0.2)
    assert np.isnan([one.position for one in hard]).all()
    lost = np.arange(4000) // 200 == 16
    force = np.where(lost, -20.0, 100.0) + _shock()
    found = evaluate(recording.with_(forces=force[None]), Treatment(hard_above=290.0))
    assert {one["kind"] for one in found.events} >= {"loss", "hard spot"}
    assert {one["position"] for one in found.as_dict()["events"]} == {None}
    assert {row[1] for row in event_rows(found)} == {"\N{EN DASH}"}
    assert found.abscissa[0] == "time [s]"
    assert np.isfinite(found.abscissa[1]).all()


def test_hard_spots_are_placed_by_chainage_alone() -> None:
    """A chainage that falls is the way too, where no other was recorded."""
    shock = _shock((500, 6, 300.0), (540, 6, 600.0), (2000, 6, 550.0))
    chainage = 9000.0 - 70.0 * 1e-3 * np.arange(4000)
    hard, _ = hard_spots(_shaken(shock[None], [1], distance=None, chainage=chainage), None, 290.0)
    assert [one.position for one in hard] == pytest.approx([chainage[540], chainage[2000]])


def test_events_end_with_the_sample_after_them() -> None:
    """A hard spot of six samples at 1 kHz lasts 6 ms, as a loss of six does; what lasts to the end
    ends with the last sample."""
    shock = _shock((500, 6, 300.0), (3994, 6, 300.0))
    recording = _shaken(shock[None], [1])
    hard, _ = hard_spots(recording, None, 290.0)
    assert [one.end - one.start for one in hard] == pytest.approx([6e-3, 5e-3])
    force = np.where(shock == 300.0, -1.0, 100.0)
    losses = force_events(recording.time, recording.time, force, loss_below=0.0, high_above=1e3)
    assert [(one.start, one.end) for one in losses] == [(one.start, one.end) for one in hard]


def test_an_accelerometer_that_reads_nothing_hides_no_hard_spot() -> None:
    """Beside one that is missing or stands still, throughout or for a while, the other of the strip
    is looked at as if it were alone; the one left out is named as a step and as a fault."""
    shock, still = _shock((500, 6, 300.0), (2000, 6, 550.0)), np.full(4000, 9.81)
    for dead, said in ((np.full(4000, np.nan), "nothing"), (still, "9.81 m/s")):
        recording = _shaken(np.array([dead, shock]), [1, 1])
        hard, (step,) = hard_spots(recording, None, 290.0)
        assert [one.extreme for one in hard] == pytest.approx([300.0, 550.0], abs=0.2)
        assert step.parameters["examined_share"] == 1.0
        assert step.parameters["left_out"] == "accelerometer 1 of strip 1"
        for whole in (recording, recording.with_(forces=np.empty((0, 4000)))):
            faults = evaluate(whole).faults
            assert [(one["kind"], one["channel"]) for one in faults if said in one["text"]] == [
                ("dead sensor", "accelerometer 1 of strip 1")
            ]
    gaps = shock + 100.0
    gaps[400:1000] = np.nan
    hard, (step,) = hard_spots(_shaken(np.array([gaps, shock]), [1, 1]), None, 290.0)
    assert [one.extreme for one in hard] == pytest.approx([300.0, 550.0], abs=0.2)
    assert "left_out" not in step.parameters
    hard, (step,) = hard_spots(_shaken(gaps[None], [1]), None, 290.0)
    assert [one.extreme for one in hard] == pytest.approx([550.0], abs=0.2)
    assert step.parameters["examined_share"] == pytest.approx(1.0 - 600 / 4000)


def test_dead_accelerometers_leave_the_force() -> None:
    """Where no accelerometer says anything the force is looked at; where that cannot be, either,
    the step says that nothing was examined, and what it would need."""
    force = 100.0 + _shock((500, 6, 400.0))
    dead = _shaken(np.array([np.zeros(4000), np.full(4000, np.nan)]), [1, 2])
    (hard,), (step,) = hard_spots(dead, force, None)
    assert (hard.unit, step.parameters["by"]) == ("N", "force above its mean")
    assert hard.position == pytest.approx(70.0 * 0.5, abs=0.5)
    assert "accelerometer 1 of strip 2" in step.parameters["left_out"]
    for blind, want in (
        (dead.with_(distance=None), "a way"),
        (dead.with_(distance=2.0 * np.arange(4000)), "rows at most 1 m apart"),
    ):
        none, (step,) = hard_spots(blind, force, None)
        assert none == ()
        assert step.parameters["examined_share"] == 0.0
        assert want in step.parameters["for_want_of"]
    bare = dead.with_(
        accelerations=np.empty((0, 4000)), acceleration_strips=np.empty(0, dtype=np.int64)
    )
    assert hard_spots(bare, None, None) == ((), ())


def test_the_page_does_not_say_that_there_is_none_where_nobody_looked(tmp_path: Path) -> None:
    """Without a way and with a dead accelerometer, hard spots were not looked for."""
    recording = _shaken(np.zeros((1, 4000)), [1], distance=None)
    recording = recording.with_(forces=100.0 + _shock()[None])
    found = evaluate(recording, Treatment(high_above=500.0))
    page = write_measured_page(found, tmp_path / "page.html").read_text(encoding="utf-8")
    assert "hard spots were not looked for" in page
    assert "time [s]" in page


def test_inertia_of_a_free_strip() -> None:
    """A strip that touches nothing and shakes on its sensors carries no contact force."""
    time = np.arange(0.0, 2.0, 1e-3)
    acceleration = 30.0 * np.sin(2.0 * np.pi * 12.0 * time)
    recording = Recording(
        "free", time, 4.0 * acceleration[None], np.array([1]), acceleration[None], np.array([1])
    )
    signal = process(recording, [InertiaCorrection({1: 4.0})])
    assert np.abs(signal.force).max() < 1e-12
    assert [step.name for step in signal.steps] == ["sum of sensors", "inertia correction"]


def test_aerodynamic_correction() -> None:
    """The table is read linearly over the speed at every sample and held beyond its ends."""
    time = np.arange(0.0, 1.0, 0.1)
    speed = np.linspace(20.0, 90.0, len(time))
    recording = Recording(
        "air", time, np.full((1, len(time)), 100.0), np.array([1]), np.empty((0, len(time))),
        np.empty(0, dtype=np.int64), speed=speed,
    )  # fmt: skip
    signal = process(recording, [AerodynamicCorrection((40.0, 80.0), (-4.0, -16.0))])
    expected = 100.0 + np.interp(speed, [40.0, 80.0], [-4.0, -16.0])
    assert signal.force == pytest.approx(expected)


def test_even_distance_keeps_sigma() -> None:
    """Sampling every 0.25 m keeps the standard deviation up to 20 Hz within 0.2 %, also while the
    speed changes."""
    truth = passage()
    time = np.arange(0.0, truth.time[-1], 1.0 / RATE)
    force = SharpLowpass(20.0).apply(np.interp(time, truth.time, truth.force), 1.0 / RATE)
    distance = 60.0 * time + 1.5 * np.sin(2.0 * time)
    recording = Recording(
        "even", time, force[None], np.array([1]), np.empty((0, len(time))),
        np.empty(0, dtype=np.int64), distance=distance,
    )  # fmt: skip
    signal = process(recording, [EvenDistance(0.25)])
    assert signal.distance is not None
    assert np.diff(signal.distance) == pytest.approx(0.25)
    there = np.interp(signal.time, time, force)
    assert signal.force[50:-50].std() == pytest.approx(there[50:-50].std(), rel=2e-3)


def test_gaps_stay_gaps() -> None:
    """Missing samples are never bridged: they are missing in the sum, after the filter (with its
    reach) and after the change to even distance."""
    recording = _made(1)
    forces = recording.forces.copy()
    forces[0, 3000:3200] = np.nan
    signal = _corrected(recording.with_(forces=forces))
    assert np.isnan(signal.force[3000:3200]).all()
    assert np.isnan(signal.force[3000 - 50])
    assert not np.isnan(signal.force[3000 - 51])
    even = EvenDistance(0.25).apply(signal)
    assert even.missing_share == pytest.approx(signal.missing_share, abs=0.01)


def _aligned(recording: Recording, *, search: float = 30.0, start: float = 60.0) -> Alignment:
    signal = EvenDistance(0.25).apply(_corrected(recording))
    assert signal.distance is not None
    truth = passage()
    computed = _true_20_hz(truth.time)
    return align(signal.distance + start, signal.force, truth.position, computed, search=search)


@pytest.mark.parametrize("seeds", RECORDINGS)
def test_positions_are_found(seeds: range) -> None:
    """With a wheel that drifts by 0.3 % and a start that is 3 m off, 95 % of the positions are
    found within 0.3 m and all within 1 m; never a shift by a span."""
    truth = passage()
    for seed in seeds:
        recording = _made(seed)
        found = _aligned(recording)
        assert found.verdict == "aligned", (seed, found.text)
        assert recording.distance is not None
        true = np.interp(recording.time, truth.time, truth.position)
        error = np.abs(found.position(recording.distance + 60.0) - true)
        assert np.quantile(error, 0.95) < 0.3, (seed, found.text)
        assert error.max() < 1.0, (seed, found.text)


@pytest.mark.parametrize("seeds", SEEDS)
def test_wrong_direction_is_said(seeds: range) -> None:
    """A record that ran the other way is recognised and not aligned."""
    for seed in seeds:
        assert _aligned(_turned(_made(seed)), search=60.0).verdict == "wrong direction", seed


@pytest.mark.parametrize("seeds", SEEDS)
def test_neighbouring_track_is_said(seeds: range) -> None:
    """A record of a line with other spans does not match."""
    for seed in seeds:
        assert _aligned(_of_another_line(seed)).verdict == "does not match", seed


def test_equal_spans_are_undecidable() -> None:
    """Where spans repeat and the start may be off by more than a span, no position is claimed."""
    x = np.arange(0.0, 1500.0, 0.25)
    force = 120.0 + 30.0 * np.sin(2.0 * np.pi * x / 50.0) + 8.0 * np.sin(2.0 * np.pi * x / 5.0)
    found = align(x[:3000] + 200.0, force[800:3800], x, force, search=60.0)
    assert found.verdict == "undecidable"
    assert "equal spans" in found.text
    near = align(x[:3000] + 199.0, force[800:3800], x, force, search=20.0)
    assert near.verdict == "aligned"
    assert near.position(np.array([500.0])) == pytest.approx(501.0, abs=0.05)


def test_figures_of_stretches() -> None:
    """Mean, deviation and extremes of each span; a span with gaps tells its measured share, one
    without any sample has no figures."""
    position = np.arange(0.0, 30.0, 0.5)
    force = np.where(position < 10.0, 100.0, 100.0 + 10.0 * (-1.0) ** np.arange(60))
    force[(position >= 10.0) & (position < 15.0)] = np.nan
    force[position >= 20.0] = np.nan
    calm, gappy, empty = stretch_statistics(position, force, [0.0, 10.0, 20.0, 30.0], "abc")
    assert (calm.mean, calm.standard_deviation, calm.measured_share) == (100.0, 0.0, 1.0)
    assert (gappy.standard_deviation, gappy.maximum, gappy.measured_share) == (10.0, 110.0, 0.5)
    assert np.isnan(empty.mean)
    assert empty.measured_share == 0.0


def test_events() -> None:
    """A loss and a high force are told with duration and extreme; a short one is left out."""
    time = np.arange(0.0, 1.0, 0.01)
    force = np.full(100, 100.0)
    force[20:25], force[50:52], force[80] = -1.0, 260.0, 300.0
    loss, high = force_events(
        time, 70.0 * time, force, loss_below=0.0, high_above=250.0, shortest=0.015
    )
    assert (loss.kind, high.kind) == ("loss", "high force")
    assert loss.end - loss.start == pytest.approx(0.05)
    assert (loss.position, high.extreme) == (pytest.approx(14.0), 260.0)
