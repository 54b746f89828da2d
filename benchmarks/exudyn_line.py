"""The same two-wire line in tautwire and in Exudyn, side by side in one process.

``pip install exudyn==1.13.6``, then ``python benchmarks/exudyn_line.py --elements 14``. Prints CPU
seconds per simulated second of both and how well the contact forces agree. The case is
two_wires.yaml; both start from the static equilibrium with the pantograph pressing on the wire.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass, replace
from pathlib import Path

import machine
import numpy as np
from numpy.typing import NDArray

import tautwire as tw
from tautwire.model.build import Model
from tautwire.model.equations import equations
from tautwire.model.passage import plan_passage
from tautwire.numerics.contact.path import ContactWirePath
from tautwire.numerics.motion.backend import backend_name, make_stepper
from tautwire.numerics.motion.stepper import PantographInput, StepOptions
from tautwire.numerics.network.system import System
from tautwire.numerics.newmark import Newmark
from tautwire.numerics.statics.loaded_line import LoadedLine
from tautwire.numerics.statics.window import Push
from tautwire.specs.case import Case

Array = NDArray[np.float64]


@dataclass(frozen=True)
class History:
    """Contact force over time, and CPU time per simulated second."""

    time: Array
    force: Array
    cpu_per_s: float
    steps: int


def line(elements: int) -> tuple[Case, System, PantographInput]:
    """Return the case, its equations and its pantograph; the contact wire hangs free everywhere."""
    case = tw.load_case(Path(__file__).with_name("two_wires.yaml"))
    case = case.with_(**{"settings.nodes_between_droppers": elements + 1})
    case = case.with_(**{"supports.encumbrance": _loaded_encumbrances(case)})
    model = _hanging(tw.build(case))
    shape = tw.find_shape(model)
    system = equations(model, shape)
    return case, system, plan_passage(model, shape, case.uplift_forces()).pantographs[0]


def _loaded_encumbrances(case: Case) -> list[float]:
    """Lower the messenger wire at the inner supports by what its springs give way."""
    wires, droppers = case.wires, case.droppers
    span = case.line.span_lengths()[0]
    mass = (wires.contact.mass + wires.messenger.mass) * span + case.supports.spring.mass
    mass += len(droppers.positions_by_span(1)[0]) * (
        droppers.clamp_contact + droppers.clamp_messenger
    )
    height = case.supports.encumbrances(2)[0]
    inner = height - mass * case.line.gravity / case.supports.messenger_stiffness
    return [height, *[inner] * (case.line.spans - 1), height]


def _hanging(model: Model) -> Model:
    """Let the contact wire hang free at the supports while the shape is sought."""
    held = model.form.held.copy()
    held[6 * model.mesh.nodes(piece.at for piece in model.line.registrations) + 2] = False
    return replace(model, form=replace(model.form, held=held))


def in_balance(
    system: System, given: PantographInput, stiffness: float
) -> tuple[Array, PantographInput]:
    """Return coordinates and pantograph in static equilibrium with each other.

    The stages count from that state: their forces in it balance except the contact force on the
    head, which therefore is the external force of the moving system.
    """
    chain, window = given.chain, LoadedLine(system).window(increment=1e-10)
    wire = system.paths[0]
    path = ContactWirePath(wire.nodes, system.cables.length[wire.cables])
    flexibility = 1.0 / stiffness + float((1.0 / chain.stiffness[:-1]).sum())
    ground = given.start_height  # the base spring is slack with the head at the nominal height
    lift = float(given.stage_forces.sum())
    plane, force, q = given.plane(given.start_time), lift, system.position
    for _ in range(30):
        point = path.locate(q, plane)
        assert point is not None
        push = Push(point.dofs.reshape(1, -1), point.push.reshape(1, -1), force)
        q = window.respond([push])[0].position
        height = path.locate(q, plane).height  # type: ignore[union-attr]
        lowest = height - ground + force * flexibility
        force = lift - chain.stiffness[-1] * lowest
    start = replace(
        given,
        stage_forces=force * np.eye(chain.stage_count)[0],
        ramp=0.0,
        start_height=height + force / stiffness,
    )
    return q, start


def with_tautwire(elements: int, seconds: float) -> tuple[History, Case]:
    """Integrate with tautwire."""
    case, system, given = line(elements)
    settings = case.settings
    lift = case.uplift_forces()[0] * np.eye(given.chain.stage_count)[-1]
    level = replace(given, start_height=5.3, stage_forces=lift)
    q, start = in_balance(system, level, settings.contact_stiffness)
    options = StepOptions(
        Newmark(), settings.step(), settings.contact_stiffness, tolerance=settings.tolerance
    )
    stepper = make_stepper(system, [start], options, np.empty(0, dtype=np.int64))
    stepper.start_from(q, np.zeros_like(q))
    begin = time.process_time()
    block = stepper.advance(round(seconds / settings.step()))
    spent = time.process_time() - begin
    return History(block.time, block.contact_force[:, 0], spent / seconds, len(block.time)), case


def with_exudyn(case: Case, elements: int, seconds: float) -> History:
    """Integrate with Exudyn."""
    from exudyn_rig import ExudynLine  # so that tautwire's side runs where Exudyn is not installed

    rig = ExudynLine(case, elements)
    rig.find_equilibrium()
    begin = time.process_time()
    record = rig.integrate(seconds)
    spent = time.process_time() - begin
    return History(record[:, 0], record[:, 1], spent / seconds, len(record))


def main() -> None:
    """Run both and print the comparison."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--elements", type=int, default=14, help="elements per dropper interval")
    parser.add_argument("--seconds", type=float, default=4.5, help="simulated time")
    parser.add_argument("--out", type=Path, help="write time and both forces to this file")
    given = parser.parse_args()
    before = machine.measure()
    ours, case = with_tautwire(given.elements, given.seconds)
    theirs = with_exudyn(case, given.elements, given.seconds)
    again, _ = with_tautwire(given.elements, given.seconds)
    here = machine.measure().best_with(before)
    force = np.interp(ours.time, theirs.time, theirs.force)
    settled = ours.time > 0.1
    correlation = np.corrcoef(ours.force[settled], force[settled])[0, 1]
    cost = 0.5 * (ours.cpu_per_s + again.cpu_per_s)
    print(f"machine: dgemm {here.dgemm:.1f} GFlop/s, triad {here.cached:.1f} GB/s in cache")
    print(f"two-wire line, {given.elements} elements per dropper interval, {given.seconds} s")
    print(f"tautwire {backend_name()}: {cost:.3f} CPU s per simulated s")
    print(
        f"Exudyn: {theirs.cpu_per_s:.2f} CPU s per simulated s, {theirs.cpu_per_s / cost:.0f} times"
    )
    print(f"raw contact forces: correlation {correlation:.4f}", end=", ")
    print(f"mean {ours.force.mean():.2f} / {force.mean():.2f} N", end=", ")
    print(f"standard deviation {ours.force.std():.2f} / {force.std():.2f} N")
    if given.out:
        np.savetxt(given.out, np.column_stack([ours.time, ours.force, force]))


if __name__ == "__main__":
    main()
