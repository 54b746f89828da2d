"""``limits``: what a passage is checked against, and a file of one's own to begin with."""

from __future__ import annotations

from pathlib import Path

from tautwire.assessment.limits import (
    Constant,
    Limit,
    Limits,
    ShareOfMean,
    SpeedCurve,
    limits_text,
    load_limits,
)
from tautwire.cli.session import Answer
from tautwire.cli.views.tables import heading, table
from tautwire.errors import InputError
from tautwire.files import write_text


def show_limits(answer: Answer, file: Path | None) -> None:
    """List limits with standard, clause and who compared them with its text."""
    limits = load_limits(file)
    answer.document["limits"] = [limit.model_dump(by_alias=True) for limit in limits.limits]
    rows = [
        (limit.name, _system(limit), _rule(limit), _standard(limit), _checked(limit))
        for limit in limits.limits
    ]
    heads = ("limit", "for", "value", "standard", "checked against it")
    answer.show(heading("Limits", str(file or "of the package")), table(heads, "LLLLL", rows))
    answer.show(heading("Next"), _next(limits, file))


def copy_limits(answer: Answer, path: Path, *, force: bool) -> None:
    """Write the limits of the package as a file to correct against a bought standard."""
    if path.suffix.lower() not in (".yaml", ".yml"):
        raise InputError(f"{path}: the copy is YAML; choose a name that ends in .yaml")
    if path.is_dir() or (path.exists() and not force):
        raise InputError(f"{path}: exists already; choose another name, or --force")
    write_text(path, limits_text())
    answer.document["file"] = str(path)
    answer.show(
        f"{path} written. Compare each limit with your copy of the standard, correct it, and set "
        f"verified, verified_by and verified_on; then: tautwire run CASE --limits {path}"
    )


def _next(limits: Limits, file: Path | None) -> str:
    open_ones = sum(not limit.verified for limit in limits.limits)
    if file is None:
        return "tautwire limits --copy our-limits.yaml    a file to correct, for --limits"
    return (
        f"{open_ones} of {len(limits.limits)} limits are not checked against the standard yet\n"
        f"tautwire run CASE --limits {file}"
    )


def _system(limit: Limit) -> str:
    applies = limit.applies
    systems = (applies.system,) if isinstance(applies.system, str) else applies.system or ("all",)
    bounds = (("above", applies.above), ("from", applies.from_), ("up to", applies.up_to),
              ("below", applies.below))  # fmt: skip
    speeds = [f"{word} {speed:g} km/h" for word, speed in bounds if speed is not None]
    return ", ".join([*systems, *speeds])


def _rule(limit: Limit) -> str:
    sign, rule = ("≤" if limit.sense == "maximum" else "≥"), limit.limit
    unit = "" if limit.unit == "1" else f" {limit.unit}"
    if isinstance(rule, Constant):
        return f"{sign} {rule.value:g}{unit}"
    if isinstance(rule, ShareOfMean):
        return f"{sign} {rule.factor:g} of the mean force"
    if isinstance(rule, SpeedCurve):
        return f"{sign} {rule.constant:g} + {rule.per_speed_squared:g} v²{unit}"
    return f"{sign} free space / {rule.divisor:g}"


def _standard(limit: Limit) -> str:
    return ", ".join(filter(None, (f"{limit.standard}:{limit.edition}", limit.clause)))


def _checked(limit: Limit) -> str:
    return f"{limit.verified_by}, {limit.verified_on}" if limit.verified else "no"
