"""Engines for jobs: threads of this process, workers of Dask, workers of Ray. Engines are imported on first use."""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import itertools
import os
import time
from collections.abc import Callable, Hashable, Iterable, Iterator
from concurrent import futures
from typing import Any, Literal, Protocol, TypeVar

from ..errors import EngineError

Engine = Literal["threads", "dask", "ray"]
_Job = TypeVar("_Job")
_Value = TypeVar("_Value")

# Jobs submitted ahead for each worker: enough that no worker waits for the driver.
_AHEAD = 4
# Time between counts of the workers of a running engine, s.
_COUNT_EVERY_S = 1.0


class _Pool(Protocol):
    """The interface of an engine."""

    @property
    def slots(self) -> int:
        """Jobs that run at a time; for a running engine it changes with its workers."""

    def submit(self, function: Callable[[Any], Any], job: Any) -> Hashable:
        """Submit a job."""

    def finished(self) -> list[Any]:
        """Wait for jobs that are done; returns their handles from :meth:`submit`."""

    def value(self, handle: Any) -> Any:
        """The result of a job; raises its exception."""

    def close(self) -> None:
        """Cancel jobs that are not done, and stop what the pool started."""


class Driver:
    """Submits jobs to an engine and collects their results."""

    def __init__(self, pool: _Pool) -> None:
        self._pool = pool

    def each(self, function: Callable[[_Job], _Value], jobs: Iterable[_Job]) -> Iterator[tuple[int, _Value]]:
        """Run jobs; yields their numbers from zero and results as they finish. The first error ends it.

        Jobs are submitted as workers become free or join, so there may be many.
        """
        waiting = enumerate(jobs)
        handles: dict[Hashable, int] = {}

        def hand_over(under_way: int) -> None:
            free = max(0, _AHEAD * self._pool.slots - under_way)
            for number, job in itertools.islice(waiting, free):
                handles[self._pool.submit(function, job)] = number

        hand_over(0)
        while handles:
            done = self._pool.finished()
            hand_over(len(handles) - len(done))
            for handle in done:
                yield handles.pop(handle), self._pool.value(handle)

    def all(self, function: Callable[[_Job], _Value], jobs: Iterable[_Job]) -> list[_Value]:
        """The results of jobs, in their order."""
        return [value for _, value in sorted(self.each(function, jobs), key=lambda pair: pair[0])]


@contextlib.contextmanager
def started(engine: Engine, workers: int | None, address: str | None, retries: int) -> Iterator[Driver]:
    """An engine for the duration of the context: a running one at `address`, or one on this machine."""
    if engine not in _ENGINES:
        raise ValueError(f"engine is {engine!r}; expected {', '.join(map(repr, _ENGINES))}")
    if workers is not None and workers < 1:
        raise ValueError(f"workers is {workers}; at least one is needed")
    pool = _ENGINES[engine](workers or os.cpu_count() or 1, address, retries)
    try:
        yield Driver(pool)
    finally:
        pool.close()


class _Slots:
    """The number of workers of an engine, cached for some time: each count is a call of the engine."""

    def __init__(self, count: Callable[[], int]) -> None:
        self._count = count
        self._number, self._counted_at = count(), time.monotonic()

    def __call__(self) -> int:
        if time.monotonic() - self._counted_at > _COUNT_EVERY_S:
            self._number, self._counted_at = self._count(), time.monotonic()
        return self._number


class _Threads:
    """Threads of this process; the compiled part releases the interpreter's lock."""

    def __init__(self, workers: int, address: str | None, retries: int) -> None:
        if address is not None:
            raise ValueError("threads are of this process: they have no address")
        self.slots = workers
        self._pool = futures.ThreadPoolExecutor(workers, thread_name_prefix="thetahat")
        self._pending: set[futures.Future[Any]] = set()

    def submit(self, function: Callable[[Any], Any], job: Any) -> Hashable:
        future = self._pool.submit(function, job)
        self._pending.add(future)
        return future

    def finished(self) -> list[Any]:
        done, self._pending = futures.wait(self._pending, return_when=futures.FIRST_COMPLETED)
        return list(done)

    def value(self, handle: Any) -> Any:
        return handle.result()

    def close(self) -> None:
        self._pool.shutdown(wait=False, cancel_futures=True)


class _Dask:
    """Workers of a Dask scheduler, or processes of this machine."""

    def __init__(self, workers: int, address: str | None, retries: int) -> None:
        dask, distributed = _module("dask", "dask"), _module("dask", "distributed")
        self._killed: type[Exception] = _module("dask", "distributed.scheduler").KilledWorker
        self._cluster: Any = None
        if address is None:
            with dask.config.set({"distributed.scheduler.allowed-failures": retries}):
                self._cluster = distributed.LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    processes=True,
                    host="127.0.0.1",
                    dashboard_address="127.0.0.1:0",
                    worker_dashboard_address="127.0.0.1:0",
                )
        with _connecting("scheduler of Dask", address):
            self._client: Any = distributed.Client(address or self._cluster, set_as_default=False)
        self._completed: Any = distributed.as_completed(loop=self._client.loop)
        self._slots = _Slots(lambda: sum(self._client.nthreads().values()) or workers)

    @property
    def slots(self) -> int:
        return self._slots()

    def submit(self, function: Callable[[Any], Any], job: Any) -> Hashable:
        # Jobs are not pure: each writes a file.
        future: Hashable = self._client.submit(function, job, pure=False)
        self._completed.add(future)
        return future

    def finished(self) -> list[Any]:
        batch: list[Any] = self._completed.next_batch()
        return batch

    def value(self, handle: Any) -> Any:
        try:
            return handle.result()
        except self._killed as lost:
            raise _lost() from lost

    def close(self) -> None:
        self._client.close()
        if self._cluster is not None:
            self._cluster.close()


class _Ray:
    """Workers of a Ray cluster, or processes of this machine."""

    def __init__(self, workers: int, address: str | None, retries: int) -> None:
        ray = self._ray = _module("ray", "ray")
        self._began = not ray.is_initialized()
        if not self._began:
            _require_same_ray(ray, address)
        elif address is None:
            ray.init(num_cpus=workers, include_dashboard=False, log_to_driver=False, _node_ip_address="127.0.0.1")
        else:
            with _connecting("cluster of Ray", address):
                ray.init(address=address, log_to_driver=False)
        self._retries = retries
        self._remote: dict[Callable[[Any], Any], Any] = {}
        self._pending: list[Any] = []
        self._slots = _Slots(lambda: int(ray.cluster_resources().get("CPU", workers)))

    @property
    def slots(self) -> int:
        return self._slots()

    def submit(self, function: Callable[[Any], Any], job: Any) -> Hashable:
        if function not in self._remote:
            self._remote[function] = self._ray.remote(max_retries=self._retries)(function)
        handle: Hashable = self._remote[function].remote(job)
        self._pending.append(handle)
        return handle

    def finished(self) -> list[Any]:
        self._ray.wait(self._pending, num_returns=1, fetch_local=False)
        done, self._pending = self._ray.wait(
            self._pending, num_returns=len(self._pending), timeout=0, fetch_local=False
        )
        return list(done)

    def value(self, handle: Any) -> Any:
        try:
            return self._ray.get(handle)
        except self._ray.exceptions.RayTaskError as error:
            raise error.cause or error from None
        except self._ray.exceptions.RayError as lost:
            raise _lost() from lost

    def close(self) -> None:
        for handle in self._pending:
            self._ray.cancel(handle)
        if self._began:
            self._ray.shutdown()


_ENGINES: dict[str, Callable[[int, str | None, int], _Pool]] = {"threads": _Threads, "dask": _Dask, "ray": _Ray}


def _module(engine: str, name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as missing:
        remedy = f'pip install "thetahat[{engine}]", or use engine="threads"'
        raise EngineError(f'the engine "{engine}" is not installed: {remedy}') from missing


def _require_same_ray(ray: Any, address: str | None) -> None:
    """Refuse another cluster than the connected one: Ray supports one at a time."""
    connected = ray.get_runtime_context().gcs_address
    if address not in (None, "auto", connected):
        raise EngineError(
            f"Ray already runs in this process, at {connected}, and not at {address}: leave out `address`, or call "
            "ray.shutdown() first"
        )


@contextlib.contextmanager
def _connecting(what: str, address: str | None) -> Iterator[None]:
    """Report the address that does not answer, for any error of the engine."""
    try:
        yield
    except (OSError, ValueError, RuntimeError, asyncio.TimeoutError) as error:
        if address is None:
            raise
        remedy = "start it, or leave out `address` for one on this machine"
        raise EngineError(f"no {what} answers at {address} ({error}): {remedy}") from error


def _lost() -> EngineError:
    return EngineError(
        "a job lost its worker as often as it may be tried again (`retries`): look at the memory of the workers, then call "
        "again; what is done is kept"
    )
