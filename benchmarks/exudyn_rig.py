"""A plane two-wire line with tension-only droppers and a moving contact in Exudyn 1.13.6."""

from __future__ import annotations

import sys
from typing import Any

sys.exudynFast = True  # type: ignore[attr-defined]  # Exudyn without range checks

import exudyn as exu
import numpy as np
from exudyn.utilities import (
    Cable2D,
    CartesianSpringDamper,
    CoordinateConstraint,
    CoordinateSpringDamper,
    CoordinateSpringDamperExt,
    Gravity,
    LoadCoordinate,
    MarkerBodyMass,
    MarkerBodyPosition,
    MarkerNodeCoordinate,
    Mass1D,
    MassPoint2D,
    Node1D,
    NodeGenericData,
    NodePointGround,
    Point2DS1,
)
from numpy.typing import NDArray

from tautwire.specs.case import Case
from tautwire.specs.line.wire import Wire

Array = NDArray[np.float64]
RELATIVE_TOLERANCE = 1e-5


class ExudynLine:
    """The line of a case, its pantograph and the contact between them.

    Heights count from the contact-wire height at the supports.

    Parameters
    ----------
    case
        The line; every span alike except for its dropper lengths.
    elements
        Elements per dropper interval.
    """

    def __init__(self, case: Case, elements: int) -> None:
        self._case = case
        self._gravity = case.line.gravity
        self._container = exu.SystemContainer()
        self._mbs = self._container.AddSystem()
        ground = self._mbs.AddNode(NodePointGround())
        self._ground = self._coordinate(ground, 0)
        self._x = self._stations(elements)
        contact, self._bodies = self._wire(case.wires.contact, 0.0)
        messenger, _ = self._wire(case.wires.messenger, 1.2)
        self._hang(contact, messenger, 1.2)
        self._supports(contact, messenger)
        self._head = self._pantograph()
        self._contacts = [self._contact(body) for body in self._bodies]
        self._active = -1
        self._record: list[tuple[float, float]] = []
        self._mbs.Assemble()
        self._move_to(0.0)

    def find_equilibrium(self) -> None:
        """Start from the static equilibrium, pantograph included."""
        settings = self._settings()
        settings.staticSolver.newton.relativeTolerance = 1e-6
        settings.staticSolver.newton.absoluteTolerance = 1e-6
        settings.staticSolver.newton.maxIterations = 60
        settings.staticSolver.discontinuous.maxIterations = 20
        self._mbs.SolveStatic(settings, updateInitialValues=True)

    def integrate(self, seconds: float) -> Array:
        """Integrate with the trapezoidal rule; return time and contact force of every step."""
        settings = self._settings()
        scheme = settings.timeIntegration
        scheme.newton.relativeTolerance = RELATIVE_TOLERANCE
        scheme.newton.absoluteTolerance = 1e-8
        scheme.newton.useModifiedNewton = True
        scheme.generalizedAlpha.spectralRadius = 1.0
        scheme.adaptiveStep = False
        scheme.endTime = seconds
        scheme.numberOfSteps = round(seconds / self._case.settings.step())
        self._mbs.SetPreStepUserFunction(self._before_step)
        self._mbs.SetPostStepUserFunction(self._after_step)
        self._mbs.SolveDynamic(settings)
        return np.array(self._record)

    def _settings(self) -> Any:
        settings = exu.SimulationSettings()
        settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
        settings.solution.file.write = False
        settings.solution.sensors.active = False
        settings.parallel.numberOfThreads = 1
        return settings

    def _coordinate(self, node: int, index: int) -> int:
        return self._mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=index))

    def _stations(self, elements: int) -> Array:
        """Divide every interval between neighbouring droppers and supports evenly."""
        spans = self._case.line.span_lengths()
        starts = np.concatenate([[0.0], np.cumsum(spans)])
        points = [0.0]
        for start, end, row in zip(
            starts[:-1], starts[1:], self._case.droppers.positions_by_span(len(spans)), strict=True
        ):
            points += [start + x for x in row] + [end]
        share = np.arange(elements) / elements
        inner = np.array(points[:-1])[:, None] + np.diff(points)[:, None] * share
        return np.append(inner.ravel(), points[-1])

    def _wire(self, wire: Wire, height: float) -> tuple[list[int], list[int]]:
        """Add a wire, held at the left end, pulled and held vertically at the right one."""
        mbs, x = self._mbs, self._x
        nodes = [mbs.AddNode(Point2DS1(referenceCoordinates=[s, height, 1, 0])) for s in x]
        bodies = []
        for i, length in enumerate(np.diff(x)):
            cable = Cable2D(
                physicsLength=length,
                physicsMassPerLength=wire.mass,
                physicsBendingStiffness=wire.bending_stiffness,
                physicsAxialStiffness=wire.axial_stiffness,
                physicsReferenceAxialStrain=-wire.tension / wire.axial_stiffness,
                nodeNumbers=nodes[i : i + 2],
            )
            bodies.append(mbs.AddObject(cable))
            mass = mbs.AddMarker(MarkerBodyMass(bodyNumber=bodies[-1]))
            mbs.AddLoad(Gravity(markerNumber=mass, loadVector=[0, -self._gravity, 0]))
        for node, index in ((nodes[0], 0), (nodes[0], 1), (nodes[-1], 1)):
            markers = [self._ground, self._coordinate(node, index)]
            mbs.AddObject(CoordinateConstraint(markerNumbers=markers))
        end = self._coordinate(nodes[-1], 0)
        mbs.AddLoad(LoadCoordinate(markerNumber=end, load=wire.tension))
        return nodes, bodies

    def _nearest(self, nodes: list[int], x: float) -> int:
        return nodes[int(np.argmin(np.abs(self._x - x)))]

    def _lump(self, node: int, mass: float) -> None:
        self._mbs.AddObject(MassPoint2D(physicsMass=mass, nodeNumber=node))
        marker = self._coordinate(node, 1)
        self._mbs.AddLoad(LoadCoordinate(markerNumber=marker, load=-mass * self._gravity))

    def _hang(self, contact: list[int], messenger: list[int], height: float) -> None:
        """Add droppers: springs with a stop, so that they carry tension only."""
        spec, spans = self._case.droppers, self._case.line.span_lengths()
        starts = np.concatenate([[0.0], np.cumsum(spans)])
        rows = zip(
            starts[:-1],
            spec.positions_by_span(len(spans)),
            spec.lengths_by_span(len(spans)),
            strict=True,
        )
        for start, positions, lengths in rows:
            for x, length in zip(positions, lengths, strict=True):
                upper, lower = (
                    self._nearest(messenger, start + x),
                    self._nearest(contact, start + x),
                )
                self._lump(lower, spec.clamp_contact)
                self._lump(upper, spec.clamp_messenger)
                data = NodeGenericData(initialCoordinates=[0, 0, 0], numberOfDataCoordinates=3)
                dropper = CoordinateSpringDamperExt(
                    markerNumbers=[self._coordinate(upper, 1), self._coordinate(lower, 1)],
                    nodeNumber=self._mbs.AddNode(data),
                    useLimitStops=True,
                    limitStopsLower=height - length,
                    limitStopsUpper=1e3,
                    limitStopsStiffness=spec.stiffness.of_length(length),
                    frictionProportionalZone=1.0,
                )
                self._mbs.AddObject(dropper)

    def _supports(self, contact: list[int], messenger: list[int]) -> None:
        spec = self._case.supports
        for x in self._case.line.support_positions()[1:-1]:
            self._lump(self._nearest(contact, x), spec.spring.mass)
            node = self._coordinate(self._nearest(messenger, x), 1)
            spring = CoordinateSpringDamper(
                markerNumbers=[self._ground, node], stiffness=spec.messenger_stiffness
            )
            self._mbs.AddObject(spring)

    def _pantograph(self) -> int:
        """Add the stages from the head down; return the marker of the head."""
        mbs, spec = self._mbs, self._case.pantographs[0]
        bodies, markers = [], []
        for stage in spec.stages:
            node = mbs.AddNode(Node1D(referenceCoordinates=[0]))
            upright = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
            mass = Mass1D(physicsMass=stage.mass, nodeNumber=node, referenceRotation=upright)
            bodies.append(mbs.AddObject(mass))
            markers.append(self._coordinate(node, 0))
        below = [*markers[1:], self._ground]
        for stage, upper, lower in zip(spec.stages, markers, below, strict=True):
            spring = CoordinateSpringDamper(
                markerNumbers=[lower, upper], stiffness=stage.stiffness, damping=stage.damping
            )
            mbs.AddObject(spring)
        uplift = self._case.uplift_forces()[0]
        mbs.AddLoad(LoadCoordinate(markerNumber=markers[-1], load=uplift))
        return mbs.AddMarker(MarkerBodyPosition(bodyNumber=bodies[0], localPosition=[0, 0, 0]))

    def _contact(self, body: int) -> tuple[int, int]:
        """Add an idle unilateral contact between a wire element and the head."""

        def law(
            _mbs: Any, _t: float, _item: int, gap: Any, _v: Any, k: Any, _d: Any, _offset: Any
        ) -> list[float]:
            return [0.0, k[1] * gap[1] if gap[1] > 0.0 else 0.0, 0.0]

        marker = self._mbs.AddMarker(MarkerBodyPosition(bodyNumber=body, localPosition=[0, 0, 0]))
        spring = CartesianSpringDamper(
            markerNumbers=[marker, self._head],
            stiffness=[0, self._case.settings.contact_stiffness, 0],
            activeConnector=False,
            springForceUserFunction=law,
        )
        return marker, self._mbs.AddObject(spring)

    def _move_to(self, time: float) -> None:
        """Let the head touch the wire where it is at a time."""
        x = self._case.settings.start + self._case.scenario.speed * time
        i = min(int(np.searchsorted(self._x, x, "right")) - 1, len(self._contacts) - 1)
        marker, spring = self._contacts[i]
        self._mbs.SetMarkerParameter(marker, "localPosition", [x - self._x[i], 0, 0])
        if i == self._active:
            return
        if self._active >= 0:
            self._mbs.SetObjectParameter(self._contacts[self._active][1], "activeConnector", False)
        self._mbs.SetObjectParameter(spring, "activeConnector", True)
        self._active = i

    def _before_step(self, _mbs: Any, time: float) -> bool:
        self._move_to(time)
        return True

    def _after_step(self, mbs: Any, time: float) -> bool:
        spring = self._contacts[self._active][1]
        force = mbs.GetObjectOutput(spring, exu.OutputVariableType.Force)[1]
        self._record.append((time, float(force)))
        return True
