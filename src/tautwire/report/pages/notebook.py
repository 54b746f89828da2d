"""The figures of the report one by one, for notebooks."""

from __future__ import annotations

import html
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from tautwire.analyses.vibration.space_time import wire_velocity
from tautwire.errors import InputError
from tautwire.report.figures import force_figures, line_figures, loss_figures, mode_figures
from tautwire.report.parts import sections
from tautwire.report.parts.views import RunView, prepare
from tautwire.report.writers.html import render
from tautwire.results.run import Run

if TYPE_CHECKING:
    import plotly.graph_objects as go


@dataclass(frozen=True)
class Film:
    """An animation: a page of its own, which a notebook shows in a frame.

    Attributes
    ----------
    page : str
        HTML that needs no network.
    """

    page: str

    def __repr__(self) -> str:
        """Return a short text; the page itself is long."""
        return f"<Film: {len(self.page) / 1e6:.1f} MB of HTML in its attribute page>"

    def _repr_html_(self) -> str:
        frame = "width:100%;height:640px;border:0"
        return f'<iframe style="{frame}" srcdoc="{html.escape(self.page)}"></iframe>'


@dataclass(frozen=True, eq=False)
class RunPlots:
    """Figures of one run as the report draws them, each a ``plotly`` figure.

    Attributes
    ----------
    run : Run
    """

    run: Run

    @cached_property
    def _view(self) -> RunView:
        return prepare(self.run, "")

    def force(self) -> go.Figure:
        """Draw the contact force over position: unfiltered, up to 200 Hz and up to 20 Hz."""
        return force_figures.force_figure([self._view]).to_figure()

    def spectrum(self) -> go.Figure:
        """Draw the amplitude spectrum of the contact force in the analysed section."""
        return force_figures.spectrum_figure([self._view]).to_figure()

    def histogram(self) -> go.Figure:
        """Draw how often each contact force occurs in the analysed section."""
        return force_figures.histogram_figure([self._view]).to_figure()

    def spans(self) -> go.Figure:
        """Draw mean, deviation and extremes of the contact force span by span."""
        return force_figures.spans_figure([self._view]).to_figure()

    def line(self) -> go.Figure:
        """Draw the static line: side view, sag and plan."""
        return line_figures.line_figure(
            self._view.run.case,
            self._view.run.equilibrium,
            self._view.statistics.section.first_span,
        ).to_figure()

    def uplift(self) -> go.Figure:
        """Draw the largest uplift at every support of the analysed section."""
        return line_figures.uplift_figure([self._view]).to_figure()

    def uplift_history(self) -> go.Figure:
        """Draw the uplift of the support that is lifted most over time."""
        return line_figures.uplift_history_figure([self._view]).to_figure()

    def height(self) -> go.Figure:
        """Draw the height of the contact wire at the pantograph beside its static height."""
        return line_figures.height_figure([self._view]).to_figure()

    def droppers(self) -> go.Figure:
        """Draw range of the force and slack time of every dropper of the analysed section."""
        return line_figures.dropper_figure([self._view]).to_figure()

    def losses(self) -> go.Figure:
        """Draw the longest losses of contact enlarged.

        Raises
        ------
        InputError
            When no contact is lost in the analysed section.
        """
        if not any(entry.contact_loss.events for entry in self._view.statistics.pantographs):
            raise InputError("there is nothing to draw: no contact is lost in the analysed section")
        return loss_figures.enlarged_figure([self._view]).to_figure()

    def motion(self, wire: str | None = None) -> go.Figure:
        """Draw a map of a wire's vertical velocity over position and time.

        Parameters
        ----------
        wire
            Its name; the first contact wire by default.

        Raises
        ------
        InputError
            When the shapes were not stored (``settings.store_shapes``), or the wire is unknown.
        """
        return mode_figures.space_time_figure(
            wire_velocity(self.run, wire), self._view.section
        ).to_figure()

    def animation(self) -> Film:
        """Return the passage as an animation."""
        case = self.run.case
        masthead = {
            "title": case.title or case.name,
            "description": "",
            "facts": {},
            "version": str(self.run.provenance.get("version", "")),
            "case_hash": case.hash()[:12],
        }
        return Film(render([sections.animation_section([self._view])], masthead))
