"""Quantities written by people."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tautwire.units import UnitError, expectation, parse_quantity, parse_unit, to_unit

GOOD = [
    ("320 km/h", "m/s", 320 / 3.6),
    ("24 mm", "m", 0.024),
    ("24mm", "m", 0.024),
    ("22 kN", "N", 22e3),
    ("15.0 MN", "N", 15e6),
    ("200 daN", "N", 2000.0),
    ("200 kN/m", "N/m", 2e5),
    ("195 N m^2", "N m^2", 195.0),
    ("195 N*m^2", "N m^2", 195.0),
    ("195 N·m²", "N m^2", 195.0),
    ("195 N m2", "N m^2", 195.0),
    ("195 N m**2", "N m^2", 195.0),
    ("0.00097 N/(km/h)^2", "N/(m/s)^2", 0.00097 * 3.6**2),
    ("0.0125 1/s", "1/s", 0.0125),
    ("0.0125/s", "1/s", 0.0125),
    ("0.0125 s^-1", "1/s", 0.0125),
    ("0.0125 s⁻¹", "1/s", 0.0125),
    ("0.0125 Hz", "1/s", 0.0125),
    ("1000 N s/m", "N s/m", 1000.0),
    ("1000 N/(m/s)", "N s/m", 1000.0),
    ("1.35 kg/m", "kg/m", 1.35),
    ("117 g/m", "kg/m", 0.117),
    ("1 ms", "s", 1e-3),
    ("500 µs", "s", 5e-4),
    ("2 min", "s", 120.0),
    ("-10 deg", "rad", -math.pi / 18),
    ("10°", "rad", math.pi / 18),
    ("100 GPa", "N/m^2", 1e11),
    ("1500 kgf", "N", 14709.975),
    ("100 mph", "m/s", 44.704),
    ("90 kph", "m/s", 25.0),
    ("150 ft", "m", 45.72),
    ("9 in", "m", 0.2286),
    ("2 mi", "m", 3218.688),
    ("3000 lbf", "N", 13344.664845781499),
    ("6 kip", "N", 26689.329691562998),
    ("1.063 lb/ft", "kg/m", 1.5819182720144356),
    ("40 lbf/in", "N/m", 7005.073409859055),
    ("1000 kp", "N", 9806.65),
    ("9.81 m/s^2", "m/s^2", 9.81),
    ("−5 mm", "m", -0.005),
    ("1e-4", "s", 1e-4),
    (".5", "m", 0.5),
    ("-0.05", "", -0.05),
    (55, "m", 55.0),
    (0.2, "m", 0.2),
]

BAD = [
    ("24 s", "m", "which is a time; expected a length [m], for example '24 mm'"),
    ("5 kN", "N/m", "which is a force; expected a stiffness [N/m]"),
    ("5 mm^9", "m", "another kind of quantity"),
    ("5 furlong", "m", "unknown unit symbol 'furlong'"),
    ("5 Nm2", "N m^2", "unknown unit symbol 'Nm'"),
    ("5 N/m s", "N s/m", "use parentheses after '/'"),
    ("5 N/m/s", "N", "use parentheses after '/'"),
    ("5 N/(m s", "N", "a closing parenthesis is missing"),
    ("5 m^", "m", "the exponent must be an integer up to 9"),
    ("5 m^99", "m", "the exponent must be an integer up to 9"),
    ("5 m^x", "m", "the exponent must be an integer up to 9"),
    ("5 m-1", "m", "unexpected '-'"),
    ("5 m)", "m", "unexpected ')'"),
    ("5 %", "m", "unexpected '%'"),
    ("5 (Gm^9)^9", "m", "the unit is out of range"),
    ("5 (nm^9)^9", "m", "the unit is out of range"),
    ("5 m*", "m", "the unit ends too early"),
    ("5 *m", "m", "unexpected '*'"),
    ("5 " + "m" * 200, "m", "is longer than 100 characters"),
    ("0,5 m", "m", "write numbers with a decimal point"),
    ("1 000 N", "N", "without separators of thousands"),
    ("1_000", "N", "without separators of thousands"),
    ("1.2.3", "m", "write numbers with a decimal point"),
    ("1e999", "m", "not a finite number"),
    ("1e308 km", "m", "not a finite number"),
    (10**400, "m", "not a finite number"),
    (math.inf, "m", "not a finite number"),
    (math.nan, "m", "not a finite number"),
    ("nan", "m", "not a number"),
    ("inf N", "N", "not a number"),
    ("", "m", "not a number"),
    ("fast", "m/s", "expected a speed [m/s], for example '320 km/h'"),
    (True, "m", "got True; expected a length"),
    (None, "m", "got nothing; expected a length"),
    ([1.0], "m", "got [1.0]; expected a length"),
    ("x" * 100, "m", "xxx..., not a number"),
]


@pytest.mark.parametrize(("text", "unit", "expected"), GOOD)
def test_quantity_is_converted(text: object, unit: str, expected: float) -> None:
    """A number or a text with a unit becomes the SI number."""
    assert parse_quantity(text, unit) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(("text", "unit", "message"), BAD, ids=lambda value: str(value)[:20])
def test_bad_quantity_is_refused(text: object, unit: str, message: str) -> None:
    """A message says what was got, what is expected and gives an example."""
    with pytest.raises(UnitError) as caught:
        parse_quantity(text, unit)
    assert message in str(caught.value)
    assert "expected" in str(caught.value)


def test_millimetres_are_exact() -> None:
    """Everyday values are the nearest float: "41 mm" is 0.041 and nothing beside it."""
    wrong = [n for n in range(2000) if parse_quantity(f"{n} mm", "m") != float(f"{n}e-3")]
    assert not wrong


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_numbers_survive(number: float) -> None:
    """A number written out is read back exactly, with and without its SI unit."""
    assert parse_quantity(repr(number), "N") == number
    assert parse_quantity(f"{number!r} N", "N") == number


@pytest.mark.parametrize(
    ("text", "unit", "meant"),
    [("3000 lb", "N", "3000 lbf"), ("1500 kg", "N", "1500 kgf"), ("40 lb/in", "N/m", "40 lbf/in")],
)
def test_mass_in_place_of_a_force(text: str, unit: str, meant: str) -> None:
    """A tension in kilograms or pounds is refused with the unit of force that is likely meant."""
    with pytest.raises(UnitError, match=f"did you mean '{meant}'"):
        parse_quantity(text, unit)
    with pytest.raises(UnitError, match="which is a length; expected a force") as caught:
        parse_quantity("3 ft", "N")
    assert "did you mean" not in str(caught.value)


@given(st.text(max_size=30))
def test_any_text_is_answered(text: str) -> None:
    """No text raises anything but UnitError, and what is accepted is finite."""
    try:
        value = parse_quantity(text, "m")
    except UnitError:
        value = 0.0
    assert math.isfinite(value)


@given(st.text(alphabet="mskNhr/()^*·² 123-", max_size=20))
def test_any_unit_is_answered(text: str) -> None:
    """No unit expression raises anything but UnitError, and its size is positive."""
    try:
        size = parse_unit(text).factor
    except UnitError:
        size = 1.0
    assert 0.0 < size < math.inf


def test_to_unit_is_the_inverse() -> None:
    """A value for people is the SI value divided by the unit."""
    assert to_unit(parse_quantity("320 km/h", "m/s"), "km/h") == pytest.approx(320.0)


def test_expectation_of_a_pure_number() -> None:
    """A pure number has no unit in its expectation, an unlisted unit has a plain example."""
    assert expectation("") == "a pure number, for example 1"
    assert "for example '1 kg m'" in expectation("kg m")


@pytest.mark.parametrize(
    ("text", "value"), [("35 degC", 35.0), ("-40 °C", -40.0), ("95 degF", 35.0), ("20", 20.0)]
)
def test_temperatures(text: str, value: float) -> None:
    """A temperature is held in degC, whatever scale it is given in."""
    assert parse_quantity(text, "degC") == pytest.approx(value, abs=1e-12)


@pytest.mark.parametrize(
    ("text", "unit", "told"),
    [
        ("20 K", "degC", "expected a temperature"),
        ("20 degC", "K", "a difference of temperatures is in K"),
        ("3 K", "m", "which is a difference of temperatures"),
    ],
)
def test_temperatures_are_no_differences(text: str, unit: str, told: str) -> None:
    """A temperature is no difference and a difference no temperature."""
    with pytest.raises(UnitError, match=told):
        parse_quantity(text, unit)
