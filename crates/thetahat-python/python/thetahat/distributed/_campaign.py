"""Campaigns: any worker runs any of the recordings."""

from __future__ import annotations

import os
from dataclasses import dataclass

from .. import _thetahat
from .._progress import Progress, reporting
from . import _engines
from ._engines import Engine
from ._jobs import CampaignPart, bench, run_missing
from ._store import Store, content_name

_PARTS = "parts"
_MANIFEST = "campaign.json"
_FILES = (_MANIFEST, "timing.parquet", "runs.parquet", "campaign.html")
# Recordings whose simulations run in parallel.
_RECORDS = 4


@dataclass(frozen=True)
class Campaign:
    """The result of a campaign; the rows are in ``runs.parquet`` in its folder."""

    place: str
    """The folder or prefix with ``runs.parquet``, ``timing.parquet``, ``campaign.html`` and ``campaign.json``."""
    runs: int
    """Number of runs: one for each recording, case and method."""
    converged: int
    """Number of runs that converged."""
    text: str
    """The tables that the command prints."""

    def __str__(self) -> str:
        return self.text


def campaign(
    path: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    starts: int | None = None,
    seeds: int | None = None,
    engine: Engine = "threads",
    workers: int | None = None,
    address: str | None = None,
    recordings_per_job: int = _RECORDS,
    retries: int = 3,
    progress: bool | Progress = False,
) -> Campaign:
    """Run a campaign on any engine: its ``runs.parquet`` has the bytes that ``thetahat campaign`` writes.

    An interrupted campaign of this function or of the command continues in its folder.

    Parameters
    ----------
    path : path
        The campaign file.
    out : path or str
        A folder that all workers can access, or ``s3://bucket/prefix``; new, or with runs of the same campaign.
    starts, seeds : int, optional
        Only this many of each.
    engine : {"threads", "dask", "ray"}
        Where jobs run.
    workers : int, optional
        Threads, or workers started on this machine; by default one for each processor.
    address : str, optional
        A running scheduler of Dask (``"tcp://host:8786"``) or cluster of Ray (``"auto"``), whose workers have thetahat installed.
    recordings_per_job : int
        Recordings of a job: the work lost if a worker is killed.
    retries : int
        How often a job may lose its worker; a Dask scheduler at `address` uses its own setting.
    progress : bool or callable
        True shows how many jobs are done; a callable receives the progress.

    Raises
    ------
    CampaignError
        With file, place and remedy.
    EngineError
        For an engine that is not installed, or loses its workers.
    """
    if recordings_per_job < 1:
        raise ValueError(f"recordings_per_job is {recordings_per_job}; at least one is needed")
    store, texts, limits = Store(out), _thetahat.campaign_texts(os.fspath(path)), (starts, seeds)
    with store.as_folder(*_FILES, parts=_PARTS) as folder, reporting(progress) as report_stage:
        own = bench(texts, starts)
        places = own.missing(texts, folder, limits)
        # Parts are useless without the file that describes them.
        store.send(folder, _MANIFEST)
        groups = [places[k : k + recordings_per_job] for k in range(0, len(places), recordings_per_job)]
        names = [f"{_PARTS}/{content_name('campaign', texts[1], *texts[3:], starts, group)}.parquet" for group in groups]
        jobs = [CampaignPart(store, name, texts, starts, group) for name, group in zip(names, groups, strict=True)]
        if jobs:
            with _engines.started(engine, workers, address, retries) as driver:
                for done in run_missing(driver, CampaignPart.work, jobs, store, _PARTS):
                    if report_stage is not None:
                        report_stage(f"{done} of {len(jobs)} jobs")
        store.bring_parts(folder, _PARTS)
        text, runs, converged, _ = _thetahat.finish_campaign(own, texts, folder, limits)
    return Campaign(str(store), runs, converged, text)
