"""Long recordings as triangular factors, computed by any worker and merged as a tree."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass

from .. import _thetahat
from .._progress import Progress, reporting
from ..results import Result
from ..robot import Robot
from . import _engines
from ._data import stamps
from ._engines import Driver, Engine
from ._jobs import Merge, ReductionPart, Spans, run_missing
from ._store import Store, content_name

_Path = str | os.PathLike[str]
_PARTS = "parts"
_MERGED = "merged.reduction"
# Its first characters.
_MARK = "thetahat reduction "


@dataclass(frozen=True)
class Reduced:
    """A reduction: the data for least squares of all recordings."""

    place: str
    """The folder or prefix with ``merged.reduction``, the input of ``thetahat solve``."""
    parts: tuple[str, ...]
    """The files of its parts, in their order."""
    content: bytes
    """The content of ``merged.reduction``."""

    def solve(self) -> Result:
        """The estimates, as of ``thetahat solve``.

        Raises
        ------
        ReductionError
            If the experiment in the reduction cannot be used.
        """
        native, robot = _thetahat.solve(f"{self.place}/{_MERGED}", self.content)
        return Result(native, Robot(robot))


def reduce(
    experiments: _Path | Sequence[_Path],
    out: _Path,
    *,
    data: _Path | None = None,
    robot: _Path | None = None,
    stretch_s: float | None = None,
    instruments_from: _Path | None = None,
    engine: Engine = "threads",
    workers: int | None = None,
    address: str | None = None,
    fan_in: int = 8,
    retries: int = 3,
    progress: bool | Progress = False,
) -> Reduced:
    """Reduce recordings on any engine, one job each or one for each time segment, and merge the factors.

    The bytes depend on the experiments, their order, `stretch_s` and `fan_in`; not on engine, workers or order of execution. Parts of
    an earlier call are reused, unless their files have changed since.

    Parameters
    ----------
    experiments : path or sequence of path
        Experiment files whose recordings form one regression.
    out : path or str
        A folder that all workers can access, or ``s3://bucket/prefix``.
    data : path, optional
        The folder of the recordings, which all workers can access; by default that of each experiment file.
    robot : path, optional
        A robot description instead of the one in the experiments.
    stretch_s : float, optional
        Reduce segments of this many seconds separately, if a recording is too long for one worker. A segment is decimated like a
        separate recording, and has its own velocity below which a joint is near rest: estimates differ from those of
        the whole recording by the rows at its ends and near rest. Twins cannot be split.
    instruments_from : path, optional
        A ``results.json`` whose estimates simulate the instruments of IDIM-IV.
    fan_in : int
        Number of reductions that one job merges.
    engine, workers, address, retries, progress
        As for :func:`campaign`.

    Raises
    ------
    ExperimentError, RecordingError, ReductionError
        With file, place and remedy.
    EngineError
        For an engine that is not installed, or loses its workers.
    ReportError
        For a ``merged.reduction`` in `out` that was not written by thetahat.
    """
    if stretch_s is not None and not (math.isfinite(stretch_s) and stretch_s > 0):
        raise ValueError(f"stretch_s is {stretch_s}; it is a time above zero, or None")
    if fan_in < 2:
        raise ValueError(f"fan_in is {fan_in}; two reductions at least become one")
    paths = [experiments] if isinstance(experiments, (str, os.PathLike)) else list(experiments)
    if not paths:
        raise ValueError("no experiment is given")
    store = Store(out)
    store.require_ours({_MERGED: _MARK})
    with _engines.started(engine, workers, address, retries) as driver, reporting(progress) as report_stage:
        described = [_described(os.fspath(path), data, robot, instruments_from) for path in paths]
        jobs = _parts(driver, store, described, stretch_s)
        for done in run_missing(driver, ReductionPart.work, jobs, store, _PARTS):
            if report_stage is not None:
                report_stage(f"{done} of {len(jobs)} parts")
        merged = _merged(driver, store, [job.name for job in jobs], fan_in)
    content = store.read(merged)
    store.write(_MERGED, content)
    return Reduced(str(store), tuple(job.name for job in jobs), content)


@dataclass(frozen=True)
class _Described:
    """An experiment as jobs need it."""

    texts: _thetahat.ExperimentTexts
    data: str
    origin: str
    """A name derived from all inputs."""
    recordings: int
    instruments: dict[str, float] | None


def _described(path: str, data: _Path | None, robot: _Path | None, instruments_from: _Path | None) -> _Described:
    folder = os.path.abspath(os.path.dirname(path) if data is None else data)
    texts, files, recordings = _thetahat.experiment_texts(path, folder, None if robot is None else os.fspath(robot))
    instruments = None
    if instruments_from is not None:
        instruments = _thetahat.instruments_of(os.fspath(instruments_from), texts)
    origin = content_name("experiment", texts, stamps(files), instruments)
    return _Described(texts, folder, origin, recordings, instruments)


def _parts(
    driver: Driver, store: Store, described: list[_Described], stretch_s: float | None
) -> list[ReductionPart]:
    windows: list[list[list[tuple[float, float] | None]]]
    if stretch_s is None:
        windows = [[[None]] * one.recordings for one in described]
    else:
        spans = driver.all(Spans.work, [Spans(one.texts, one.data) for one in described])
        for one in (one for one, of_one in zip(described, spans, strict=True) if not of_one):
            raise ValueError(f"{one.texts[0]}: describes a twin, which cannot be split in time: leave out stretch_s")
        windows = [[stretches(span, stretch_s) for span in of_one] for of_one in spans]
    return [
        _part(store, one, recording, window)
        for one, of_one in zip(described, windows, strict=True)
        for recording, of_recording in enumerate(of_one)
        for window in of_recording
    ]


def _part(store: Store, one: _Described, recording: int, window: tuple[float, float] | None) -> ReductionPart:
    name = f"{_PARTS}/{content_name('reduction', one.origin, recording, window)}.reduction"
    return ReductionPart(store, name, one.texts, one.data, recording, window, one.instruments)


def stretches(span: tuple[float, float], stretch_s: float) -> list[tuple[float, float] | None]:
    """A time span in segments of about the same length, none longer than requested.

    Examples
    --------
    >>> stretches((0.0, 25.0), 10.0)
    [(0.0, 8.333333333333334), (8.333333333333334, 16.666666666666668), (16.666666666666668, 25.0)]
    """
    start, end = span
    count = max(1, math.ceil((end - start) / stretch_s))
    ends = [start + (end - start) * k / count for k in range(1, count)]
    return list(zip([start, *ends], [*ends, end], strict=True))


def _merged(driver: Driver, store: Store, names: list[str], fan_in: int) -> str:
    """Merges neighbours, level by level; returns the name of the result."""
    while len(names) > 1:
        groups = [names[k : k + fan_in] for k in range(0, len(names), fan_in)]
        named = [(group[0] if len(group) == 1 else _name(group), group) for group in groups]
        jobs = [Merge(store, name, group) for name, group in named if len(group) > 1]
        for _ in run_missing(driver, Merge.work, jobs, store, _PARTS):
            pass
        names = [name for name, _ in named]
    return names[0]


def _name(parts: list[str]) -> str:
    return f"{_PARTS}/{content_name('merge', parts)}.reduction"
