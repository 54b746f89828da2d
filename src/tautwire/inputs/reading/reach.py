"""Which files a document may open: those in the folder of the file that the user named."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from tautwire.errors import InputError
from tautwire.inputs.reading.files import named

ALLOW = "TAUTWIRE_ALLOW"
"""Environment variable: further folders, separated as in PATH."""


@dataclass(frozen=True)
class Reach:
    """The folders whose files a document may name; a case may come from anywhere.

    Attributes
    ----------
    folders
        Without links. What lies in them or below may be opened, through links too if these end
        there.
    """

    folders: tuple[Path, ...] = ()

    @classmethod
    def of(cls, folder: Path | None) -> Reach:
        """Return the reach of a document in a folder: it and the folders that the user allows."""
        allowed = [entry for entry in os.environ.get(ALLOW, "").split(os.pathsep) if entry]
        own = [folder] if folder is not None else []
        return cls(tuple(Path(os.path.realpath(entry)) for entry in [*own, *allowed]))

    def check(self, path: Path, label: str) -> None:
        """Refuse a file outside.

        Parameters
        ----------
        path
            The file.
        label
            Name of the document that asks for it, in messages.

        Raises
        ------
        InputError
            Saying how the user can allow it.
        """
        try:
            real = Path(os.path.realpath(path))
        except (OSError, ValueError):
            return  # there is no such file; whoever opens it says so
        if not any(real.is_relative_to(folder) for folder in self.folders):
            raise InputError(
                f"{label}: asks for {named(path)}, which is not in the folder of the file that "
                f"was named; if that is right, allow its folder: tautwire --allow "
                f"{named(real.parent)} ..., or {ALLOW} in the environment"
            )
