"""Options that would do nothing: refused by name, so that nobody believes in their effect."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from tautwire.errors import InputError


def refuse_idle(needs: str, given: Mapping[str, object]) -> None:
    """Refuse options that lack what they work on.

    Parameters
    ----------
    needs
        What they need, as it follows ``"--option needs "``.
    given
        What was given, by option; what is false or empty was not.

    Raises
    ------
    InputError
        Naming every option.
    """
    problems = [f"{option} needs {needs}" for option, value in given.items() if value]
    if problems:
        raise InputError(problems)


def refuse_rivals(option: str, path: str, overrides: Iterable[str]) -> None:
    """Refuse an option beside a ``--set`` of what it sets.

    Parameters
    ----------
    option
    path
        Of the value that it sets.
    overrides
        Texts ``"path=value"``.

    Raises
    ------
    InputError
        Naming both.
    """
    rivals = [text for text in overrides if _leads_to(text.partition("=")[0].strip(), path)]
    if rivals:
        raise InputError(f"{option} sets {path}, as --set {rivals[0]!r} does; give one of the two")


def _leads_to(given: str, path: str) -> bool:
    """Tell whether a path is another one or lies below it."""
    return given == path or given.startswith((f"{path}.", f"{path}["))
