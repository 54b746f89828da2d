"""Results of a study on disk: one small file per finished case, there as soon as it is finished.

A row is either there as a whole or not at all, whatever is killed when (:mod:`tautwire.files`).
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tautwire.files import remove_drafts, write_whole

ROWS, RUNS = "rows", "runs"

Row = Mapping[str, Any]


class Store:
    """The folder of a study.

    Parameters
    ----------
    folder
        Made when it is first written to.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)

    def row_path(self, key: str) -> Path:
        """Return where the row of a case is kept."""
        return self.folder / ROWS / key[:2] / f"{key}.json"

    def run_path(self, key: str) -> Path:
        """Return where the histories of a case are kept, if the study keeps them."""
        return self.folder / RUNS / f"{key}.nc"

    def finished(self) -> set[str]:
        """Return the keys of all cases with a row that can be read."""
        paths = (self.folder / ROWS).glob("??/*.json")
        return {path.stem for path in paths if self.load(path.stem) is not None}

    def load(self, key: str) -> Row | None:
        """Return the row of a case; None when there is none, or not a whole one."""
        try:
            row = json.loads(self.row_path(key).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return row if isinstance(row, dict) and row.get("key") == key else None

    def save(self, key: str, row: Row, run_file: bytes | None = None) -> None:
        """Write the row of a finished case, its histories before it.

        Raises
        ------
        OSError
            When it cannot be written; nothing half-written stays.
        """
        if run_file is not None:
            self._write(self.run_path(key), run_file)
        text = json.dumps({**row, "key": key}, allow_nan=False, separators=(",", ":"))
        self._write(self.row_path(key), text.encode())

    def clear(self) -> None:
        """Remove all rows and kept histories."""
        for path in [
            *(self.folder / ROWS).glob("??/*.json"),
            *(self.folder / RUNS).glob("*.nc"),
        ]:
            path.unlink(missing_ok=True)

    def sweep(self) -> None:
        """Remove what killed processes left half-written."""
        remove_drafts(self.folder / ROWS, "??")
        remove_drafts(self.folder / RUNS)

    @staticmethod
    def _write(path: Path, content: bytes) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, content)
