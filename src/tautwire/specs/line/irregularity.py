"""Irregularities of the contact wire: as installed, and of its running surface."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import Annotated, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from tautwire.specs.base import LIST, TABLE, Problem, Quantity, Spec, form_of, refuse
from tautwire.specs.line.catenary import Line
from tautwire.specs.line.dropper import Droppers

Deviation = Annotated[float, Quantity("m", ge=-0.5, le=0.5, typical="-5 to 5 mm")]
Spread = Annotated[float, Quantity("m", gt=0.0, le=0.5, typical="1 to 5 mm")]
Wavelength = Annotated[float, Quantity("m", ge=0.02, le=1000.0, typical="0.3 to 10 m")]
Wavenumber = Annotated[float, Quantity("1/m", gt=0.0, le=100.0, typical="0.1 to 3 1/m")]
Density = Annotated[float, Quantity("m^3", ge=0.0, le=1.0, typical="1e-7 m^3")]
Place = Annotated[float, Quantity("m", ge=0.0, le=1e5, typical="412 m")]
Deviations = Annotated[
    Annotated[tuple[Deviation, ...], Tag(LIST)]
    | Annotated[tuple[tuple[Deviation, ...], ...], Tag(TABLE)],
    Discriminator(form_of),
]


def _check_fields(
    spec: Spec, kind: str, needed: Iterable[str], possible: Iterable[str]
) -> list[Problem]:
    """Check that a spec of a kind has what it needs and nothing that belongs to another kind."""
    missing = [n for n in needed if getattr(spec, n) is None]
    foreign = [n for n in possible if n not in needed and getattr(spec, n) is not None]
    return [Problem((n,), f"is missing; '{kind}' needs it") for n in missing] + [
        Problem((n,), f"does not belong to '{kind}'; leave it out") for n in foreign
    ]


class Installation(Spec):
    """Errors of installation, one per dropper; they change the static shape.

    Errors of height are added where heights are prescribed, errors of length where lengths are
    given. In dropper mode 'height', errors of length are added to the lengths that belong to the
    nominal heights, and the shape is found anew with these lengths.
    """

    of: Literal["height", "length"] = Field(
        description="What is wrong: 'height' of the contact wire at the droppers (up is positive; "
        "dropper mode 'height' only), or 'length' of the droppers."
    )
    distribution: Literal["uniform", "gaussian", "table"] = Field(
        default="uniform",
        description="'uniform' (needs amplitude), 'gaussian' (needs deviation) or 'table' (needs "
        "values).",
    )
    amplitude: Spread | None = Field(
        default=None, description="Uniform: largest error to either side."
    )
    deviation: Spread | None = Field(default=None, description="Gaussian: standard deviation.")
    values: Deviations | None = Field(
        default=None,
        description="Table: one error per dropper, left to right, valid in every span, or one "
        "list per span.",
    )

    @model_validator(mode="after")
    def _check_distribution(self) -> Installation:
        needs = {"uniform": "amplitude", "gaussian": "deviation", "table": "values"}
        refuse(_check_fields(self, self.distribution, (needs[self.distribution],), needs.values()))
        return self


_NEEDED = {
    "uniform": ("spacing", "amplitude"),
    "gaussian": ("spacing", "deviation"),
    "power law": ("level", "exponent", "reference", "shortest", "longest"),
    "spectrum": ("wavenumbers", "densities", "shortest", "longest"),
    "profile": ("x", "height"),
    "bump": ("position", "length", "rise"),
}
_POSSIBLE = tuple(dict.fromkeys(name for names in _NEEDED.values() for name in names))


class Unevenness(Spec):
    """One part of the unevenness of the running surface; all parts add up.

    It is a height of the running surface relative to the wire, positive upwards, that acts between
    wire and head: the gap is wire height + unevenness - head height. The static shape does not
    change.
    """

    table_columns: ClassVar[tuple[str, ...]] = ("x", "height")

    kind: Literal["uniform", "gaussian", "power law", "spectrum", "profile", "bump"] = Field(
        description="'uniform' or 'gaussian' (independent random ordinates at a spacing, joined by "
        "a cubic spline), 'power law' or 'spectrum' (sum of harmonics with random phases from a "
        "power spectral density), 'profile' (measured ordinates), 'bump' (a local hard spot, one "
        "period of a cosine)."
    )
    spacing: Wavelength | None = Field(
        default=None, description="Uniform, gaussian: distance of the ordinates."
    )
    amplitude: Spread | None = Field(
        default=None, description="Uniform: largest ordinate to either side."
    )
    deviation: Spread | None = Field(
        default=None, description="Gaussian: standard deviation of the ordinates."
    )
    level: Density | None = Field(
        default=None, description="Power law: spectral density at the reference wavenumber."
    )
    reference: Wavenumber | None = Field(
        default=None, description="Power law: wavenumber (cycles per metre) of the level."
    )
    exponent: Annotated[float, Quantity("", ge=-10.0, le=10.0, typical="2 to 4")] | None = Field(
        default=None,
        description="Power law: density = level (wavenumber/reference)^-exponent.",
    )
    wavenumbers: tuple[Wavenumber, ...] | None = Field(
        default=None,
        min_length=2,
        description="Spectrum: wavenumbers (cycles per metre), increasing.",
    )
    densities: tuple[Density, ...] | None = Field(
        default=None,
        description="Spectrum: spectral density at the wavenumbers, linear between them, none "
        "beyond.",
    )
    sides: Literal["one", "two"] = Field(
        default="one",
        description="Whether a density counts positive wavenumbers only ('one'; its integral is "
        "the variance) or both signs ('two'; twice its integral is).",
    )
    shortest: Wavelength | None = Field(
        default=None, description="Power law, spectrum: shortest wavelength."
    )
    longest: Wavelength | None = Field(
        default=None, description="Power law, spectrum: longest wavelength."
    )
    x: tuple[Place, ...] | None = Field(
        default=None,
        min_length=2,
        description="Profile: positions of the ordinates from the left anchor, increasing; or "
        "{kind: profile, table: file.csv} with columns x and height.",
    )
    height: tuple[Deviation, ...] | None = Field(
        default=None, description="Profile: ordinates, linear between them, none beyond."
    )
    position: Place | None = Field(
        default=None, description="Bump: its middle, from the left anchor."
    )
    length: Wavelength | None = Field(default=None, description="Bump: its length.")
    rise: Deviation | None = Field(
        default=None,
        description="Bump: height in the middle; negative where the surface hangs down.",
    )

    @model_validator(mode="after")
    def _check_kind(self) -> Unevenness:
        problems = _check_fields(self, self.kind, _NEEDED[self.kind], _POSSIBLE)
        refuse(problems or self._check_tables())
        return self

    def _check_tables(self) -> list[Problem]:
        problems = []
        for axis, values in (("wavenumbers", "densities"), ("x", "height")):
            at, of = getattr(self, axis), getattr(self, values)
            if at is None or of is None:
                continue
            if len(at) != len(of):
                text = f"has {len(of)} values for {len(at)} {axis}; give one for each"
                problems.append(Problem((values,), text))
            problems += [
                Problem((axis, i + 1), f"got {after:g} after {before:g}; must increase")
                for i, (before, after) in enumerate(pairwise(at))
                if after <= before
            ]
        shortest, longest = self.shortest, self.longest
        if shortest is not None and longest is not None and shortest >= longest:
            text = f"got {shortest:g} m, not below longest, {longest:g} m"
            problems.append(Problem(("shortest",), text))
        return problems


class Irregularities(Spec):
    """Irregularities of the contact wire; every random one has a stream of settings.seed."""

    installation: Installation | None = Field(
        default=None, description="Errors of dropper heights or lengths; none if left out."
    )
    unevenness: tuple[Unevenness, ...] = Field(
        default=(), max_length=20, description="Parts of the unevenness of the running surface."
    )


def check_irregularities(
    line: Line, droppers: Droppers | tuple[Droppers, ...], irregularities: Irregularities
) -> list[Problem]:
    """Check that errors of installation fit the droppers and that bumps lie on the line."""
    problems = []
    installation = irregularities.installation
    if installation is not None:
        at = ("irregularities", "installation")
        sets = droppers if isinstance(droppers, tuple) else (droppers,)
        if installation.of == "height" and any(one.mode == "length" for one in sets):
            text = "got 'height', but droppers.mode 'length' prescribes lengths; use of: length"
            problems.append(Problem((*at, "of"), text))
        if isinstance(droppers, Droppers):
            problems += _check_values(line, droppers, installation.values)
        elif installation.values is not None:
            text = "needs a single set of droppers; with several sets draw the errors"
            problems.append(Problem((*at, "values"), text))
    for index, part in enumerate(irregularities.unevenness):
        if part.position is not None and part.position > line.length():
            text = f"got {part.position:g} m; the line is {line.length():g} m long"
            problems.append(Problem(("irregularities", "unevenness", index, "position"), text))
    return problems


def _check_values(
    line: Line, droppers: Droppers, values: tuple[float, ...] | tuple[tuple[float, ...], ...] | None
) -> list[Problem]:
    """Check that a table of installation errors has one value per dropper."""
    if values is None:
        return []
    at = ("irregularities", "installation", "values")
    positions = droppers.positions_by_span(line.spans)
    rows = installation_values(values, line.spans)
    if len(rows) != line.spans or len(positions) != line.spans:
        text = f"has {len(rows)} lists for {line.spans} spans; give one list per span, or one list"
        return [Problem(at, text)]
    for span, (row, droppers_of_span) in enumerate(zip(rows, positions, strict=True), start=1):
        if len(row) != len(droppers_of_span):
            text = f"has {len(row)} values for the {len(droppers_of_span)} droppers of span {span}"
            return [Problem(at, text)]
    return []


def installation_values(
    values: tuple[float, ...] | tuple[tuple[float, ...], ...], spans: int
) -> tuple[tuple[float, ...], ...]:
    """Return the given installation errors [m], one tuple per span."""
    rows = tuple(item for item in values if isinstance(item, tuple))
    return rows or (tuple(item for item in values if not isinstance(item, tuple)),) * spans
