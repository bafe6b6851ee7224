"""Campaigns of which any worker runs any records."""

from __future__ import annotations

import os
from dataclasses import dataclass

from .. import _thetahat
from .._progress import Progress, telling
from . import _engines
from ._engines import Engine
from ._jobs import CampaignPart, bench, run_missing
from ._store import Store, content_name

_PARTS = "parts"
_MANIFEST = "campaign.json"
_FILES = (_MANIFEST, "timing.parquet", "runs.parquet", "campaign.html")
# Records whose simulations run side by side.
_RECORDS = 4


@dataclass(frozen=True)
class Campaign:
    """What a campaign came to; the rows are in ``runs.parquet`` at its place."""

    place: str
    """The folder or prefix with ``runs.parquet``, ``timing.parquet``, ``campaign.html`` and ``campaign.json``."""
    runs: int
    """Runs, each a record, case and method."""
    converged: int
    """Those that converged."""
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
    records_per_job: int = _RECORDS,
    retries: int = 3,
    progress: bool | Progress = False,
) -> Campaign:
    """Run a campaign on any engine: its ``runs.parquet`` has the bytes that ``thetahat campaign`` writes.

    A folder of a campaign that was killed, by this function or by the command, is gone on with.

    Parameters
    ----------
    path : path
        The campaign file.
    out : path or str
        A folder that all workers see, or ``s3://bucket/prefix``; new, or with runs of this very campaign.
    starts, seeds : int, optional
        Only the first of each.
    engine : {"threads", "dask", "ray"}
        Where jobs are done.
    workers : int, optional
        Threads, or workers that are begun on this machine; without it as many as it has processors.
    address : str, optional
        A running scheduler of Dask (``"tcp://host:8786"``) or cluster of Ray (``"auto"``), whose workers have thetahat installed.
    records_per_job : int
        Records of a job: what is lost where a worker is killed.
    retries : int
        How often a job may lose its worker; of a Dask scheduler at `address` its own setting holds.
    progress : bool or callable
        True shows how many jobs are done; a callable is told.

    Raises
    ------
    CampaignError
        With file, place and remedy.
    EngineError
        For an engine that is not installed, or loses its workers.
    """
    if records_per_job < 1:
        raise ValueError(f"records_per_job is {records_per_job}; at least one is needed")
    store, texts, limits = Store(out), _thetahat.campaign_texts(os.fspath(path)), (starts, seeds)
    with store.as_folder(*_FILES, parts=_PARTS) as folder, telling(progress) as tell:
        own = bench(texts, starts)
        places = own.missing(texts, folder, limits)
        # Parts are nothing without the file that says what they are of.
        store.send(folder, _MANIFEST)
        groups = [places[k : k + records_per_job] for k in range(0, len(places), records_per_job)]
        names = [f"{_PARTS}/{content_name('campaign', texts[1], *texts[3:], starts, group)}.parquet" for group in groups]
        jobs = [CampaignPart(store, name, texts, starts, group) for name, group in zip(names, groups, strict=True)]
        if jobs:
            with _engines.started(engine, workers, address, retries) as driver:
                for done in run_missing(driver, CampaignPart.work, jobs, store, _PARTS):
                    if tell is not None:
                        tell(f"{done} of {len(jobs)} jobs")
        store.bring_parts(folder, _PARTS)
        text, runs, converged, _ = _thetahat.finish_campaign(own, texts, folder, limits)
    return Campaign(str(store), runs, converged, text)
