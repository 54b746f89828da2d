"""YAML, TOML and JSON texts turned into plain data, refusing what is ambiguous or hostile.

YAML is read with the plain scalars of YAML 1.2 and without tags: only ``true`` and ``false`` are
booleans, ``1e-4`` is a number, and ``1:30`` or ``2015-01-01`` are texts. Whatever the language,
what comes out holds mappings, lists, texts of printable characters, numbers, booleans and nothing.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator
from typing import Any

import yaml

from tautwire.errors import InputError
from tautwire.inputs.reading.grouping import grouped
from tautwire.text import unprintable

SUFFIXES = (".yaml", ".yml", ".toml", ".json")
MAX_DEPTH = 30
"""Nesting of mappings and lists; a case nests about seven deep."""
MAX_VALUES = 50_000
"""Values of a document: a line of a thousand spans with lists of fifty items per span."""
MAX_INTEGER = 2**63 - 1
"""Largest whole number; TOML 1.0 sets the same bound. No value of a case comes near it."""
MAX_DIGITS = len(str(MAX_INTEGER))
_TOO_LONG = f"a whole number has more than {MAX_DIGITS} digits; write it as in 1e20"
_TOO_MANY = (
    f"it holds, or its aliases expand to, more than {MAX_VALUES} values; write values out instead "
    "of using aliases, and keep long tables in CSV files ('tables')"
)


def parse_document(text: str, label: str, suffix: str) -> dict[str, Any]:
    """Parse a document whose top level is a mapping.

    Parameters
    ----------
    text
        Content of the file.
    label
        Name of the file in messages.
    suffix
        ``.yaml``, ``.yml``, ``.toml`` or ``.json``.

    Raises
    ------
    InputError
        When the text is malformed, repeats a key, is nested too deeply, expands to too much,
        holds values of a kind that no case has, or is not a mapping.
    """
    parse = {".toml": _parse_toml, ".json": _parse_json}.get(suffix.lower(), _parse_yaml)
    try:
        data = parse(text)
    except RecursionError:
        raise InputError(f"{label}: is nested too deeply; {MAX_DEPTH} levels are allowed") from None
    except yaml.MarkedYAMLError as error:
        raise InputError(f"{label}: {_yaml_problem(error)}") from None
    except (ValueError, yaml.YAMLError) as error:
        reason = f"cannot be read as {_language(suffix)}: {_reason(error)}"
        raise InputError(f"{label}: {reason}") from None
    if not isinstance(data, dict):
        raise InputError(f"{label}: must be a mapping of keys to values, not {_kind(data)}")
    problems = grouped(f"{label}: {place}{fault}" for place, fault in _unfit(data))
    if problems:
        raise InputError(problems)
    return data


def parse_value(text: str) -> Any:
    """Parse one value as in a YAML file: a number, a text with a unit, a list, a mapping.

    Raises
    ------
    ValueError
        When the text is not one YAML value.
    """
    try:
        value = _parse_yaml(text)
    except (yaml.YAMLError, RecursionError) as error:
        problem = getattr(error, "problem", None) or "it cannot be parsed"
        raise ValueError(f"the value {text[:60]!r} is malformed: {problem}") from None
    for place, fault in _unfit(value):
        raise ValueError(f"the value {text[:60]!r} cannot be used: {place}{fault}")
    return value


class _Loader(yaml.SafeLoader):
    """Safe loader with YAML 1.2 scalars, no tags, a limit on depth, and no repeated keys."""

    yaml_implicit_resolvers: dict[str, list[tuple[str, re.Pattern[str]]]] = {}  # noqa: RUF012
    depth = 0
    values = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Compose a node, unless it has a tag, lies too deep or there are too many."""
        event = self.peek_event()
        tag = getattr(event, "tag", None)
        if tag is not None:
            raise yaml.MarkedYAMLError(
                problem=f"the tag {tag[:60]!r} is not read; write the value alone, text in quotes",
                problem_mark=event.start_mark,
            )
        self.depth += 1
        self.values += 1
        if self.depth > MAX_DEPTH:
            raise RecursionError
        if self.values > MAX_VALUES:
            raise ValueError(_TOO_MANY)
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:  # noqa: FBT001, FBT002
        """Construct a mapping whose keys are distinct texts."""
        seen: set[str] = set()
        for key_node, _ in node.value:
            mark = key_node.start_mark
            if key_node.tag != "tag:yaml.org,2002:str":
                raise yaml.MarkedYAMLError(problem="a key must be a word", problem_mark=mark)
            if key_node.value in seen:
                raise yaml.MarkedYAMLError(
                    problem=f"the key {key_node.value!r} is given twice; keep one of them",
                    problem_mark=mark,
                )
            seen.add(key_node.value)
        return super().construct_mapping(node, deep=deep)


_SCALARS = (
    ("null", r"~|null|Null|NULL|", "~nN\0"),
    ("bool", r"true|True|TRUE|false|False|FALSE", "tTfF"),
    ("int", r"[-+]?[0-9]+", "-+0123456789"),
    (
        "float",
        r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?|[-+]?\.inf|\.nan",
        "-+0123456789.",
    ),
)


def _construct_int(loader: _Loader, node: Any) -> int:
    try:
        return _whole_number(loader.construct_scalar(node))
    except ValueError as error:
        raise yaml.MarkedYAMLError(problem=str(error), problem_mark=node.start_mark) from None


def _whole_number(digits: str) -> int:
    if len(digits) > MAX_DIGITS + 1:  # a sign
        raise ValueError(_TOO_LONG)
    return int(digits)


for _name, _pattern, _first in _SCALARS:
    _Loader.add_implicit_resolver(
        f"tag:yaml.org,2002:{_name}",
        re.compile(rf"(?:{_pattern})\Z"),
        ["" if letter == "\0" else letter for letter in _first],
    )
_Loader.add_constructor("tag:yaml.org,2002:int", _construct_int)


def _parse_yaml(text: str) -> Any:
    loader = _Loader(text)
    try:
        node = loader.get_single_node()
        if node is None:
            return None
        _check_expansion(node)
        return loader.construct_document(node)
    finally:
        loader.dispose()


def _check_expansion(root: yaml.Node) -> None:
    """Refuse aliases that refer to themselves or multiply into a very large document."""
    sizes: dict[int, int] = {}
    open_nodes: set[int] = set()

    def size(node: yaml.Node) -> int:
        key = id(node)
        if key in open_nodes:
            raise yaml.MarkedYAMLError(
                problem="an alias refers to itself", problem_mark=node.start_mark
            )
        if key not in sizes:
            open_nodes.add(key)
            sizes[key] = 1 + sum(size(child) for child in _children(node))
            open_nodes.discard(key)
        return sizes[key]

    if size(root) > MAX_VALUES:
        raise ValueError(_TOO_MANY)


def _children(node: yaml.Node) -> list[yaml.Node]:
    if isinstance(node, yaml.MappingNode):
        return [part for pair in node.value for part in pair]
    return node.value if isinstance(node, yaml.SequenceNode) else []


def _parse_toml(text: str) -> Any:
    return tomllib.loads(text)


def _parse_json(text: str) -> Any:
    return json.loads(
        text,
        object_pairs_hook=_distinct_keys,
        parse_constant=_refuse_constant,
        parse_int=_whole_number,
    )


def _distinct_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    result: dict[str, Any] = {}
    for key, value in pairs:
        if key in result:
            raise ValueError(f"the key {key!r} is given twice; keep one of them")
        result[key] = value
    return result


def _refuse_constant(word: str) -> Any:
    raise ValueError(f"{word} is not a finite number")


def _unfit(data: Any) -> Iterator[tuple[str, str]]:
    """Yield the place and the fault of everything that no case may hold.

    A place ends in ``": "``, so that place and fault make a sentence; the top has none.
    """
    level: list[tuple[str, Any]] = [("", data)]
    count = 0
    for _ in range(MAX_DEPTH + 1):
        below: list[tuple[str, Any]] = []
        for path, value in level:
            if isinstance(value, dict):
                for key, item in value.items():
                    if fault := unprintable(key):
                        yield _place(path), f"a key {fault}"
                    below.append((f"{path}.{key}", item))
            elif isinstance(value, list):
                below += [(f"{path}[{number}]", item) for number, item in enumerate(value, 1)]
            elif fault := _unfit_scalar(value):
                yield _place(path), fault
        level = below
        count += len(level)
        if not level:
            return
        if count > MAX_VALUES:
            yield "", _TOO_MANY
            return
    yield "", f"is nested too deeply; {MAX_DEPTH} levels are allowed"


def _place(path: str) -> str:
    return path.lstrip(".") + ": " if path else ""


def _unfit_scalar(value: Any) -> str:
    """Say why a scalar is not read; nothing when it is."""
    if isinstance(value, str):
        return unprintable(value)
    if isinstance(value, int):
        return _TOO_LONG if abs(value) > MAX_INTEGER else ""
    if value is None or isinstance(value, float):
        return ""
    return f"got a {type(value).__name__}; write a text in quotes, or a number"


def _reason(error: Exception) -> str:
    """Return the first line of what a parser says."""
    text = str(error).splitlines()[0]
    return _TOO_LONG if "integer string conversion" in text else text


def _yaml_problem(error: yaml.MarkedYAMLError) -> str:
    mark = error.problem_mark or error.context_mark
    place = f"line {mark.line + 1}, column {mark.column + 1}: " if mark is not None else ""
    words = [word for word in (error.context, error.problem) if word]
    return place + (": ".join(words) or "is not valid YAML")


def _language(suffix: str) -> str:
    return {".toml": "TOML", ".json": "JSON"}.get(suffix.lower(), "YAML")


def _kind(data: object) -> str:
    return {list: "a list", str: "a text", type(None): "nothing"}.get(type(data), "a single value")
