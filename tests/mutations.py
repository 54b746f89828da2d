"""Input files damaged at random, reproducibly: bytes, lines and values of good ones changed."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import yaml

WORDS = (
    *("", "~", "null", "true", "yes", "nan", ".nan", ".inf", "-1", "0", "1e999", "1e-320", "0x1F"),
    *("9" * 25, "9" * 5000, "1_000", "1:30", "2015-01-01", "-0.0", "55 mm", "1 kg", "1e3 km/h"),
    *("1 N/(m", "1 m^9", "1 m^99", "5 °", "5 degC", "1,5", "1.5.5", "١٢", "½", "1 µm", "1 kkm"),
    *("!!bool maybe", "!!float '1:30'", "!!set {a}", "!!timestamp x", "&a [*a]", "*a", "<<: 1"),
    *("=1+1", "@x", "\x1b[31m", "\x00", "\ud800", "\u202e", "\ufeff", "é", "接触网", "a" * 400),
    *("ac-simple", "../other.yaml", "/etc/passwd", "/proc/kmsg", ".", "..", "con", "a/b", "~root"),
    *("contact", "height", "lift", "arm", "spring", "adaptive", "hht", "gaussian", "profile"),
    *("[", "]", "{", "}", ":", ",", ";", "'", '"', "#", "|", ">", "%", "---", "...", "\t", "\r"),
)
"""Texts that have broken readers of such files, here or elsewhere."""
VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, -1, 1, 2, 3, 10**6, 10**18, 10**30, -(10**400), 0.5, -0.0, 1e-300),
    *(1e300, float("nan"), float("inf"), "", [], {}, [[]], [None], {"a": 1}, [[[[1]]]], ["x"] * 20),
    *({"include": "ac-simple"}, {"table": "supports.csv"}, {"from": 1, "to": 2, "count": 3}),
    *({"seeds": 2}, {"low": 1, "high": 2}, {"variants": {"a": {}}}, {"method": "hht"}, [1, 2, 3]),
)


@dataclass(frozen=True)
class Seed:
    """A good file: its name, and its text or its content as plain data."""

    name: str
    content: Any

    @property
    def suffix(self) -> str:
        """The language of the file."""
        return self.name.rpartition(".")[2]

    def text(self) -> str:
        """Return the file as it is."""
        return self.content if isinstance(self.content, str) else dumped(self.content, self.suffix)


def mutants(seeds: Sequence[Seed], seed: int) -> Iterator[tuple[Seed, bytes]]:
    """Yield damaged files without end, the same ones for the same seed."""
    chance = random.Random(seed)
    while True:
        good = chance.choice(seeds)
        if not isinstance(good.content, str) and chance.random() < 0.6:
            data = _copied(good.content)
            for _ in range(chance.choice((1, 1, 2, 4))):
                _change_value(data, chance)
            text = dumped(data, good.suffix)
        else:
            text = good.text()
        if chance.random() < 0.5 or text == good.text():
            for _ in range(chance.choice((1, 1, 2, 8))):
                text = chance.choice(TEXT_CHANGES)(text, chance)
        content = text.encode("utf-8", "surrogatepass")
        yield good, _change_bytes(content, chance) if chance.random() < 0.1 else content


def dumped(data: Any, suffix: str) -> str:
    """Write plain data as YAML, TOML or JSON; what the language cannot say is left to chance."""
    if suffix == "json":
        return json.dumps(data, indent=1)
    if suffix == "toml":
        pairs = data.items() if isinstance(data, dict) else [("x", data)]
        return "".join(f"{_toml_key(key)} = {_toml(value)}\n" for key, value in pairs)
    return yaml.dump(data, allow_unicode=True, sort_keys=False)


def _toml_key(key: Any) -> str:
    return json.dumps(str(key))


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_toml_key(k)} = {_toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value)


def _copied(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _copied(item) for key, item in data.items()}
    return [_copied(item) for item in data] if isinstance(data, list) else data


def _change_value(data: Any, chance: random.Random) -> None:
    """Replace, remove, rename, double or wrap one value somewhere in plain data."""
    places = list(_places(data))
    if not places:
        return
    holder, key = chance.choice(places)
    others = [(h, k) for h, k in places if h is not holder]
    match chance.randrange(6):
        case 0 | 1:
            holder[key] = chance.choice((*VALUES, *WORDS))
        case 2:
            del holder[key]
        case 3 if isinstance(holder, dict):
            holder[chance.choice((str(key)[:-1] + "x", *WORDS))] = holder.pop(key)
        case 4:
            holder[key] = [holder[key]] * chance.choice((1, 2, 300))
        case _ if others:
            other, name = chance.choice(others)
            holder[key] = _copied(other[name])


def _places(data: Any) -> Iterator[tuple[Any, Any]]:
    keys = (
        list(data) if isinstance(data, dict) else range(len(data)) if isinstance(data, list) else ()
    )
    for key in keys:
        yield data, key
        yield from _places(data[key])


def _cut(text: str, chance: random.Random) -> str:
    start = chance.randrange(len(text) + 1)
    return text[:start] + text[start + chance.choice((1, 5, 50, 10**9)) :]


def _insert(text: str, chance: random.Random) -> str:
    at = chance.randrange(len(text) + 1)
    return text[:at] + chance.choice(WORDS) + text[at:]


def _replace_word(text: str, chance: random.Random) -> str:
    words = text.split()
    return text.replace(chance.choice(words), chance.choice(WORDS), 1) if words else text


def _repeat(text: str, chance: random.Random) -> str:
    start = chance.randrange(len(text) + 1)
    piece = text[start : start + chance.choice((1, 20, 200))]
    return text[:start] + piece * chance.choice((2, 3, 200)) + text[start:]


def _move_line(text: str, chance: random.Random) -> str:
    lines = text.splitlines(keepends=True)
    if not lines:
        return text
    line = lines.pop(chance.randrange(len(lines)))
    lines.insert(chance.randrange(len(lines) + 1), " " * chance.randrange(5) + line)
    return "".join(lines)


TEXT_CHANGES: tuple[Callable[[str, random.Random], str], ...] = (
    *(_cut, _insert, _insert, _replace_word, _replace_word, _repeat, _move_line),
)


def _change_bytes(content: bytes, chance: random.Random) -> bytes:
    changed = bytearray(content)
    for _ in range(chance.choice((1, 3, 20))):
        if changed:
            changed[chance.randrange(len(changed))] = chance.randrange(256)
    return bytes(changed)
