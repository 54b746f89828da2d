"""Damaged and foreign result files: refused in one sentence, in time, without a trace of HDF5.

``python -m tests.unit.test_damaged_results COUNT SEED`` does the same for many more files.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from tautwire.errors import InputError
from tautwire.results.equilibrium import Elasticity
from tautwire.results.run import Run
from tautwire.results.storage import load_elasticity, load_equilibrium, load_run, run_image, trial
from tautwire.results.storage.seal import Seal, seal_of, sealed

from .synthetic import make_case, make_elasticity, make_run

SECONDS = 5.0
"""Processor time, children included, which a busy machine does not stretch [s]."""
SEAL_LENGTH = len(sealed(b""))
Random = np.random.Generator


def image() -> bytes:
    """Return the bytes of a run's file."""
    case = make_case(spans=4, pantographs=2)
    return run_image(make_run(case, duration=0.3), make_elasticity(case))


# ---- ways to damage the bytes --------------------------------------------------------------------


def _some_bytes(random: Random, content: bytes) -> bytes:
    data = bytearray(content)
    for _ in range(int(random.integers(1, 9))):
        data[random.integers(len(data))] = random.integers(256)
    return bytes(data)


def _a_stretch(random: Random, content: bytes) -> bytes:
    begin = int(random.integers(len(content)))
    count = int(2 ** random.uniform(1, 13))
    fill = random.bytes(count) if random.random() < 0.5 else bytes(count)
    return content[:begin] + fill + content[begin + count :]


def _cut(random: Random, content: bytes) -> bytes:
    return content[: random.integers(8, len(content))]


def _moved(random: Random, content: bytes) -> bytes:
    begin, end, to = sorted(random.integers(8, len(content), 3))
    return content[:begin] + content[end:to] + content[begin:end] + content[to:]


def _structure(random: Random, content: bytes) -> bytes:
    """Change a few bytes where HDF5 keeps its own structures: among the first 8 kB."""
    data = bytearray(content)
    for _ in range(int(random.integers(1, 4))):
        data[random.integers(8, 8192)] = random.integers(256)
    return bytes(data)


# ---- ways to change what the file holds ----------------------------------------------------------


def _everything(file: h5py.File) -> list[str]:
    names: list[str] = []
    file.visititems(lambda name, item: names.append(name) if hasattr(item, "shape") else None)
    return names


def _reshaped(random: Random, file: h5py.File) -> None:
    name = random.choice(_everything(file))
    shape = [max(0, n + int(random.integers(-2, 3))) for n in file[name].shape] or [2]
    if random.random() < 0.3:
        shape = shape[:-1] if random.random() < 0.5 else [*shape, 2]
    kind = file[name].dtype
    del file[name]
    file.create_dataset(name, shape, kind)


def _retyped(random: Random, file: h5py.File) -> None:
    name = random.choice(_everything(file))
    shape = file[name].shape
    del file[name]
    file.create_dataset(name, shape, random.choice(["f4", "i8", "S3", "u1", "c16", "?"]))


def _counters(random: Random, file: h5py.File) -> None:
    name = random.choice(
        ["stage_count", "pantograph", "equilibrium/dropper_span", "elasticity/span"]
    )
    data = file[name]
    data[0] = "nobody" if name == "pantograph" else random.choice([-1, 0, 99, 2**31 - 1])


def _attribute(random: Random, file: h5py.File) -> None:
    name = random.choice(
        ["case", "counters", "warnings", "provenance", "status", "message", "kind"]
    )
    values = [
        "",
        "[]",
        "{}",
        "null",
        '{"steps": "many"}',
        "[1, 2]",
        7,
        np.arange(3),
        "NaN",
        "x" * 70000,
    ]
    if random.random() < 0.3:
        del file.attrs[name]
    else:
        file.attrs[name] = values[random.integers(len(values))]


def _deleted(random: Random, file: h5py.File) -> None:
    del file[random.choice([*_everything(file), "snapshots", "equilibrium"])]


def _gigantic(random: Random, file: h5py.File) -> None:
    name = random.choice(["time", "contact_force", "equilibrium/position", "snapshots/x"])
    shape = [n * 10 ** int(random.integers(6, 10)) for n in file[name].shape]
    del file[name]
    file.create_dataset(name, shape, "f8", chunks=tuple(min(n, 100) for n in shape))


BYTES: tuple[Callable[[Random, bytes], bytes], ...] = (
    _some_bytes, _a_stretch, _cut, _moved, _structure,
)  # fmt: skip
HOLDINGS: tuple[Callable[[Random, h5py.File], None], ...] = (
    _reshaped, _retyped, _counters, _attribute, _deleted, _gigantic,
)  # fmt: skip


def mutated(random: Random, content: bytes) -> bytes:
    """Return a damaged copy of a file, with its seal, without, or changed by another program."""
    chance = random.random()
    if chance < 0.3:
        return BYTES[random.integers(len(BYTES))](random, content)
    bare = content[:-SEAL_LENGTH]
    if chance < 0.65:
        return BYTES[random.integers(len(BYTES))](random, bare)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "other.nc"
        path.write_bytes(bare)
        with h5py.File(path, "a") as file:
            HOLDINGS[random.integers(len(HOLDINGS))](random, file)
        return path.read_bytes()


def outcome(path: Path) -> str:
    """Load a file as everything it could be and use what was loaded; name what came of it."""
    from tautwire.analyses.force.statistics import contact_statistics

    begin = sum(os.times()[:4])
    try:
        run = load_run(path)
    except InputError as error:
        text = str(error)
        assert "\n" not in text
        assert ";" in text
        assert sum(os.times()[:4]) - begin < SECONDS, "refused too late"
        return "refused"
    contact_statistics(run)
    load_equilibrium(path)
    assert isinstance(load_elasticity(path), Elasticity | None)
    return "read"


@pytest.fixture(scope="module")
def whole() -> bytes:
    """The bytes of a sealed file."""
    return image()


@pytest.mark.parametrize("seed", range(24))
def test_damaged_file_is_refused_or_harmless(
    seed: int, whole: bytes, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Whatever was done to a file, it is refused with one sentence and a cure within 5 s, or what
    it holds can be used; nothing is written to standard error."""
    path = tmp_path / "run.nc"
    path.write_bytes(mutated(np.random.default_rng(seed), whole))
    assert outcome(path) in {"refused", "read"}
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("damage", [_some_bytes, _a_stretch, _moved, _structure])
def test_seal_finds_every_damage(damage: Callable[[Random, bytes], bytes], whole: bytes) -> None:
    """A sealed file of which one byte differs does not reach the HDF5 library."""
    random = np.random.default_rng(7)
    body = whole[:-SEAL_LENGTH]
    for _ in range(50):
        bad = damage(random, body)
        if bad != body:
            assert seal_of(bad + whole[-SEAL_LENGTH:]) is Seal.BROKEN
    assert seal_of(whole) is Seal.WHOLE
    assert seal_of(body) is Seal.NONE
    assert seal_of(whole[:-3]) is Seal.BROKEN


def test_file_of_an_earlier_version_loads(whole: bytes, tmp_path: Path) -> None:
    """A file without a seal, as earlier versions wrote it, still loads."""
    path = tmp_path / "run.nc"
    path.write_bytes(whole[:-SEAL_LENGTH])
    assert isinstance(load_run(path), Run)


def test_endless_reading_is_ended(
    whole: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A child that spends its processor time is ended by the system, and the file is refused."""
    monkeypatch.setattr(
        trial, "COMMAND",
        ("-c", "import sys; from tautwire.results.storage.trial import limit_process\n"
               "limit_process(-59_000_000)\nwhile True: pass"),
    )  # fmt: skip
    path = tmp_path / "run.nc"
    path.write_bytes(whole[:-SEAL_LENGTH])
    begin = os.times()
    with pytest.raises(InputError, match="cannot read it"):
        load_run(path)
    spent = sum(os.times()[2:4]) - sum(begin[2:4])
    assert 0.05 < spent < 2.0


def main(count: int, seed: int) -> None:
    """Damage many files and count what comes of them."""
    content, found = image(), Counter[str]()
    slowest = 0.0
    for number in range(count):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "run.nc"
            path.write_bytes(mutated(np.random.default_rng([seed, number]), content))
            begin = time.perf_counter()
            try:
                found[outcome(path)] += 1
            except Exception as error:  # noqa: BLE001 every kind of failure is counted
                found[f"{type(error).__name__}"] += 1
                sys.stdout.write(f"{number}: {type(error).__name__}: {error}\n")
            slowest = max(slowest, time.perf_counter() - begin)
    sys.stdout.write(f"{dict(found)}, slowest {slowest:.2f} s\n")


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
