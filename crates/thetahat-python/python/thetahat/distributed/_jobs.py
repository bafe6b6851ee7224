"""The jobs of a worker. Each writes one file, named after the inputs of its content, and returns the name."""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, Protocol, TypeVar

from .. import _thetahat
from ._engines import Driver
from ._store import Store

_building = threading.Lock()


class CampaignPart(NamedTuple):
    """Recordings of a campaign, as rows in a Parquet file."""

    store: Store
    name: str
    texts: _thetahat.CampaignTexts
    starts: int | None
    places: list[_thetahat.Place]

    @staticmethod
    def work(job: CampaignPart) -> str:
        """Run the recordings."""
        job.store.write(job.name, bench(job.texts, job.starts).part(job.places))
        return job.name


def bench(texts: _thetahat.CampaignTexts, starts: int | None) -> _thetahat.Bench:
    """The shared data of all recordings, created once per process."""
    with _building:
        return _bench(texts, starts)


@functools.lru_cache(maxsize=4)
def _bench(texts: _thetahat.CampaignTexts, starts: int | None) -> _thetahat.Bench:
    return _thetahat.Bench(texts, starts)


class Spans(NamedTuple):
    """The times of an experiment's recordings."""

    texts: _thetahat.ExperimentTexts
    data: str

    @staticmethod
    def work(job: Spans) -> list[tuple[float, float]]:
        """Read the time spans of the recordings."""
        return [(start, end) for start, end in _thetahat.recording_spans(job.texts, job.data)]


class ReductionPart(NamedTuple):
    """A recording, or a time segment of it, as triangular factors."""

    store: Store
    name: str
    texts: _thetahat.ExperimentTexts
    data: str
    recording: int
    window_s: tuple[float, float] | None
    instruments: dict[str, float] | None

    @staticmethod
    def work(job: ReductionPart) -> str:
        """Reduce it."""
        content = _thetahat.reduce(job.texts, job.data, job.recording, job.window_s, job.instruments)
        job.store.write(job.name, content)
        return job.name


class Merge(NamedTuple):
    """Reductions that become one."""

    store: Store
    name: str
    parts: list[str]

    @staticmethod
    def work(job: Merge) -> str:
        """Merge them in their order."""
        content = _thetahat.merge([(name, job.store.read(name)) for name in job.parts])
        job.store.write(job.name, content)
        return job.name


class _Named(Protocol):
    """A job that writes a file of this name."""

    @property
    def name(self) -> str: ...


_Job = TypeVar("_Job", bound=_Named)


class _Several(NamedTuple):
    """Jobs that are submitted together, as submitting takes time."""

    function: Callable[[Any], str]
    jobs: list[Any]

    @staticmethod
    def work(job: _Several) -> list[str]:
        """Run them one after another."""
        return [job.function(each) for each in job.jobs]


def run_missing(
    driver: Driver, function: Callable[[_Job], str], jobs: list[_Job], store: Store, folder: str, together: int = 1
) -> Iterator[int]:
    """Run the jobs whose files do not exist yet, in groups; an iterator over the number of finished jobs."""
    there = store.names(folder)
    missing = [job for job in jobs if job.name not in there]
    done = len(jobs) - len(missing)
    yield done
    groups = (_Several(function, missing[k : k + together]) for k in range(0, len(missing), together))
    for _, names in driver.each(_Several.work, groups):
        store.require(names)
        done += len(names)
        yield done
