"""Texts that consoles and notebooks show as they are, and tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .results import Result, Run


class Text(str):
    """A text whose lines consoles and notebooks show."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self)}</pre>"


def run_summary(run: Run, level: float) -> Text:
    """The estimates of a run with their intervals and tests."""
    fit = "" if run.relative_error_percent is None else f", relative error {run.relative_error_percent:.2f} %"
    head = f"{run.method} ({run.case}): {run.status}{fit}, {run.measured.size or 'no'} torques, {len(run)} parameters"
    ends = [f"{100 * level:g} % from", "to"]
    rows = [["parameter", "unit", "estimate", "sd", "t", "P>|t|", *ends]]
    rows += [
        [name, unit, *map(_number, numbers)]
        for name, unit, *numbers in zip(
            run.names,
            [parameter.unit for parameter in run],
            run.estimates,
            run.standard_deviations,
            run.t_values,
            run.p_values,
            *run.conf_int(level).T,
            strict=True,
        )
    ]
    foot = f"t has {run.degrees_of_freedom:g} degrees of freedom; sd: errors correlated in time, differing between joints."
    return Text("\n".join([head, "", *_aligned(rows), "", "sd of your own covariance." if run.is_own else foot]))


def result_summary(result: Result, runs: Sequence[Run], level: float) -> Text:
    """Verdict, reasons and the estimates of runs."""
    head = [f"{result.to_dict()['title']}: verdict {result.verdict}", *(f"- {reason}" for reason in result.reasons)]
    return Text("\n\n".join(["\n".join(head), *(run_summary(run, level) for run in runs)]))


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.4g}"


def _aligned(rows: list[list[str]]) -> list[str]:
    """Rows in columns: names and units on the left, numbers on the right."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    lines = [
        "  ".join(cell.ljust(width) if k < 2 else cell.rjust(width) for k, (cell, width) in enumerate(zip(row, widths, strict=True)))
        for row in rows
    ]
    return [lines[0], "-" * len(lines[0]), *lines[1:]]
