"""Many robots, each with many recordings: identified one by one, then compared."""

from __future__ import annotations

import datetime
import hashlib
import json
import math
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any, NamedTuple

import numpy as np

from .. import _thetahat
from .._progress import Progress, reporting
from ..controllers import Controller
from ..errors import RecordingError, ReportError, RobotError, ThetahatError
from ..identification import identify
from ..recording import Recording
from ..results import Result, Run
from ..robot import Robot
from . import _engines, _page, _statistics
from ._data import Data, described
from ._engines import Engine
from ._jobs import run_missing
from ._statistics import Dispersion, Estimate, Line, Test, holm
from ._store import Store, content_name, is_remote

_PARTS = "sessions"
# Version of the form of session files; it is part of their names.
_FORM = 2
# Extensions of session files: done, and recordings that could not be read.
_DONE, _UNREAD = ".json", ".unread.json"
_HTML, _JSON = "fleet.html", "fleet.json"
# The first characters of the second, by which it is recognised.
_JSON_HEAD = '{\n"thetahat": '
_DAY_S = 86_400.0
# Half width of a 95 % interval of a normal distribution, in standard deviations.
_NORMAL_95 = 1.959963984540054


@dataclass(frozen=True)
class Session:
    """Recordings of one robot at one time: an experiment file, or a robot with recordings.

    Parameters
    ----------
    robot : str
        The robot, such as its serial number.
    time : float or datetime
        The time in days, or in any unit that all sessions share; slopes are per this unit. A datetime has a time zone.
    experiment : path, optional
        An experiment file, as for :func:`thetahat.run`.
    data, description : path, optional
        The folder of its data, and another robot description: `data` and `robot` of :func:`thetahat.run`. The data may also be at
        ``s3://bucket/prefix``, with pyarrow's options after a question mark: a worker downloads the files of its session.
    model : Robot, optional
        Without an experiment: the robot, as for :func:`thetahat.identify`.
    recordings : Recording or sequence of Recording
        With `model`: the recordings.
    settings : mapping
        With `model`: the other arguments of :func:`thetahat.identify`.
    """

    robot: str
    time: float | datetime.datetime = 0.0
    experiment: str | os.PathLike[str] | None = None
    data: str | os.PathLike[str] | None = None
    description: str | os.PathLike[str] | None = None
    model: Robot | None = None
    recordings: Recording | Sequence[Recording] = ()
    settings: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if (self.experiment is None) == (self.model is None):
            raise ValueError(f"session of {self.robot}: give either an experiment, or a model with recordings")
        _require_time(self.robot, self.days)

    @property
    def days(self) -> float:
        """The time as a number."""
        if not isinstance(self.time, datetime.datetime):
            return float(self.time)
        if self.time.utcoffset() is None:
            raise ValueError(
                f"session of {self.robot}: its time {self.time} has no time zone; give one, such as tzinfo=datetime.timezone.utc"
            )
        return self.time.timestamp() / _DAY_S


def _require_time(robot: str, time: float) -> None:
    if not math.isfinite(time):
        raise ValueError(f"session of {robot}: its time is {time}; give a finite number, or a datetime")


class ParameterEstimate(NamedTuple):
    """An estimate of a session."""

    name: str
    estimate: float
    standard_deviation: float
    """Half width of the 95 % interval over 1.96, which includes the effect of few degrees of freedom; SI."""
    unit: str
    expression: str = ""
    """The formula of the base parameter; estimates of one name are compared only if all have the same."""


@dataclass(frozen=True)
class SessionResult:
    """The result of a session."""

    robot: str
    time: float
    verdict: str
    """The verdict of the identification, or ``"refused"`` if its input cannot be used."""
    reasons: tuple[str, ...]
    method: str
    """The method of the estimates; empty without any."""
    parameters: tuple[ParameterEstimate, ...]

    def __post_init__(self) -> None:
        _require_time(self.robot, self.time)

    @property
    def is_used(self) -> bool:
        """Whether its estimates are compared with others."""
        return bool(self.parameters) and self.verdict in ("good", "care")


@dataclass(frozen=True)
class ParameterResult:
    """A parameter in the whole fleet. ``adjusted`` p-values are Holm's, over the parameters."""

    name: str
    unit: str
    expression: str
    mean: Estimate
    dispersion: Dispersion
    between_robots: Test
    between_robots_adjusted: float
    over_time: Test
    over_time_adjusted: float
    scatter_adjusted: float
    common_slope: Estimate


@dataclass(frozen=True)
class RobotResult:
    """A parameter of one robot. ``adjusted`` p-values are Holm's, over robots and parameters."""

    robot: str
    name: str
    unit: str
    estimate: Estimate
    adjusted: float


@dataclass(frozen=True)
class Fleet:
    """The comparison of the sessions of a fleet."""

    place: str
    level: float
    """The level of the tests of adjusted p-values."""
    sessions: tuple[SessionResult, ...]
    parameters: tuple[ParameterResult, ...]
    drifts: tuple[RobotResult, ...]
    """Slopes of friction parameters over time for each robot, unit per unit of time."""
    deviations: tuple[RobotResult, ...]
    """Each robot's distance from the median of all."""

    @property
    def differing(self) -> list[str]:
        """Parameters that differ between robots."""
        return [p.name for p in self.parameters if p.between_robots_adjusted < self.level]

    @property
    def changing(self) -> list[str]:
        """Parameters that change over time."""
        return [p.name for p in self.parameters if p.over_time_adjusted < self.level]

    @property
    def drifting(self) -> list[RobotResult]:
        """Slopes that are not zero."""
        return [drift for drift in self.drifts if drift.adjusted < self.level]

    def to_json(self) -> str:
        """Everything as JSON; missing numbers are null. Formulas are stored with the parameters, once for all sessions."""
        lists = {"sessions": self.sessions, "parameters": self.parameters, "drifts": self.drifts, "deviations": self.deviations}
        text = f'{_JSON_HEAD}"{_thetahat.VERSION}",\n"level": {self.level}'
        for key, items in lists.items():
            lines = ",\n".join(json.dumps(_plain(item), allow_nan=False) for item in items)
            text += f',\n"{key}": [\n{lines}\n]'
        return text + "\n}\n"

    def to_markdown(self) -> str:
        """The report as Markdown."""
        return _page.markdown(self)

    def to_html(self) -> str:
        """The report as a page that opens offline."""
        return _page.html(self)

    def report(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write the report, as a page or, where the path ends with ``.md``, as Markdown.

        Parameters
        ----------
        path : str or path
            The file; a file that thetahat wrote is replaced.
        force : bool
            Whether to replace a file that thetahat did not write.

        Raises
        ------
        ReportError
            If it cannot be written, or the file exists and was not written by thetahat.
        """
        folder, name = os.path.split(os.path.abspath(os.fspath(path)))
        text, mark = (self.to_markdown(), _page.HEADING) if name.endswith(".md") else (self.to_html(), _page.GENERATOR)
        if not os.path.isdir(folder):
            raise ReportError(f"{os.fspath(path)}: cannot be written: there is no folder {folder}")
        store = Store(folder)
        if not force:
            store.require_ours({name: mark})
        store.write(name, text.encode())

    def _repr_html_(self) -> str:
        return _page.body(self)


class _SessionPart(NamedTuple):
    """A session for a worker."""

    store: Store
    name: str
    session: Session
    texts: _thetahat.ExperimentTexts | None
    data: Data
    method: str | None

    @property
    def unread_name(self) -> str:
        """The file with the reason why a recording could not be read: another call tries again."""
        return self.name.removesuffix(_DONE) + _UNREAD

    @staticmethod
    def work(job: _SessionPart) -> str:
        """Identify, and keep the estimates for the comparison."""
        name = job.name
        try:
            found = _kept(_identified(job), job.method)
        except ThetahatError as refused:
            found = {"verdict": "refused", "reasons": [str(refused)], "method": "", "parameters": []}
            name = job.unread_name if isinstance(refused, RecordingError) else job.name
        job.store.write(name, json.dumps(found).encode())
        return name


def _identified(job: _SessionPart) -> Result:
    if job.texts is not None:
        with job.data.as_folder() as folder:
            return _run(job.texts, job.data, folder)
    model = job.session.model
    assert model is not None
    # Jobs run in parallel: each has one thread.
    return identify(model, job.session.recordings, **{"threads": 1, **job.session.settings})


def _run(texts: _thetahat.ExperimentTexts, data: Data, folder: str) -> Result:
    """The results of an experiment; if it is refused, the message names the place of the data."""
    try:
        return Result(_thetahat.run_texts(texts, folder), None)
    except ThetahatError as refused:
        raise type(refused)(data.in_words(str(refused), folder)) from None


def _kept(result: Result, method: str | None) -> dict[str, Any]:
    run = _chosen(result, method)
    own = _own_reasons(run, method)
    return {
        "verdict": result.verdict,
        # Reasons for the requested method come before reasons for all.
        "reasons": result.reasons + own if method is None else own + result.reasons,
        "method": "" if run is None else run.method,
        "parameters": [] if run is None else _estimates(run),
    }


def _chosen(result: Result, method: str | None) -> Run | None:
    if method is None:
        return result._recommended_run()
    return result[method] if method in result else None


def _own_reasons(run: Run | None, method: str | None) -> list[str]:
    if run is not None:
        return [run.reason] if run.reason else []
    return ["no method has a usable estimate" if method is None else f"{method} is not among the methods of the session"]


def _estimates(run: Run) -> list[tuple[str, float, float, str, str]]:
    if run.status != "converged":
        return []
    known = ((p, p.interval_95) for p in run)
    return [
        (p.name, p.estimate, (ends[1] - ends[0]) / (2.0 * _NORMAL_95), p.unit, p.expression)
        for p, ends in known
        if ends is not None and ends[1] > ends[0]
    ]


def fleet(
    sessions: Iterable[Session],
    out: str | os.PathLike[str],
    *,
    method: str | None = None,
    friction: Sequence[str] = ("fv", "fc"),
    level: float = 0.05,
    engine: Engine = "threads",
    workers: int | None = None,
    address: str | None = None,
    sessions_per_job: int = 1,
    retries: int = 3,
    progress: bool | Progress = False,
) -> Fleet:
    """Identify every session of a fleet, and test which parameters differ between robots and over time.

    Estimates of a parameter are compared by Wald tests with their own robust variances, each parameter separately, as a session keeps no
    covariance between parameters. If sessions scatter about their robot's line by more than their variances predict, all variances of
    the parameter are multiplied by that factor, and tests are of F and t. P-values are adjusted by Holm's method: tests of the
    fleet over the parameters, tests of robots over robots and parameters. Intervals are of 95 % each, by itself.

    Sessions whose verdict is ``"do-not-use"``, or whose input is refused, are listed and left out; another call reads recordings again
    that could not be read.

    Parameters
    ----------
    sessions : iterable of Session
        The sessions.
    out : path or str
        A folder that all workers can access, or ``s3://bucket/prefix``: ``fleet.json``, ``fleet.html``, and a file for each session, which is
        reused if it exists.
    method : str, optional
        The method whose estimates are compared; by default the recommended method of each session.
    friction : sequence of str
        Prefixes of the names of the parameters whose drifts are listed for each robot.
    level : float
        The level of the tests.
    sessions_per_job : int
        Sessions per job: some tens for many workers and short sessions.
    engine, workers, address, retries, progress
        As for :func:`campaign`.

    Raises
    ------
    ExperimentError
        For an experiment file that cannot be read; if a worker refuses a session, that is its verdict.
    RobotError
        For a robot that cannot be read, and for a parameter that has another formula in another session.
    SettingsError
        For an unknown method.
    EngineError
        For an engine that is not installed, or loses its workers.
    ReportError
        For a ``fleet.json`` or ``fleet.html`` in `out` that was not written by thetahat.
    """
    if not 0.0 < level < 1.0:
        raise ValueError(f"level is {level}; it is between 0 and 1")
    if sessions_per_job < 1:
        raise ValueError(f"sessions_per_job is {sessions_per_job}; at least one is needed")
    if method is not None:
        _thetahat.require_method(method)
    store, asked = Store(out), list(sessions)
    if not asked:
        raise ValueError("no session is given")
    store.require_ours({_JSON: _JSON_HEAD, _HTML: _page.GENERATOR})
    jobs = [_job(store, session, method) for session in asked]
    if len({job.name for job in jobs}) < len(jobs):
        raise ValueError("two sessions are of the same robot, time and recordings: give each only once")
    with _engines.started(engine, workers, address, retries) as driver, reporting(progress) as report_stage:
        for done in run_missing(driver, _SessionPart.work, jobs, store, _PARTS, sessions_per_job):
            if report_stage is not None:
                report_stage(f"{done} of {len(jobs)} sessions")
    contents = store.read_all(_written(jobs, store.names(_PARTS)))
    found = [_result(job.session, content) for job, content in zip(jobs, contents, strict=True)]
    compared = compare(found, str(store), friction=friction, level=level)
    store.write(_JSON, compared.to_json().encode())
    store.write(_HTML, compared.to_html().encode())
    return compared


def compare(
    sessions: Sequence[SessionResult], place: str = "", *, friction: Sequence[str] = ("fv", "fc"), level: float = 0.05
) -> Fleet:
    """The tests of :func:`fleet` on identified sessions.

    Raises
    ------
    RobotError
        For a parameter that has another formula in another session.
    """
    ordered = sorted(sessions, key=lambda session: (session.robot, session.time))
    known = _known(ordered)
    units = {name: parameter.unit for name, parameter in known.items()}
    lines = _lines(ordered)
    dispersions = {name: _statistics.dispersion_of(list(of.values())) for name, of in lines.items()}
    drifts: list[tuple[str, str, Estimate]] = []
    deviations: list[tuple[str, str, Estimate]] = []
    for name, of in lines.items():
        if name.startswith(tuple(friction)):
            drifts += [(r, name, _statistics.slope(line, dispersions[name])) for r, line in of.items() if line.has_slope]
        if len(of) > 1:
            found = _statistics.from_the_median(list(of.values()), dispersions[name])
            deviations += [(robot, name, estimate) for robot, estimate in zip(of, found, strict=True)]
    return Fleet(
        place,
        level,
        tuple(ordered),
        _of_parameters(known, lines, dispersions),
        _of_robots(drifts, units),
        _of_robots(deviations, units),
    )


def _known(sessions: Sequence[SessionResult]) -> dict[str, ParameterEstimate]:
    """The first estimate of each parameter; refuses a fleet in which a name has two formulas."""
    known: dict[str, tuple[str, ParameterEstimate]] = {}
    for session in sessions:
        for parameter in session.parameters if session.is_used else ():
            robot, first = known.setdefault(parameter.name, (session.robot, parameter))
            if (parameter.expression, parameter.unit) != (first.expression, first.unit):
                raise RobotError(
                    f"{parameter.name} is {first.expression} [{first.unit}] of {robot} at first, and {parameter.expression} "
                    f"[{parameter.unit}] of {session.robot} at {session.time:g}: robots of other lengths, or with other parameters "
                    "left out or fixed, cannot be compared; make a fleet of each kind"
                )
    return {name: parameter for name, (_, parameter) in known.items()}


def _of_parameters(
    known: dict[str, ParameterEstimate], lines: dict[str, dict[str, Line]], dispersions: dict[str, Dispersion]
) -> tuple[ParameterResult, ...]:
    arguments = [(list(lines[name].values()), dispersions[name]) for name in known]
    between = [_statistics.between_robots(*pair) for pair in arguments]
    moving = [_statistics.over_time(*pair) for pair in arguments]
    between_adjusted = holm([test.p_value for test in between])
    moving_adjusted = holm([test.p_value for test in moving])
    scatter_adjusted = holm([dispersions[name].p_value for name in known])
    return tuple(
        ParameterResult(
            name=name,
            unit=known[name].unit,
            expression=known[name].expression,
            mean=_statistics.fleet_mean(*arguments[k]),
            dispersion=dispersions[name],
            between_robots=between[k],
            between_robots_adjusted=between_adjusted[k],
            over_time=moving[k],
            over_time_adjusted=moving_adjusted[k],
            scatter_adjusted=scatter_adjusted[k],
            common_slope=_statistics.common_slope(*arguments[k]),
        )
        for k, name in enumerate(known)
    )


def _of_robots(found: list[tuple[str, str, Estimate]], units: dict[str, str]) -> tuple[RobotResult, ...]:
    adjusted = holm([estimate.p_value for _, _, estimate in found])
    return tuple(
        RobotResult(robot, name, units[name], estimate, p)
        for (robot, name, estimate), p in zip(found, adjusted, strict=True)
    )


def _lines(sessions: Sequence[SessionResult]) -> dict[str, dict[str, Line]]:
    """The line of each robot, for each parameter."""
    points: dict[str, dict[str, list[tuple[float, float, float]]]] = {}
    for session in sessions:
        for parameter in session.parameters if session.is_used else ():
            point = (session.time, parameter.estimate, parameter.standard_deviation)
            points.setdefault(parameter.name, {}).setdefault(session.robot, []).append(point)
    line = _statistics.line_of
    return {name: {robot: line(*np.array(of).T) for robot, of in robots.items()} for name, robots in points.items()}


def _job(store: Store, session: Session, method: str | None) -> _SessionPart:
    if session.experiment is None:
        origin = content_name("arrays", _FORM, _digest(session), session.robot, session.days, method)
        return _SessionPart(store, f"{_PARTS}/{origin}{_DONE}", session, None, Data(""), method)
    path = os.fspath(session.experiment)
    data = os.path.dirname(path) if session.data is None else os.fspath(session.data)
    robot = None if session.description is None else os.fspath(session.description)
    found = described(path, data if is_remote(data) else os.path.abspath(data), robot)
    origin = content_name("session", _FORM, found.texts[1:], found.stamps, session.robot, session.days, method)
    return _SessionPart(store, f"{_PARTS}/{origin}{_DONE}", session, found.texts, found.data, method)


def _digest(session: Session) -> str:
    """A name of a session's arrays and settings."""
    assert session.model is not None
    recordings = [session.recordings] if isinstance(session.recordings, Recording) else session.recordings
    # The pickled form of a robot: its description, and the values of its locked joints.
    model = repr(session.model._native.__reduce__()[1])
    try:
        text = json.dumps([model, list(recordings), dict(session.settings)], sort_keys=True, default=_named)
    except TypeError as error:
        raise TypeError(f"session of {session.robot}: its settings: {error}") from None
    return hashlib.sha256(text.encode()).hexdigest()


def _named(value: object) -> object:
    """The JSON form of a value that JSON does not support."""
    if isinstance(value, Recording):
        return value._digest()
    if isinstance(value, Controller):
        return value.settings()
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError(f"they hold a {type(value).__name__}; expected numbers, texts, lists, mappings, controllers and recordings")


def _written(jobs: Sequence[_SessionPart], there: AbstractSet[str]) -> list[str]:
    """The files that jobs wrote."""
    return [job.name if job.name in there else job.unread_name for job in jobs]


def _result(session: Session, content: bytes) -> SessionResult:
    found = json.loads(content)
    return SessionResult(
        robot=session.robot,
        time=session.days,
        verdict=found["verdict"],
        reasons=tuple(found["reasons"]),
        method=found["method"],
        # Names, units and formulas are the same in all sessions: each is kept once.
        parameters=tuple(
            ParameterEstimate(sys.intern(name), estimate, deviation, sys.intern(unit), sys.intern(expression))
            for name, estimate, deviation, unit, expression in found["parameters"]
        ),
    )


def _plain(value: Any) -> Any:
    """The value in a form that JSON supports."""
    if isinstance(value, ParameterEstimate):
        return {key: _plain(each) for key, each in value._asdict().items() if key != "expression"}
    if is_dataclass(value):
        return {each.name: _plain(getattr(value, each.name)) for each in fields(value)}
    if hasattr(value, "_asdict"):
        return _plain(value._asdict())
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
