"""``new``: a line of one's own to begin with."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from tautwire.cli.session import Answer
from tautwire.cli.views.tables import facts, heading
from tautwire.errors import InputError
from tautwire.files import write_text
from tautwire.inputs.completion import shelf_with
from tautwire.inputs.load import load_case
from tautwire.inputs.own_line import Choice, Wish, as_text, template, written
from tautwire.inputs.paths import format_path
from tautwire.text import as_name
from tautwire.units import UnitError, parse_quantity

WIRES = ("contact wire", "rope")
SYSTEMS = ("ac", "dc-1.5kv", "dc-3kv")
ENDS = ("mid-point", "weighted", "anchored")


@dataclass(frozen=True)
class Answers:
    """What was said on the command line, as texts; None where nothing was.

    Attributes
    ----------
    system, speed, span, spans, contact, contact_tension, messenger, messenger_tension : str or None
    ends, band, arm_share : str or None
    """

    system: str | None = None
    speed: str | None = None
    span: str | None = None
    spans: str | None = None
    contact: str | None = None
    contact_tension: str | None = None
    messenger: str | None = None
    messenger_tension: str | None = None
    ends: str | None = None
    band: str | None = None
    arm_share: str | None = None


def write_new(answer: Answer, path: Path, answers: Answers, *, force: bool) -> None:
    """Write a template for an own line and say what was chosen and why."""
    if path.suffix.lower() not in (".yaml", ".yml"):
        raise InputError(f"{path}: the file is YAML; choose a name that ends in .yaml")
    if path.is_dir() or (path.exists() and not force):
        raise InputError(f"{path}: exists already; choose another name, or --force")
    if answers == Answers() and sys.stdin.isatty() and not answer.as_json:
        answers = _asked(answer)
    choices = template(wish_of(path, answers))
    write_text(path, as_text(choices))
    case = load_case(path)
    answer.document.update(
        {"file": str(path), "case": case.name, "choices": [_as_data(c) for c in choices]}
    )
    answer.show(
        heading(f"{path} written"),
        facts((format_path(c.path), _shown(c)) for c in choices if c.reason),
        heading("Next"),
        f"tautwire check {path}    what is still as the program chose it\n"
        f"tautwire run {path}      a first report",
    )


def wish_of(path: Path, answers: Answers) -> Wish:
    """Read the answers.

    Raises
    ------
    InputError
        Naming every answer that cannot be used.
    """
    problems: list[str] = []
    wish = Wish(as_name(path.stem))
    for name, read in _READERS.items():
        text = getattr(answers, name)
        if text is None:
            continue
        try:
            wish = replace(wish, **{name: read(text)})
        except (UnitError, InputError, ValueError) as error:
            problems.append(f"--{name.replace('_', '-')}: {error}")
    if problems:
        raise InputError(problems)
    return wish


def _quantity(unit: str, low: float, high: float) -> Callable[[str], float]:
    def read(text: str) -> float:
        value = parse_quantity(text, unit)
        if not low <= value <= high:
            raise ValueError(f"got {text!r}; must be between {low:g} and {high:g} {unit}")
        return value

    return read


def _one_of(words: tuple[str, ...]) -> Callable[[str], str]:
    def read(text: str) -> str:
        if text.lower() not in words:
            raise ValueError(f"got {text!r}; choose {', '.join(words)}")
        return text.lower()

    return read


def _wire(text: str) -> str:
    return shelf_with([]).find(text, WIRES).name


def _count(text: str) -> int:
    if not text.isdecimal() or not 3 <= int(text[:6]) <= 200:
        raise ValueError(f"got {text!r}; give a number of spans between 3 and 200")
    return int(text)


_READERS: dict[str, Callable[[str], Any]] = {
    "system": _one_of(SYSTEMS),
    "speed": _quantity("m/s", 2.0, 140.0),
    "span": _quantity("m", 10.0, 100.0),
    "spans": _count,
    "contact": _wire,
    "contact_tension": _quantity("N", 1e3, 60e3),
    "messenger": _wire,
    "messenger_tension": _quantity("N", 1e3, 60e3),
    "ends": _one_of(ENDS),
    "band": _quantity("1/s", 20.0, 500.0),
    "arm_share": _quantity("", 0.0, 1.0),
}
_QUESTIONS = {
    "system": "Supply system (ac, dc-1.5kv, dc-3kv)",
    "speed": "Speed, as in 160 km/h",
    "span": "Span length, as in 60 m",
    "contact": "Contact wire, as in RiS 120",
    "contact_tension": "Its tension, as in 15 kN",
    "messenger": "Messenger wire, as in BzII-70",
    "messenger_tension": "Its tension",
    "arm_share": "Share of the wire that steady arms carry, 0 to 0.5",
    "ends": "Ends (mid-point: half a tension length; weighted; anchored)",
}


def _asked(answer: Answer) -> Answers:
    """Ask, one question after the other; an empty answer leaves the choice to the program."""
    answer.say("An empty answer leaves the choice to the program.")
    answers: dict[str, str] = {}
    for name, question in _QUESTIONS.items():
        while text := answer.out.input(f"{question}: ").strip():
            try:
                _READERS[name](text)
            except (UnitError, InputError, ValueError) as error:
                answer.say(str(error), "yellow")
                continue
            answers[name] = text
            break
    return Answers(**answers)


def _shown(choice: Choice) -> str:
    return f"{written(choice.value)}  ({choice.reason})"


def _as_data(choice: Choice) -> dict[str, Any]:
    return {
        "path": format_path(choice.path),
        "value": choice.value,
        "reason": choice.reason or "given",
    }
