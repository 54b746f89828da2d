"""Physical quantities written by people ("320 km/h", "24 mm") turned into SI numbers.

The grammar of a unit follows ISO 80000-1: factors side by side, or joined by ``*`` or ``·``, are
multiplied; at most one solidus per level, with nothing multiplied after it, so that ``N/(m s)``
needs its parentheses and ``N/m s`` is refused instead of guessed. Exponents are integers,
written ``m^2``, ``m**2``, ``m2`` or ``m²``.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import lru_cache
from numbers import Real
from typing import NamedTuple, NoReturn

from tautwire.text import shown


class UnitError(ValueError):
    """A value is not a finite number, has a malformed unit or the wrong dimension."""


class Dimension(NamedTuple):
    """Exponents of mass, length, time, plane angle and difference of temperature."""

    mass: int = 0
    length: int = 0
    time: int = 0
    angle: int = 0
    warming: int = 0

    def times(self, other: Dimension, power: int = 1) -> Dimension:
        """Return the dimension of ``self * other**power``."""
        return Dimension(*(a + power * b for a, b in zip(self, other, strict=True)))


@dataclass(frozen=True)
class Unit:
    """A unit of measurement: its size in SI base units and its dimension."""

    factor: float
    dimension: Dimension

    def times(self, other: Unit, power: int = 1) -> Unit:
        """Return ``self * other**power``."""
        try:
            factor = self.factor * other.factor**power
        except (OverflowError, ZeroDivisionError):
            factor = math.inf
        return Unit(factor, self.dimension.times(other.dimension, power))


_ONE = Unit(1.0, Dimension())
_FORCE = Dimension(1, 1, -2)
_PREFIXED = {
    "g": Unit(1e-3, Dimension(mass=1)),
    "m": Unit(1.0, Dimension(length=1)),
    "s": Unit(1.0, Dimension(time=1)),
    "N": Unit(1.0, _FORCE),
    "Pa": Unit(1.0, Dimension(1, -1, -2)),
    "Hz": Unit(1.0, Dimension(time=-1)),
}
_POUND, _GRAVITY = 0.45359237, 9.80665
"""Avoirdupois pound [kg] and standard gravity [m/s^2], exact: NIST SP 811, appendix B."""
_PLAIN = {
    "in": Unit(0.0254, Dimension(length=1)),
    "ft": Unit(0.3048, Dimension(length=1)),
    "yd": Unit(0.9144, Dimension(length=1)),
    "mi": Unit(1609.344, Dimension(length=1)),
    "lb": Unit(_POUND, Dimension(mass=1)),
    "lbf": Unit(_POUND * _GRAVITY, _FORCE),
    "kip": Unit(1e3 * _POUND * _GRAVITY, _FORCE),
    "min": Unit(60.0, Dimension(time=1)),
    "h": Unit(3600.0, Dimension(time=1)),
    "K": Unit(1.0, Dimension(warming=1)),
    "kgf": Unit(_GRAVITY, _FORCE),
    "kp": Unit(_GRAVITY, _FORCE),
    "kph": Unit(1.0 / 3.6, Dimension(0, 1, -1)),
    "mph": Unit(0.44704, Dimension(0, 1, -1)),
    "rad": Unit(1.0, Dimension(angle=1)),
    "mrad": Unit(1e-3, Dimension(angle=1)),
    "deg": Unit(math.pi / 180.0, Dimension(angle=1)),
    "°": Unit(math.pi / 180.0, Dimension(angle=1)),
}
TEMPERATURE = "degC"
"""Unit in which temperatures are held; a difference of temperatures is in K."""
_TEMPERATURES = {"degC": (0.0, 1.0), "°C": (0.0, 1.0), "degF": (32.0, 1.8), "°F": (32.0, 1.8)}
"""Temperature that is 0 degC, and degrees per degC: units that only a temperature can have."""
_PREFIXES = {
    "n": 1e-9,
    "u": 1e-6,
    "µ": 1e-6,
    "μ": 1e-6,
    "m": 1e-3,
    "c": 1e-2,
    "d": 1e-1,
    "da": 1e1,
    "k": 1e3,
    "M": 1e6,
    "G": 1e9,
}
_KINDS = {
    "": ("a pure number", "1"),
    "m": ("a length", "24 mm"),
    "s": ("a time", "1 ms"),
    "kg": ("a mass", "0.165 kg"),
    "N": ("a force", "22 kN"),
    "rad": ("an angle", "10 deg"),
    "degC": ("a temperature", "35 degC"),
    "K": ("a difference of temperatures", "20 K"),
    "1/K": ("a thermal expansion", "17e-6 1/K"),
    "1/s": ("a rate", "0.0125 1/s"),
    "1/m": ("a wavenumber", "0.5 1/m"),
    "m^3": ("a spectral density", "1e-7 m^3"),
    "m/s": ("a speed", "320 km/h"),
    "m/s^2": ("an acceleration", "9.81 m/s^2"),
    "kg/m": ("a mass per length", "1.35 kg/m"),
    "kg/m^3": ("a density", "1.25 kg/m^3"),
    "N/m": ("a stiffness", "200 kN/m"),
    "N s/m": ("a damping", "1000 N s/m"),
    "N m^2": ("a bending stiffness", "195 N m^2"),
    "N/(m/s)^2": ("a force per speed squared", "0.00097 N/(km/h)^2"),
}
_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(.*)", re.DOTALL | re.ASCII)
_TOKEN = re.compile(r"(\s+)|([A-Za-zµμ°]+)|([0-9]+)|(\*\*|[\^*·⋅/()-])|([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+)")
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_MAX_LENGTH = 100
"""Characters of a unit; the longest that means anything has about twenty."""
_MAX_EXPONENT = 9
"""Exponents have one digit; 4 is the highest in mechanics of wires."""


def parse_quantity(value: object, unit: str) -> float:
    """Convert a number or a text such as ``"320 km/h"`` to a finite SI number.

    Parameters
    ----------
    value
        A number, taken as SI, or a text: a number, optionally followed by a unit.
    unit
        The SI unit of the quantity, which sets the dimension to check.

    Returns
    -------
    float
        The value in `unit`.

    Raises
    ------
    UnitError
        Saying what was got, the dimension that is expected and an example.

    Examples
    --------
    >>> parse_quantity("24 mm", "m")
    0.024
    """
    if isinstance(value, str):
        return _parse_text(value, unit)
    if isinstance(value, bool) or not isinstance(value, Real):
        raise UnitError(f"got {shown(value)}; expected {expectation(unit)}")
    return _finite(value, value, unit)


@lru_cache(maxsize=256)
def parse_unit(text: str) -> Unit:
    """Parse a unit expression such as ``"N/(km/h)^2"``.

    Raises
    ------
    UnitError
        When a symbol is unknown or the expression is malformed or ambiguous.
    """
    if len(text) > _MAX_LENGTH:
        raise UnitError(f"the unit {text[:20]!r}... is longer than {_MAX_LENGTH} characters")
    return _UnitParser(text).parse()


def to_unit(value: float, unit: str) -> float:
    """Express an SI value in another unit of the same dimension, for people to read."""
    if unit == TEMPERATURE:
        return value
    return value / parse_unit(unit).factor


def expectation(unit: str) -> str:
    """Say in words which quantity is expected, with its SI unit and an example."""
    kind, example = _KINDS.get(unit, ("a value", f"1 {unit}"))
    if not unit:
        return f"{kind}, for example {example}"
    return f"{kind} [{unit}], for example '{example}' (a number without unit is in {unit})"


def _parse_text(text: str, unit: str) -> float:
    match = _NUMBER.fullmatch(text.replace("\u2212", "-").replace("\u00a0", " "))
    if match is None:
        raise UnitError(f"got {shown(text)}, not a number; expected {expectation(unit)}")
    digits, symbol = match.group(1), match.group(2).strip()
    if re.match(r"[,_'.]|\d(?!\s*/)", symbol):
        raise UnitError(
            f"got {shown(text)}; write numbers with a decimal point and without separators "
            f"of thousands; expected {expectation(unit)}"
        )
    if not symbol:
        return _finite(float(digits), text, unit)
    if unit == TEMPERATURE:
        return _finite(_temperature(text, digits, symbol), text, unit)
    try:
        given = parse_unit("1" + symbol if symbol.startswith("/") else symbol)
    except UnitError as error:
        raise UnitError(f"got {shown(text)}: {error}; expected {expectation(unit)}") from None
    expected = parse_unit(unit) if unit else _ONE
    if given.dimension != expected.dimension:
        raise UnitError(
            f"got {shown(text)}, which is {_kind_of(given.dimension)}; "
            f"expected {expectation(unit)}{_as_force(text, symbol, expected)}"
        )
    return _finite(_scaled(digits, given.factor), text, unit)


def _temperature(text: str, digits: str, symbol: str) -> float:
    """Return a temperature [degC]; what is no unit of a temperature is refused."""
    if symbol not in _TEMPERATURES:
        raise UnitError(f"got {shown(text)}; expected {expectation(TEMPERATURE)}")
    zero, size = _TEMPERATURES[symbol]
    return (float(digits) - zero) / size


def _as_force(text: str, symbol: str, expected: Unit) -> str:
    """Suggest the unit of force for a tension written in kilograms or pounds."""
    force = re.sub(r"\b(kg|lb)\b", r"\1f", symbol)
    if force == symbol or parse_unit(force).dimension != expected.dimension:
        return ""
    return f"; did you mean '{text.strip().removesuffix(symbol)}{force}'?"


def _scaled(digits: str, factor: float) -> float:
    """Multiply, dividing by the inverse where that is exact: "24 mm" is 0.024, not 0.02400..1."""
    inverse = 1.0 / factor
    if factor < 1.0 and inverse == round(inverse):
        return float(digits) / inverse
    return float(digits) * factor


def _finite(number: Real | float, given: object, unit: str) -> float:
    try:
        result = float(number)
    except OverflowError:
        result = math.inf
    if not math.isfinite(result):
        raise UnitError(f"got {shown(given)}, not a finite number; expected {expectation(unit)}")
    return result


def _kind_of(dimension: Dimension) -> str:
    for unit, (kind, _) in _KINDS.items():
        if (
            unit != TEMPERATURE
            and (parse_unit(unit).dimension if unit else Dimension()) == dimension
        ):
            return kind
    return "another kind of quantity"


class _UnitParser:
    """Recursive descent over the tokens of one unit expression.

    expression = product ["/" factor];  product = factor {["*"] factor};
    factor = (symbol | "1" | "(" expression ")") [exponent]
    """

    def __init__(self, text: str) -> None:
        self._text = text
        self._tokens = self._split(text)
        self._at = 0

    def parse(self) -> Unit:
        unit = self._expression()
        if self._peek():
            self._fail(f"unexpected {self._peek()!r}")
        if not (math.isfinite(unit.factor) and unit.factor > 0.0):
            self._fail("the unit is out of range")
        return unit

    def _split(self, text: str) -> list[str]:
        tokens, at = [], 0
        while at < len(text):
            match = _TOKEN.match(text, at)
            if match is None:
                self._fail(f"unexpected {text[at]!r}")
            if not match.group(1):
                tokens.append(match.group(0))
            at = match.end()
        return tokens

    def _peek(self) -> str:
        return self._tokens[self._at] if self._at < len(self._tokens) else ""

    def _take(self) -> str:
        token = self._peek()
        self._at += 1
        return token

    def _expression(self) -> Unit:
        unit = self._factor()
        while (token := self._peek()) and token not in ("/", ")"):
            if token in ("*", "·", "⋅"):
                self._take()
            unit = unit.times(self._factor())
        if self._peek() == "/":
            self._take()
            unit = unit.times(self._factor(), -1)
            if self._peek() not in ("", ")"):
                self._fail("use parentheses after '/', as in 'N/(m s)'")
        return unit

    def _factor(self) -> Unit:
        token = self._take()
        if token == "(":
            unit = self._expression()
            if self._take() != ")":
                self._fail("a closing parenthesis is missing")
        elif token == "1":
            return _ONE
        else:
            unit = self._symbol(token)
        return _ONE.times(unit, self._exponent())

    def _symbol(self, token: str) -> Unit:
        if token in _PLAIN:
            return _PLAIN[token]
        if token in _PREFIXED:
            return _PREFIXED[token]
        for prefix, scale in _PREFIXES.items():
            base = _PREFIXED.get(token.removeprefix(prefix))
            if token.startswith(prefix) and base is not None:
                return Unit(scale * base.factor, base.dimension)
        if token in _TEMPERATURES:
            self._fail(f"{token!r} is a temperature; a difference of temperatures is in K")
        if token.isalpha() or token == "°":
            self._fail(f"unknown unit symbol {token!r}")
        self._fail(f"unexpected {token!r}" if token else "the unit ends too early")

    def _exponent(self) -> int:
        token = self._peek()
        if token in ("^", "**"):
            self._take()
            sign = -1 if self._peek() == "-" and self._take() else 1
            digits = self._take()
        elif token and token[0] in "⁰¹²³⁴⁵⁶⁷⁸⁹⁻":
            sign, digits = 1, self._take().translate(_SUPERSCRIPTS)
            if digits.startswith("-"):
                sign, digits = -1, digits[1:]
        elif token.isdecimal():
            sign, digits = 1, self._take()
        else:
            return 1
        if not digits.isdecimal() or int(digits) > _MAX_EXPONENT:
            self._fail(f"the exponent must be an integer up to {_MAX_EXPONENT}")
        return sign * int(digits)

    def _fail(self, reason: str) -> NoReturn:
        raise UnitError(f"unit {self._text!r} is not understood, {reason}")
