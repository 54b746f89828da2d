"""Why a computation stopped: one sentence and one cure for each cause."""

from __future__ import annotations

from enum import Enum


class Status(Enum):
    """Outcome of an iteration or of a time integration.

    The value is the word written to files; ``sentence`` and ``cure`` are what a person reads.
    """

    DONE = "done"
    RUNNING = "running"
    INTERRUPTED = "interrupted"
    NOT_CONVERGED = "not converged"
    SINGULAR = "singular"
    NOT_FINITE = "not finite"
    OFF_THE_LINE = "off the line"
    TOO_MANY_LOSSES = "too many losses"

    @property
    def sentence(self) -> str:
        """What happened."""
        return _TEXT[self][0]

    @property
    def cure(self) -> str:
        """What to try."""
        return _TEXT[self][1]


_TEXT = {
    Status.DONE: ("The computation reached its end.", ""),
    Status.RUNNING: ("The computation is under way.", ""),
    Status.INTERRUPTED: (
        "The computation was interrupted; what was computed is kept.",
        "Start it again to compute the rest.",
    ),
    Status.NOT_CONVERGED: (
        "The equilibrium iteration did not reach its tolerance.",
        "Try a smaller settings.time_step, a finer mesh (settings.longest_element), "
        "or check the input for an extreme stiffness, tension or force.",
    ),
    Status.SINGULAR: (
        "The stiffness matrix is not positive definite: the line is not held in its shape.",
        "Check that tensions are positive, that ends and supports hold both wires (anchor one end "
        "if nothing else holds the line along the track), and that droppers carry the contact "
        "wire. In a passage, try a smaller settings.time_step.",
    ),
    Status.NOT_FINITE: (
        "The state contains a value that is not a finite number.",
        "Try a smaller settings.time_step or a lower settings.contact_stiffness, and check the "
        "input for extreme values.",
    ),
    Status.OFF_THE_LINE: (
        "A pantograph left the modelled wire.",
        "Lengthen the line (line.spans) or move the start (settings.start). Where it left "
        "sideways, give the contact wire another stagger (supports.contact_stagger).",
    ),
    Status.TOO_MANY_LOSSES: (
        "Contact is lost so often that following every loss is pointless.",
        "Use a constant step (settings.step_control), raise its 'most_losses', or check "
        "irregularities, contact stiffness and uplift force.",
    ),
}
