"""The report of a fleet: tables, as a page that opens offline and as Markdown."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from ._fleet import Fleet, RobotResult
    from ._statistics import Estimate

# Largest number of rows of a table with one for each robot and parameter; all are in fleet.json.
_MOST = 100

# The mark by which the page is recognised.
GENERATOR = '<meta name="generator" content="thetahat">'

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 70rem; margin: 2rem auto; padding: 0 1rem; color: #1b1f24; }
table { border-collapse: collapse; margin: 0.5rem 0 2rem; }
th, td { padding: 0.2rem 0.8rem; text-align: right; border-bottom: 1px solid #d8dee4; font-variant-numeric: tabular-nums; }
th:first-child, td:first-child { text-align: left; }
.found td { font-weight: 600; background: #fff8e1; }
.scroll { overflow-x: auto; }
@media (prefers-color-scheme: dark) {
  body { background: #15181c; color: #e4e7eb; }
  th, td { border-color: #343a41; }
  .found td { background: #3a3214; }
}
"""


class _Table(NamedTuple):
    """A table with the text above it."""

    title: str
    text: str
    head: list[str]
    rows: list[tuple[bool, list[str]]]
    """Whether a row is a finding, and its cells."""


def html(fleet: Fleet) -> str:
    """The page."""
    head = f'<meta charset="utf-8">{GENERATOR}<meta name="viewport" content="width=device-width"><title>{_TITLE}</title>'
    return f'<!doctype html><html lang="en"><head>{head}<style>{_STYLE}</style></head><body>{body(fleet)}</body></html>\n'


def body(fleet: Fleet) -> str:
    """The page without its frame, for notebooks."""
    tables = "".join(_html_table(table) for table in _tables(fleet))
    items = "".join(f"<li>{escape(line)}</li>" for line in _summary(fleet))
    return f"<h1>{_TITLE}</h1><ul>{items}</ul>{tables}"


def markdown(fleet: Fleet) -> str:
    """The same as Markdown; findings have bold first cells."""
    items = "".join(f"- {line}\n" for line in _summary(fleet))
    return f"{HEADING}{items}\n" + "\n".join(_markdown_table(table) for table in _tables(fleet))


_TITLE = "The fleet"
# The first characters of the Markdown, by which it is recognised.
HEADING = f"# {_TITLE}\n\n"


def _summary(fleet: Fleet) -> list[str]:
    used = [session for session in fleet.sessions if session.is_used]
    robots = {session.robot for session in used}
    lines = [f"{len(used)} of {len(fleet.sessions)} sessions are compared, of {len(robots)} robots."]
    lines.append(_listed("Parameters that differ between robots", fleet.differing))
    lines.append(_listed("Parameters that change over time", fleet.changing))
    drifts = [f"{drift.name} of {drift.robot}" for drift in fleet.drifting]
    lines.append(_listed("Friction drift", drifts))
    lines.append(
        f"P-values are adjusted by Holm's method within each column: {len(fleet.parameters)} tests of parameters, "
        f"{len(fleet.drifts)} of drifts, {len(fleet.deviations)} of deviations. Findings are below {fleet.level:g}; "
        "each interval has 95 %."
    )
    return lines


def _listed(what: str, names: list[str]) -> str:
    if not names:
        return f"{what}: none."
    more = f", and {len(names) - 12} more" if len(names) > 12 else ""
    return f"{what}: {', '.join(names[:12])}{more}."


def _tables(fleet: Fleet) -> list[_Table]:
    tables = [
        _parameters(fleet),
        _of_robots(
            fleet,
            fleet.drifts,
            "Friction over time",
            "Slopes of each robot by weighted regression, per unit of the sessions' time.",
            "slope",
        ),
        _of_robots(
            fleet,
            fleet.deviations,
            "Robots compared with the others",
            "Distance of each robot's mean from the median of all.",
            "distance",
        ),
        _left_out(fleet),
    ]
    return [table for table in tables if table.rows]


def _parameters(fleet: Fleet) -> _Table:
    head = ["parameter", "unit", "mean", "95 % interval", "between robots p", "over time p", "common slope", "dispersion", "scatter p"]
    rows = []
    for p in fleet.parameters:
        adjusted = [p.between_robots_adjusted, p.over_time_adjusted, p.scatter_adjusted]
        cells = [p.name, p.unit, _number(p.mean.value), _interval(p.mean), _p(adjusted[0]), _p(adjusted[1])]
        cells += [_number(p.common_slope.value), _number(p.dispersion.factor), _p(adjusted[2])]
        rows.append((any(value < fleet.level for value in adjusted), cells))
    text = (
        "Dispersion is the scatter of sessions about their robot's line over their variances: above 1, variances are multiplied "
        "by it."
    )
    return _Table("Parameters", text, head, rows)


def _of_robots(fleet: Fleet, results: tuple[RobotResult, ...], title: str, text: str, what: str) -> _Table:
    shown = sorted(results, key=lambda result: (result.estimate.p_value, result.robot, result.name))[:_MOST]
    if len(results) > _MOST:
        text += f" The {_MOST} with the smallest p-values of {len(results)}; all are in fleet.json."
    rows = []
    for result in shown:
        cells = [result.robot, result.name, result.unit, _number(result.estimate.value), _interval(result.estimate)]
        rows.append((result.adjusted < fleet.level, [*cells, _p(result.adjusted)]))
    return _Table(title, text, ["robot", "parameter", "unit", what, "95 % interval", "p"], rows)


def _left_out(fleet: Fleet) -> _Table:
    left_out = [session for session in fleet.sessions if not session.is_used]
    rows = [
        (False, [s.robot, f"{s.time:g}", s.verdict, s.reasons[0] if s.reasons else "no estimate with an interval"])
        for s in left_out[:_MOST]
    ]
    return _Table("Sessions left out", "", ["robot", "time", "verdict", "reason"], rows)


def _html_table(table: _Table) -> str:
    head = "".join(f"<th>{escape(cell)}</th>" for cell in table.head)
    rows = "".join(_html_row(found, cells) for found, cells in table.rows)
    text = f"<p>{escape(table.text)}</p>" if table.text else ""
    return (
        f"<h2>{escape(table.title)}</h2>{text}<div class=\"scroll\"><table><thead><tr>{head}</tr></thead>"
        f"<tbody>{rows}</tbody></table></div>"
    )


def _html_row(found: bool, cells: list[str]) -> str:
    start = '<tr class="found">' if found else "<tr>"
    return start + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>"


def _markdown_table(table: _Table) -> str:
    lines = [_markdown_row(table.head), _markdown_row(["---"] * len(table.head))]
    for found, cells in table.rows:
        first = f"**{_plain(cells[0])}**" if found else _plain(cells[0])
        lines.append(_markdown_row([first, *map(_plain, cells[1:])]))
    text = f"{table.text}\n\n" if table.text else ""
    return f"## {table.title}\n\n{text}" + "".join(line + "\n" for line in lines)


def _markdown_row(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _plain(text: str) -> str:
    return " ".join(text.replace("|", "\\|").split())


def _interval(estimate: Estimate) -> str:
    return f"{_number(estimate.low)} to {_number(estimate.high)}" if math.isfinite(estimate.low) else ""


def _number(value: float) -> str:
    return f"{value:.4g}" if math.isfinite(value) else ""


def _p(value: float) -> str:
    if math.isnan(value):
        return ""
    return f"{value:.3f}" if value >= 0.001 else "< 0.001"
