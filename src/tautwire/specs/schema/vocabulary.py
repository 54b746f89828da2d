"""Words that people use for what a case has under another name, or cannot describe yet."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from typing import Any

PAGE = "Not modelled yet"
"""Title of the page of the documentation that lists what a case cannot describe."""
_LETTERS = str.maketrans({"ø": "o", "æ": "ae", "œ": "oe"})
"""Letters that Unicode does not take apart, as they are written without their keys."""


@dataclass(frozen=True)
class Meaning:
    """What a word stands for: a key of a case or a feature that is not modelled.

    Attributes
    ----------
    key
        Path of the key, as in ``supports.encumbrance``; empty for a feature.
    feature
        The feature, as a person calls it; empty for a key.
    """

    key: str = ""
    feature: str = ""


def words_for(name: str) -> tuple[str, ...]:
    """Return the words that stand for a feature or for the path of a key."""
    content = _content()
    return tuple(content["features"].get(name) or content["keys"][name])


def meaning_of(word: str, above: str = "") -> Meaning | None:
    """Return what a word that is no key stands for; None when it is unknown.

    Parameters
    ----------
    word
        As written in a file, in any spelling: ``"System-Height"``, ``"Systemhöhe"``.
    above
        Path of the mapping in which it stands; some words mean something in one place only.

    Examples
    --------
    >>> meaning_of("Systemhöhe")
    Meaning(key='supports.encumbrance', feature='')
    """
    plain = folded(word)
    places = [folded(step) for step in re.split(r"[.\[\]0-9]+", above) if step]
    spellings = [plain, *([plain[:-1]] if plain.endswith("s") else [])]
    keys = [f"{place}.{spelling}" for spelling in spellings for place in places] + spellings
    return next((found for key in keys if (found := _index().get(key)) is not None), None)


def folded(word: str) -> str:
    """Return a word for comparing: without case, accents, blanks and punctuation.

    Examples
    --------
    >>> folded("Système-Height no."), folded("systemHøyde")
    ('systemeheightno', 'systemhoyde')
    """
    plain = unicodedata.normalize("NFKD", word.casefold().translate(_LETTERS))
    return "".join(letter for letter in plain if letter.isalnum())


@lru_cache(maxsize=1)
def _content() -> dict[str, dict[str, list[str]]]:
    import yaml

    text = files("tautwire.specs.schema").joinpath("vocabulary.yaml").read_text(encoding="utf-8")
    content: Any = yaml.safe_load(text)
    return content


@lru_cache(maxsize=1)
def _index() -> dict[str, Meaning]:
    """Return all meanings by word; of two meanings the feature goes first."""
    content = _content()
    found = {_place(w): Meaning(key=key) for key, words in content["keys"].items() for w in words}
    for feature, words in content["features"].items():
        found |= {_place(word): Meaning(feature=feature) for word in words}
    return found


def _place(word: str) -> str:
    """Return an entry of the file as it is looked up: each part folded."""
    return ".".join(map(folded, word.split(".")))
