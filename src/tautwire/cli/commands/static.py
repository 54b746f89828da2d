"""``static``: shape, dropper lengths and forces, elasticity."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path

from tautwire.analyses.road.elasticity import elasticity as compute_elasticity
from tautwire.analyses.road.shape import find_shape
from tautwire.cli.about import backend, program
from tautwire.cli.folders import Files, prepared_folder
from tautwire.cli.interrupts import Interrupts
from tautwire.cli.json_text import to_json
from tautwire.cli.session import Answer, OutputError
from tautwire.cli.views.documents import static_document
from tautwire.cli.views.static_view import static_view
from tautwire.cli.views.tables import files_written, heading
from tautwire.inputs.load import load_case
from tautwire.model.build import build
from tautwire.report.parts.tables import write_dropper_table
from tautwire.results.equilibrium import Elasticity, Equilibrium
from tautwire.results.files import write_text
from tautwire.results.storage import save_equilibrium
from tautwire.specs.case import Case
from tautwire.text import csv_text


def find_static(answer: Answer, reference: str, overrides: Sequence[str], out: Path | None) -> None:
    """Find the static state of a case, show it, and write its files."""
    case = load_case(reference, overrides)
    with nullcontext() if out is None else prepared_folder(out) as folder:
        answer.say(program(case.settings.backend))
        begin = time.process_time()
        with Interrupts().handled():
            model = build(case)
            shape = find_shape(model)
            found = time.process_time()
            answer.say(f"shape found in {found - begin:.1f} s of CPU time; elasticity follows")
            elasticity = compute_elasticity(model, shape)
        cost = {"shape_cpu_s": found - begin, "elasticity_cpu_s": time.process_time() - found}
        name = backend(case.settings.backend)
        answer.document.update(static_document(case, shape, elasticity, name, []))
        answer.document["cost"] = {"dof": shape.position.size, **cost}
        answer.show(*static_view(case, shape, elasticity))
        if folder is not None:
            _write(answer, Files(folder), case, shape, elasticity)


def _write(
    answer: Answer, files: Files, case: Case, shape: Equilibrium, elasticity: Elasticity
) -> None:
    text = to_json(answer.document) + "\n"
    files.write("static.nc", lambda path: save_equilibrium(shape, path, case, elasticity))
    files.write("static.json", lambda path: write_text(path, text))
    files.write("droppers.csv", lambda path: write_dropper_table(shape, path))
    files.write("elasticity.csv", lambda path: write_text(path, elasticity_csv(elasticity)))
    answer.document["files"] = files.written
    answer.show(heading("Files"), files_written(files.written))
    if files.problems:
        raise OutputError(files.problems)


def elasticity_csv(elasticity: Elasticity) -> str:
    """Return the elasticity as CSV, one row per point."""
    force = f"{elasticity.force:g} N"
    head = ("span", "kind", "index", "position [m]", f"elasticity under {force} [mm/N]")
    points = zip(
        elasticity.span.tolist(),
        elasticity.kind,
        elasticity.index.tolist(),
        elasticity.x.tolist(),
        elasticity.elasticity.tolist(),
        strict=True,
    )
    return csv_text(
        head,
        ((span, kind, index, f"{x:.4f}", f"{1e3 * value:.6f}")
         for span, kind, index, x, value in points),
    )  # fmt: skip
