"""What the compiled core accepts from Python: exactly what it needs, never a converted copy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.numerics.motion import backend, native_line, native_stepper
from tautwire.numerics.motion.native_line import NodeOrder
from tautwire.numerics.motion.native_stepper import NativeStepper
from tautwire.numerics.motion.stepper import StepOptions
from tautwire.numerics.newmark import Newmark

from ..lines import HAS_CORE, ac_simple, entering, moved

pytestmark = pytest.mark.skipif(not HAS_CORE, reason="no compiled core here")

Array = NDArray[Any]
TWO_SPANS: dict[str, Any] = {"line__spans": 2, "settings__section": (1, 1)}
MEASURES = (
    "node_mass",
    "tie_length",
    "clamp_stiffness",
    "stay_length",
    "ground_node",
    "path_stiffness",
)
"""Arrays whose length is a count of the line, by which others are measured."""
OPTIONS = StepOptions(Newmark(), 1e-3, 2e5, tolerance=3e-8)


def single(array: Array) -> Array:
    """Return the numbers of an array in another type."""
    return array.astype(np.float32 if array.dtype == float else np.int32)


def strided(array: Array) -> Array:
    """Return the same numbers with gaps between them in memory."""
    wide = np.repeat(array[..., None], 2, axis=-1)
    return wide[..., 0]


def short(array: Array) -> Array:
    """Return all but the first row."""
    return np.ascontiguousarray(array[1:])


def unaligned(array: Array) -> Array:
    """Return the same numbers at an address that is no multiple of their size."""
    memory = np.zeros(array.nbytes + 1, np.uint8)[1:]
    moved_array = memory.view(array.dtype).reshape(array.shape)
    moved_array[...] = array
    return moved_array


SPOILT: dict[str, tuple[Callable[[Array], Any], str]] = {
    "other type": (single, "float32|int32|uint8|float64"),
    "gaps in memory": (strided, "not contiguous"),
    "too short": (short, "expected"),
    "not aligned": (unaligned, "expected a"),
    "a list": (lambda array: array.tolist(), "a list"),
    "byte order": (lambda array: array.astype(array.dtype.newbyteorder()), "expected a"),
}


def core() -> Any:
    """Return the compiled module."""
    return backend._load()[0]


def line_arrays() -> dict[str, Any]:
    """Return the arrays of a short line as the core takes them."""
    system, _ = entering(ac_simple(**TWO_SPANS | {"line__ends": "weighted"}))
    order = NodeOrder.of(system.cables.nodes, system.node_count)
    return native_line.line_arrays(system, order, None, 2e5)


def is_spoilt(change: str, name: str, array: Any) -> bool:
    """Tell whether a change makes an argument unfit."""
    if not isinstance(array, np.ndarray) or array.size < 2:
        return False
    if change == "too short":
        return name not in MEASURES
    return array.dtype != bool or change not in ("byte order", "not aligned")


@pytest.mark.parametrize("change", SPOILT)
def test_every_array_of_a_line_is_checked(change: str) -> None:
    """Each array of a line is refused by name when it is not as the core needs it."""
    spoil, words = SPOILT[change]
    arrays, scheme = line_arrays(), native_stepper._scheme(OPTIONS, 3e-8, threads=1)
    core().Stepper(arrays, scheme)
    spoilt = [name for name, array in arrays.items() if is_spoilt(change, name, array)]
    assert len(spoilt) >= 10
    for name in spoilt:
        with pytest.raises(TypeError, match=rf"^{name} is .*({words})"):
            core().Stepper(arrays | {name: spoil(arrays[name])}, scheme)


@pytest.mark.parametrize("change", SPOILT)
def test_histories_are_not_converted(change: str) -> None:
    """Histories of a wrong kind are refused before a step is taken, and say what was expected."""
    spoil, words = SPOILT[change]
    system, pantographs = entering(ac_simple(**TWO_SPANS))
    stepper = NativeStepper(core(), system, pantographs, OPTIONS, np.array([2, 14]))
    asked = {"time_step": 1e-3, "observed": np.array([2, 14]), "until_crossing": False}
    known = stepper._coming(4, 1e-3).arrays | asked
    histories = {k: np.zeros_like(v) for k, v in stepper._empty_histories(4).items()}
    histories["refused_gap"] = np.zeros(1)
    spoilt = [name for name, array in histories.items() if array.size > 1]
    for name in spoilt:
        with pytest.raises(TypeError, match=rf"^{name} is .*({words})"):
            stepper._core.advance(known, histories | {name: spoil(histories[name])})
    assert stepper._core.counters()[0] == 0
    assert stepper._core.advance(known, histories) == (4, 0)


def test_read_only_histories_are_refused() -> None:
    """An array that may not be written to is no place for results."""
    system, pantographs = entering(ac_simple(**TWO_SPANS))
    stepper = NativeStepper(core(), system, pantographs, OPTIONS, np.array([2]))
    out = np.empty(system.dof_count)
    out.flags.writeable = False
    with pytest.raises(TypeError, match=r"^out is .*writable contiguous float64"):
        stepper._core.coordinates(out)


def test_element_kernels_take_float64_only() -> None:
    """Single precision in gave coordinates of the wrong memory; now it is refused."""
    e, one, out = np.ones((4, 3, 2)), np.ones(2), np.empty((4, 3, 2))
    with pytest.raises(
        TypeError, match=r"^e is float32 \(4, 3, 2\); expected a contiguous float64"
    ):
        core().cable_force(e.astype(np.float32), one, one, one, out)
    with pytest.raises(TypeError, match=r"^out is float32 \(4, 3, 2\); expected a writable"):
        core().cable_force(e, one, one, one, out.astype(np.float32))


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("time_step", 0.0, "positive"),
        ("time_step", float("nan"), "positive"),
        ("time_step", "1 ms", "expected a number"),
        ("full_newton", 1, "expected True or False"),
        ("threads", 0, "from 1 to 2"),
        ("threads", 3, "from 1 to 2"),
    ],
)
def test_numbers_of_a_scheme_are_checked(name: str, value: Any, words: str) -> None:
    """A scheme with a step of zero or a word for a number is refused by name."""
    scheme: dict[str, Any] = native_stepper._scheme(OPTIONS, 3e-8, threads=1)
    with pytest.raises((TypeError, ValueError), match=rf"^{name} .*{words}"):
        core().Stepper(line_arrays(), scheme | {name: value})


@pytest.mark.parametrize("name", ["tie_nodes", "stay_node", "ground_node"])
def test_places_outside_the_line_are_refused(name: str) -> None:
    """An index outside the line names itself and its limits."""
    arrays = line_arrays()
    for wrong in (-1, arrays["position"].size):
        index = arrays[name].copy()
        index[-1] = wrong
        with pytest.raises(ValueError, match=rf"^{name} holds {wrong}; expected 0 to"):
            core().Stepper(arrays | {name: index}, native_stepper._scheme(OPTIONS, 3e-8, threads=1))


def test_twenty_pantographs() -> None:
    """As many pantographs as a case may have run in both backends, with equal forces."""
    system, (first,) = entering(ac_simple(**TWO_SPANS))
    options = StepOptions(Newmark(), 1e-3, 2e5, tolerance=1e-12)
    wire = system.position.reshape(-1, 6)[system.paths[0].nodes]
    places = first.start_x + 4.0 * np.arange(20)
    heights = np.interp(places, wire[:, 0], wire[:, 2])
    train = tuple(
        moved(first, start_x=x, start_height=z) for x, z in zip(places, heights, strict=True)
    )
    native, reference = (
        backend.make_stepper(system, train, options, np.array([2]), choice).advance(60)
        for choice in ("native", "reference")
    )
    assert len(native.time) == len(reference.time) == 60
    assert (native.contact_force.max(axis=0) > 1.0).sum() >= 12
    np.testing.assert_allclose(native.contact_force, reference.contact_force, rtol=0.0, atol=1e-5)
