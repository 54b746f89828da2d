"""The workshop sheet as words and as a workbook."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tautwire.analyses.design.workshop import WorkshopSheet, too_short
from tautwire.report.parts.blocks import Callout, Details, Heading, Section, Table, Text
from tautwire.report.parts.tables import places_of_droppers
from tautwire.report.parts.words import counted, listing, number
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.case import Case
from tautwire.tables.sheets import Cell
from tautwire.tables.writing import Row

MOST_ROWS = 400
"""Droppers of the page; the workbook has all of them."""
_DIGITS = 5
"""Decimals of lengths [m] in the workbook: a hundredth of what any shop can cut."""
_LENGTHS = ("between axes\nloaded [m]", "between axes\n[m]", "between clamps\n[m]", "cut [m]",
            "rounding [mm]", "force [N]", "force as cut [N]", "height as cut [mm]")  # fmt: skip


def workshop_section(case: Case, shape: Equilibrium, sheet: WorkshopSheet) -> Section:
    """Write the section of the workshop sheet."""
    blocks: list[object] = []
    if (short := too_short(sheet)).size:
        where = listing([_dropper(shape, row) for row in short[:5]])
        text = f"The clamps leave {counted(int(short.size), 'dropper')} no length: {where}."
        blocks.append(Callout((text,)))
    blocks += [Text(given_in_words(sheet)), Text(rounding_in_words(shape, sheet), "statement")]
    head, rows = _page_rows(case, shape, sheet)
    more = f", the first {MOST_ROWS}; the workbook has all" if len(rows) > MOST_ROWS else ""
    table = Table(
        f"Unstrained lengths unless loaded; height as cut: change of the wire below{more}.",
        head,
        "l" * (len(head) - len(_LENGTHS)) + "r" * len(_LENGTHS),
        tuple(rows[:MOST_ROWS]),
    )
    blocks += [Details(f"Dropper table ({len(rows)} droppers)", (table,)), Heading("Quantities")]
    blocks += quantity_tables(sheet)
    return Section("workshop", "Workshop sheet", tuple(blocks))


def given_in_words(sheet: WorkshopSheet) -> str:
    """Say what is deducted and added, and how droppers are cut."""
    given = sheet.given
    clamps = given.upper_clamp + given.lower_clamp
    deducted = (
        f"Deducted for the clamps: {1e3 * given.upper_clamp:g} mm above and "
        f"{1e3 * given.lower_clamp:g} mm below."
        if clamps
        else "No deduction for clamps is given (workshop.upper_clamp, workshop.lower_clamp), so "
        "lengths between clamps are those between the axes of the wires."
    )
    loops = f" Each loop takes {1e3 * given.loop:g} mm of rope." if given.loop else ""
    cut = f"rounded to {1e3 * given.step:g} mm" if given.step else "not rounded"
    return f"{deducted}{loops} Cut lengths are {cut}."


def rounding_in_words(shape: Equilibrium, sheet: WorkshopSheet) -> str:
    """Say what the rounding does to heights and dropper forces."""
    if not sheet.given.step or not shape.dropper_x.size:
        return "Nothing is rounded, so heights and forces are those of the design."
    up, load = (int(np.argmax(np.abs(v))) for v in (sheet.height_change, sheet.force_change))
    before, after, force = shape.dropper_forces, sheet.as_cut.dropper_forces, sheet.force_change
    slack = sheet.slack
    ends = (
        f" {counted(int(slack.size), 'dropper')} carries nothing: "
        f"{listing([_dropper(shape, row) for row in slack[:5]])}."
        if slack.size and before.min() > 0.0
        else ""
    )
    return (
        f"Rounding to {1e3 * sheet.given.step:g} mm moves the wire by at most "
        f"{1e3 * abs(sheet.height_change[up]):.2f} mm ({_dropper(shape, up)}) and changes a "
        f"dropper force by at most {abs(force[load]):.1f} N ({_dropper(shape, load)}): "
        f"{before.min():.1f} to {before.max():.1f} N become {after.min():.1f} to "
        f"{after.max():.1f} N.{ends}"
    )


def quantity_tables(sheet: WorkshopSheet) -> list[Table]:
    """Return the tables of quantities."""
    return [
        Table(
            "Wires from anchor to anchor, unstrained, without what ends and waste need.",
            ("wire", "tension length", "pieces", "length [m]", "mass [kg]"),
            "llrrr",
            tuple(
                (one.wire, one.tension_length, str(one.pieces), number(one.length, 2),
                 number(one.mass, 1))
                for one in sheet.wires
            ),
        ),
        Table(
            "Droppers by the wires between which they hang and by cut length.",
            ("from", "to", "cut length [m]", "droppers", "rope [m]"),
            "lllrr",
            tuple(
                (one.upper, one.lower, f"{one.begin:g} to below {one.end:g}", str(one.count),
                 number(one.rope, 2))
                for one in sheet.classes
            ),
        ),
        Table("Clamps and suspensions.", ("", "count"), "lr",
              tuple((name, str(count)) for name, count in sheet.clamps)),
    ]  # fmt: skip


def workshop_sheets(case: Case, shape: Equilibrium, sheet: WorkshopSheet) -> dict[str, list[Row]]:
    """Return the workshop sheet as sheets of a workbook.

    Its table of droppers is one that a case can name: read back, it gives the line as cut.
    """
    places = places_of_droppers(shape, case)
    columns: dict[str, Sequence[Cell]] = {
        **places,
        "unstrained length [m]": _rounded(sheet.axes),
        "axes, as computed [m]": _rounded(shape.dropper_lengths_unstrained),
        "axes, loaded [m]": _rounded(shape.dropper_lengths),
        "between clamps [m]": _rounded(sheet.cut - 2.0 * sheet.given.loop),
        "cut [m]": _rounded(sheet.cut),
        "cut, as computed [m]": _rounded(sheet.exact),
        "rounding [mm]": _rounded(1e3 * (sheet.cut - sheet.exact), 2),
        "force of the design [N]": _rounded(shape.dropper_forces, 2),
        "force as cut [N]": _rounded(sheet.as_cut.dropper_forces, 2),
        "height of the design [m]": _rounded(shape.dropper_heights),
        "change of height as cut [mm]": _rounded(1e3 * sheet.height_change, 3),
    }
    wires = quantity_tables(sheet)[0]
    return {
        "droppers": [tuple(columns), *zip(*columns.values(), strict=True)],
        "wire quantities": [
            wires.head,
            *((one.wire, one.tension_length, one.pieces, round(one.length, 3), round(one.mass, 2))
              for one in sheet.wires),
        ],
        "dropper quantities": [
            ("from", "to", "cut from [m]", "cut below [m]", "droppers", "rope [m]"),
            *((one.upper, one.lower, round(one.begin, 4), round(one.end, 4), one.count,
               round(one.rope, 3)) for one in sheet.classes),
        ],
        "clamps": [("what", "count"), *sheet.clamps],
        "notes": [
            ("note",),
            (given_in_words(sheet),),
            (rounding_in_words(shape, sheet),),
            (wires.caption,),
            ("'unstrained length' is that between the axes of the wires of a dropper as cut",),
        ],
    }  # fmt: skip


def _page_rows(
    case: Case, shape: Equilibrium, sheet: WorkshopSheet
) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    places = {name: told for name, told in places_of_droppers(shape, case).items()
              if name != "x [m]"}  # fmt: skip
    columns = [[_told(value) for value in told] for told in places.values()]
    numbers = (
        (shape.dropper_lengths, 4),
        (shape.dropper_lengths_unstrained, 4),
        (sheet.cut - 2.0 * sheet.given.loop, 4),
        (sheet.cut, 4),
        (1e3 * (sheet.cut - sheet.exact), 2),
        (shape.dropper_forces, 1),
        (sheet.as_cut.dropper_forces, 1),
        (1e3 * sheet.height_change, 2),
    )
    columns += [[number(value, digits) for value in values] for values, digits in numbers]
    return (*places, *_LENGTHS), list(zip(*columns, strict=True))


def _told(value: object) -> str:
    return f"{value:.3f}" if isinstance(value, float) else str(value)


def _rounded(values: np.ndarray, digits: int = _DIGITS) -> list[float]:
    return [round(value, digits) for value in values.tolist()]


def _dropper(shape: Equilibrium, row: int) -> str:
    return f"dropper {shape.dropper_number[row]} of span {shape.dropper_span[row]}"
