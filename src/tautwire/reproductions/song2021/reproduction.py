"""The whole reproduction: run what is needed and judge every claim."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tautwire.reproductions.record import DOUBTFUL
from tautwire.reproductions.song2021 import published, sources
from tautwire.reproductions.song2021.claims import RULE, Claim, Condition, counts
from tautwire.reproductions.song2021.folder import PASSAGES, Folder
from tautwire.reproductions.song2021.passages import (
    FULL,
    Reading,
    Scope,
    passage_study,
    passages,
)
from tautwire.reproductions.song2021.sections import (
    cutoffs,
    identification,
    mesh,
    statics,
    step_claims,
    steps,
    stiffness,
    validation,
    vibration,
)
from tautwire.reproductions.song2021.sections.forces import Passages
from tautwire.reproductions.song2021.sections.irregular import ideal, irregular_study
from tautwire.specs.case import Source
from tautwire.studies.run import Watch
from tautwire.version import __version__

STUDY = "song2021"


@dataclass(frozen=True, eq=False)
class Material:
    """Everything that figures, tables and verdicts are made of.

    Attributes
    ----------
    scope : Scope
    passages : Passages
    statics : Statics
    variants : list of Variant
        Table 2 by reading.
    sources : mapping of Reading to Sources
        Fig. 11 by reading.
    modes : mapping of str to Found
        By name of the length.
    curves : mapping of Condition to Curves
        Fig. 15 by reading.
    trials : list of Trial
        Table 3 by reading and irregularity.
    """

    scope: Scope
    passages: Passages
    statics: statics.Statics
    variants: list[validation.Variant]
    sources: Mapping[Reading, sources.Sources]
    modes: Mapping[str, vibration.Found]
    curves: Mapping[Condition, cutoffs.Curves]
    trials: list[steps.Trial]


@dataclass(frozen=True, eq=False)
class SongRecord:
    """The reproduction and its verdicts.

    Attributes
    ----------
    status : str
        ``"done"``, or ``"partial"`` when passages are missing.
    scope : str
        ``"full"`` or ``"quick"``.
    claims : tuple of Claim
    missing : mapping of str to str
        Passages and searches without a result, and why.
    cost : mapping of str to float
        ``passages``, ``cpu_s``, ``wall_s`` of this call.
    changed_inputs : tuple of str
    doubtful_inputs : tuple of Source
    material : Material
    """

    status: str
    scope: str
    claims: tuple[Claim, ...]
    missing: Mapping[str, str]
    cost: Mapping[str, float]
    changed_inputs: tuple[str, ...]
    doubtful_inputs: tuple[Source, ...]
    material: Material

    title = published.TITLE

    @property
    def statement(self) -> str:
        """The outcome in a sentence."""
        parts = [f"{number} {verdict}" for verdict, number in counts(self.claims).items()]
        text = f"{len(self.claims)} claims: {', '.join(parts)}."
        alike = [f"{n} {verdict}" for verdict, n in counts(self.claims, alike=True).items()]
        text += f" With every reading counting alike: {', '.join(alike)}."
        if self.status != "done":
            text += f" Not complete: {len(self.missing)} computations are missing."
        if self.changed_inputs:
            text += f" Changed for this run: {', '.join(self.changed_inputs)}."
        return text

    def as_dict(self) -> dict[str, Any]:
        """Return the record as plain data for JSON."""
        return {
            "study": STUDY,
            "title": self.title,
            "version": __version__,
            "status": self.status,
            "scope": self.scope,
            "statement": self.statement,
            "source": published.SOURCE,
            "published_filter": published.FILTER,
            "rule": RULE,
            "verdicts": counts(self.claims),
            "verdicts_under_all": counts(self.claims, alike=True),
            "claims": [claim.as_dict() for claim in self.claims],
            "missing": dict(self.missing),
            "cost": dict(self.cost),
            "doubtful_inputs": [entry.to_dict() for entry in self.doubtful_inputs],
            "changed_inputs": list(self.changed_inputs),
        }


def reproduce(
    folder: str | os.PathLike[str],
    scope: Scope = FULL,
    *,
    workers: int | None = None,
    watch: Watch | None = None,
    changes: Mapping[str, Any] | None = None,
) -> SongRecord:
    """Run all passages and searches that are not in the folder yet, and judge every claim.

    Parameters
    ----------
    folder
        Where passages are kept; what is there already is not computed again.
    scope
        How much is computed.
    workers
        Number of processes; by default one per core.
    watch
        Called with the progress of the passages, then of the searches of modes; True stops.
    changes
        Values of the case to replace, by path, to see what an input is worth.

    Returns
    -------
    SongRecord
        With status ``"partial"`` when something is missing.
    """
    begin = time.perf_counter()
    own = Folder(Path(folder), workers, watch)
    own.compute("passages", passage_study(passages(scope), changes))
    irregular = irregular_study(scope, _uplift(own, scope), changes)
    if irregular is not None:
        own.compute("irregular", irregular)
    meshes = vibration.MESHES if scope.name == FULL.name else vibration.QUICK_MESHES
    own.compute("modes", vibration.mode_study(meshes, changes), vibration.TASK)
    rows, missing = own.rows()
    material = _material(scope, own, changes)
    doubtful = tuple(
        entry for entry in own.first_case("passages").sources
        if entry.confidence in DOUBTFUL
    )  # fmt: skip
    return SongRecord(
        "partial" if missing else "done",
        scope.name,
        tuple(judge(material)),
        missing,
        _cost(rows, PASSAGES, begin),
        tuple(changes or {}),
        doubtful,
        material,
    )


@dataclass(frozen=True, eq=False)
class Identification:
    """Readings of what the paper leaves open, against its numbers.

    Attributes
    ----------
    trials : list of Trial
        Those that meet most numbers first.
    missing : mapping of str to str
        Computations without a result, and why.
    cost : mapping of str to float
        ``passages``, ``cpu_s``, ``wall_s`` of this call.
    """

    trials: list[identification.Trial]
    missing: Mapping[str, str]
    cost: Mapping[str, float]

    def as_dict(self) -> dict[str, Any]:
        """Return the readings as plain data for JSON."""
        return {
            "study": STUDY,
            "version": __version__,
            "status": "partial" if self.missing else "done",
            "readings": [one.as_dict() for one in self.trials],
            "missing": dict(self.missing),
            "cost": dict(self.cost),
        }


def identify_readings(
    folder: str | os.PathLike[str], *, workers: int | None = None, watch: Watch | None = None
) -> Identification:
    """Compute the readings that are not in the folder yet, and count the numbers each meets.

    Parameters
    ----------
    folder
        Where results are kept; what is there already is not computed again.
    workers
        Number of processes; by default one per core.
    watch
        Called with the progress; True stops.
    """
    begin = time.perf_counter()
    own = Folder(Path(folder), workers, watch)
    own.compute("grid", identification.grid_study(), identification.TASK)
    own.compute("trend", identification.trend_study(), identification.TASK)
    own.compute("elasticity", identification.static_study(), identification.STATIC_TASK)
    rows = own.rows()[0]
    first = identification.judge(rows["elasticity"], {**rows["grid"], **rows["trend"]})
    best = identification.finalist_study(identification.finalists(first))
    own.compute("finalists", best, identification.TASK)
    rows, missing = own.rows()
    kinds = ("grid", "trend", "finalists")
    passages = {name: row for kind in kinds for name, row in rows[kind].items()}
    trials = identification.judge(rows["elasticity"], passages)
    return Identification(trials, missing, _cost(rows, kinds, begin))


def _cost(
    rows: Mapping[str, Mapping[str, Any]], counted: Sequence[str], begin: float
) -> dict[str, float]:
    """Return number of passages, processor time of all rows, and wall time since `begin`."""
    every = (row for kind in rows.values() for row in kind.values())
    return {
        "passages": float(sum(len(rows[name]) for name in counted if name in rows)),
        "cpu_s": sum(row["cost"]["cpu_s"] or 0.0 for row in every),
        "wall_s": time.perf_counter() - begin,
    }


def _uplift(folder: Folder, scope: Scope) -> dict[Reading, float]:
    """Return the uplift forces of the ideal line that section V takes over [N]."""
    rows = folder.rows()[0]["passages"]
    return {
        own: float(rows[ideal(own)]["values"]["pantographs"][0]["uplift_force"])
        for own, _ in scope.irregular
        if ideal(own) in rows
    }


def _material(scope: Scope, folder: Folder, changes: Mapping[str, Any] | None) -> Material:
    own = Passages(folder.run_paths())
    every = ((reading, sources.gather(own, scope, reading)) for reading in scope.readings)
    return Material(
        scope,
        own,
        statics.compute_statics(changes),
        validation.readings(own),
        {k: found for k, found in every if found is not None},
        vibration.gather(folder.rows()[0]["modes"]),
        cutoffs.gather(own, scope),
        steps.gather(own, scope),
    )


def judge(material: Material) -> list[Claim]:
    """Judge all claims of sections II to VI.

    Parameters
    ----------
    material
    """
    own = material.passages
    return [
        *statics.claims(material.statics),
        *validation.claims(material.variants),
        *mesh.claims(own),
        *stiffness.claims(own),
        *sources.claims(material.sources),
        *vibration.claims(material.modes),
        *cutoffs.claims(material.curves),
        *step_claims.claims(own, material.trials),
    ]
