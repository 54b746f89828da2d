"""Small lines for the tests: bare wires and oscillators as arrays, short catenaries as cases."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.road.shape import RESIDUAL, find_shape
from tautwire.model.build import Model, build
from tautwire.model.equations import equations
from tautwire.model.passage import plan_passage
from tautwire.numerics.elements import ancf
from tautwire.numerics.motion import backend
from tautwire.numerics.motion.pantograph import PantographChain
from tautwire.numerics.motion.reference_stepper import ReferenceStepper
from tautwire.numerics.motion.stepper import PantographInput, StepOptions
from tautwire.numerics.network.parts import TENSION_ONLY, Cables, Grounds, Path, Ties, law_allows
from tautwire.numerics.network.system import System, internal_force, lumped_mass
from tautwire.numerics.newmark import Integrator, Newmark
from tautwire.numerics.statics.form_finding import Form, FormProblem, find_form
from tautwire.numerics.statics.loaded_line import LoadedLine
from tautwire.numerics.statics.window import Push, Pushed
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.case import Case
from tautwire.specs.line.dropper import Droppers
from tautwire.specs.line.wire import Wire

Array = NDArray[Any]

HAS_CORE = backend._load()[0] is not None
"""Whether the compiled core is installed and runs on this processor."""
RUNNABLE = backend._native("auto").runnable if HAS_CORE else ()  # type: ignore[union-attr]
"""Names of the sets of kernels that this processor runs, widest first."""
NOTHING = np.empty(0, dtype=np.int64)
CONTACT_WIRE = {"tension": 22e3, "mass": 1.35, "axial": 15e6, "bending": 195.0}
"""Tension [N], mass [kg/m], EA [N], EI [N m2] of the contact wire of AC simple."""


def droppers_of(case: Case) -> Droppers:
    """Return the droppers of a case with one set of them."""
    assert isinstance(case.droppers, Droppers)
    return case.droppers


def messenger_of(case: Case) -> Wire:
    """Return the messenger wire of a case that has one."""
    assert case.wires.messenger is not None
    return case.wires.messenger


def stretch_under(tension: float, axial_stiffness: float) -> float:
    """Return |r'| at which ``EA (|r'|^2 - 1)/2 |r'|`` equals the tension (Green strain)."""
    roots = np.roots([0.5 * axial_stiffness, 0.0, -0.5 * axial_stiffness, -tension])
    return float(roots.real.max())


def loaded(system: System, load: Array) -> Pushed:
    """Return the static state of a whole line, nonlinear everywhere, under more nodal loads."""
    push = Push(np.arange(system.dof_count)[None], load[None], 1.0)
    return LoadedLine(system).window(increment=1e-9).respond([push])[0]


def empty_system(node_count: int) -> System:
    """Return nodes without anything between them, all free."""
    some = np.zeros(6 * node_count)
    return System(
        cables=Cables.none(),
        node_mass=np.zeros(node_count),
        load=some.copy(),
        fixed=some.astype(bool),
        position=some.copy(),
        paths=(Path("contact", np.arange(node_count), np.arange(node_count - 1)),),
    )


def wire_elements(lengths: Array, *, axial: float, bending: float, mass: float) -> System:
    """Return a chain of wire elements, unstrained along x, all nodes free."""
    count = len(lengths)
    position = np.zeros((count + 1, 6))
    position[1:, 0] = np.cumsum(lengths)
    position[:, 3] = 1.0
    return empty_system(count + 1).with_(
        cables=Cables(
            np.stack([np.arange(count), np.arange(1, count + 1)], 1),
            np.asarray(lengths, dtype=float),
            np.full(count, axial),
            np.full(count, bending),
            np.full(count, mass),
        ),
        position=position.ravel(),
    )


def rope(upper: int, lower: int, *, length: float, stiffness: float) -> Ties:
    """Return one massless tie between two nodes that carries tension only."""
    return Ties(
        nodes=np.array([[upper, lower]]),
        length=np.array([length]),
        stiffness=np.array([stiffness]),
        axial=np.array([np.nan]),
        mass=np.zeros(1),
        law=np.array([TENSION_ONLY]),
    )


def vertical_spring(node: int, stiffness: float, damping: float = 0.0) -> Grounds:
    """Return a vertical spring-damper to ground at one node, slack at z = 0."""
    matrix = np.diag([0.0, 0.0, 1.0])[None]
    return Grounds(np.array([node]), stiffness * matrix, damping * matrix, np.zeros((1, 3)))


def oscillator(mass: float, stiffness: float, damping: float = 0.0) -> System:
    """Return a mass on a grounded spring-damper (z of node 2) beside an immovable wire element."""
    system = wire_elements(np.ones(2), axial=1.0, bending=1.0, mass=1.0)
    fixed = np.ones(18, dtype=bool)
    fixed[14] = False
    return system.with_(
        cables=Cables(system.cables.nodes[:1], np.ones(1), np.ones(1), np.ones(1), np.ones(1)),
        paths=(Path("contact", np.arange(2), np.arange(1)),),
        grounds=vertical_spring(2, stiffness, damping),
        node_mass=np.array([0.0, 0.0, mass]),
        fixed=fixed,
    )


def straight_wire(length: float, elements: int, *, weighted: bool = False, **wire: float) -> System:
    """Return a straight weightless wire along x under tension, pinned at both ends.

    Parameters
    ----------
    length
        Stretched length [m].
    elements
        Number of elements.
    weighted
        True leaves the right end free along x under constant tension.
    **wire
        Replaces values of :data:`CONTACT_WIRE`.
    """
    data = {**CONTACT_WIRE, **wire}
    stretch = stretch_under(data["tension"], data["axial"])
    lengths = np.full(elements, length / elements / stretch)
    system = wire_elements(lengths, axial=data["axial"], bending=data["bending"], mass=data["mass"])
    position = system.position.reshape(-1, 6) * stretch
    fixed = np.zeros((elements + 1, 6), dtype=bool)
    fixed[[0, -1], :3] = True
    fixed[-1, 0] = not weighted
    load = np.zeros((elements + 1, 6))
    load[-1, 0] = data["tension"]
    return system.with_(position=position.ravel(), fixed=fixed.ravel(), load=load.ravel())


def hang(system: System, gravity: float) -> Form:
    """Find the shape of a wire between its ends under its weight, x of its nodes held."""
    held = np.zeros((system.node_count, 6), dtype=bool)
    held[[0, -1], :3] = True
    held[-1, 0] = False
    problem = FormProblem(
        system=system,
        held=held.ravel(),
        cable_slot=6 * system.cables.nodes[:, 1],
        tie_slot=NOTHING,
        gravity=gravity,
        taut=np.empty(0, dtype=bool),
    )
    return find_form(problem, RESIDUAL)


def kinetic_energy(system: System, v: Array) -> float:
    """Return the kinetic energy of wires and lumped masses [J]; arms as bars."""
    cables, stays = system.cables, system.stays
    e = cables.coordinates(v)
    m = ancf.mass_matrix(cables.length, cables.mass)
    total = 0.5 * np.einsum("ian,ijn,jan->", e, m, e) + 0.5 * lumped_mass(system) @ v**2
    arm = v.reshape(-1, 6)[stays.node, :3]
    return float(total + np.sum(stays.mass[:, None] * arm**2) / 6.0)


def potential_energy(system: System, q: Array) -> float:
    """Return the energy of cables, ties, clamps, stays and grounds, less the work of the loads."""
    cables, ties, clamps = system.cables, system.ties, system.clamps
    stays, grounds = system.stays, system.grounds
    total = ancf.energy(cables.coordinates(q), cables.section).sum()
    elongation = ties.state(q).length - ties.length
    elongation = np.where(law_allows(ties.law, elongation), elongation, 0.0)
    total += 0.5 * ties.stiffness @ elongation**2
    r = q.reshape(-1, 6)[:, :3]
    apart = r[clamps.nodes[:, 1]] - r[clamps.nodes[:, 0]] - clamps.offset
    total += 0.5 * clamps.stiffness @ np.sum(apart**2, axis=1)
    elongation = stays.state(q).length - stays.length
    elongation = np.where(law_allows(stays.law, elongation), elongation, 0.0)
    total += 0.5 * stays.stiffness @ elongation**2
    total += 0.5 * np.sum(grounds.pull(q) * (r[grounds.node] - grounds.free))
    return float(total - system.load @ q)


def out_of_balance(system: System, q: Array) -> float:
    """Return the largest unbalanced static force [N]."""
    r = internal_force(system, q).nodal - system.load
    return float(np.abs(r[~system.fixed]).max())


def stepper(
    system: System,
    time_step: float,
    *,
    integrator: Integrator | None = None,
    pantographs: tuple[PantographInput, ...] = (),
    observed: Array = NOTHING,
    **options: Any,
) -> ReferenceStepper:
    """Return a time integration; ``options`` go to :class:`StepOptions`."""
    options = {"contact_stiffness": 2e5, "tolerance": 1e-10, **options}
    return ReferenceStepper(
        system,
        pantographs,
        StepOptions(integrator or Newmark(), time_step, **options),
        observed,
    )


def one_stage(mass: float, stiffness: float = 0.0, damping: float = 0.0) -> PantographChain:
    """Return a pantograph of one stage."""
    return PantographChain(np.array([mass]), np.array([stiffness]), np.array([damping]))


AC_SIMPLE: dict[str, Any] = {
    "schema": 1,
    "name": "ac-simple",
    "line": {"spans": 3, "span_length": 55.0},
    "wires": {
        "contact": {
            "tension": 22000.0,
            "mass": 1.35,
            "axial_stiffness": 15e6,
            "bending_stiffness": 195.0,
        },
        "messenger": {
            "tension": 16000.0,
            "mass": 1.08,
            "axial_stiffness": 11.64e6,
            "bending_stiffness": 131.7,
        },
    },
    "supports": {"closure": "height", "encumbrance": 1.2, "contact_stagger": 0.2},
    "droppers": {
        "mode": "height",
        "positions": [4.5, 10.25, 16.0, 21.75, 27.5, 33.25, 39.0, 44.75, 50.5],
        "presag": [0.0, 0.024, 0.041, 0.052, 0.055, 0.052, 0.041, 0.024, 0.0],
        "stiffness": 2e5,
        "mass": 0.117,
        "clamp_contact": 0.165,
        "clamp_messenger": 0.195,
    },
    "pantographs": [
        {
            "name": "front",
            "stages": [
                {"mass": 7.5, "stiffness": 7000.0, "damping": 45.0},
                {"mass": 9.0, "stiffness": 15500.0, "damping": 0.1},
                {"mass": 6.0, "stiffness": 160.0, "damping": 100.0},
            ],
        }
    ],
    "scenario": {"speed": 320 / 3.6, "uplift_force": 174.2},
    "settings": {"contact_stiffness": 2e5, "nodes_between_droppers": 3, "section": [2, 2]},
}
"""AC simple of the world benchmark 2015, shortened to three spans on a coarse mesh."""


def ac_simple(**changes: Any) -> Case:
    """Return the short AC simple line; ``changes`` name fields as ``part__field``."""
    paths = {name.replace("__", "."): value for name, value in changes.items()}
    return Case.model_validate(AC_SIMPLE).with_(**paths)


def found(case: Case) -> tuple[Model, Equilibrium, System]:
    """Return model, shape and equations of a case."""
    model = build(case)
    shape = find_shape(model)
    return model, shape, equations(model, shape)


def entering(case: Case) -> tuple[System, tuple[PantographInput, ...]]:
    """Return the line of a case at rest and its pantographs as they enter."""
    model, shape, system = found(case)
    return system, plan_passage(model, shape, case.uplift_forces()).pantographs


def passage(
    case: Case, *, integrator: Integrator | None = None, **options: Any
) -> ReferenceStepper:
    """Return the time integration of a case's passage; the supports' heights are observed."""
    model, shape, system = found(case)
    settings = case.settings
    return stepper(
        system,
        settings.step(),
        integrator=integrator,
        pantographs=plan_passage(model, shape, case.uplift_forces()).pantographs,
        observed=6 * model.mesh.nodes(at for _, at in model.line.contact_supports) + 2,
        contact_stiffness=settings.contact_stiffness,
        **{"tolerance": settings.tolerance, **options},
    )


def moved(given: PantographInput, **changes: Any) -> PantographInput:
    """Return a pantograph with some of its data replaced."""
    return replace(given, **changes)
