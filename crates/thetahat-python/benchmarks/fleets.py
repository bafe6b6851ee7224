"""What engines cost, and what they survive: the figures of docs/evidence/fleets.md.

    python crates/thetahat-python/benchmarks/fleets.py [overhead|campaign|killed|reduce|sizes|scale ...]

runs in the checkout, with two workers of each engine that is installed, all on this machine. Without a name everything is run.
"""

from __future__ import annotations

import contextlib
import heapq
import importlib.util
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator

import numpy as np

import thetahat as th
from thetahat import distributed
from thetahat.distributed import _engines, _statistics

CHECKOUT = pathlib.Path(__file__).resolve().parents[3]
WORKERS = 2
# Seeds of the campaigns: 64 records with 512 runs, and ten times as many.
SHORT, LONG = 16, 160
# Time that a store takes to keep an object, and to give one: usual figures of S3, which are not measured here.
STORE_S, READ_S = 0.05, 0.02


def engines() -> list[str]:
    installed = {"dask": "distributed", "ray": "ray"}
    return ["threads", *(name for name, module in installed.items() if importlib.util.find_spec(module))]


def nothing(job: object) -> None:
    """A job that does nothing."""


@contextlib.contextmanager
def clock() -> Iterator[list[float]]:
    taken: list[float] = []
    start = time.perf_counter()
    yield taken
    taken.append(time.perf_counter() - start)


def overhead() -> None:
    """Time of a job that does nothing, with the texts of a campaign as its input."""
    texts = tuple("x" * 2000 for _ in range(5))
    for engine in engines():
        with clock() as begun:
            context = _engines.started(engine, WORKERS, None, 3)
            driver = context.__enter__()
            list(driver.each(nothing, [texts] * 20))
        count = 2000
        with clock() as taken:
            list(driver.each(nothing, [texts] * count))
        print(f"overhead {engine}: {1e3 * taken[0] / count:.3f} ms for each of {count} jobs")
        with clock() as ended:
            context.__exit__(None, None, None)
        print(f"overhead {engine}: begun and first jobs {begun[0]:.2f} s, ended {ended[0]:.2f} s")


def campaign_file(folder: pathlib.Path, seeds: int) -> pathlib.Path:
    path = folder / "campaigns" / "runs.toml"
    path.parent.mkdir()
    for name in ("experiments", "robots"):
        shutil.copytree(CHECKOUT / name, folder / name)
    text = (CHECKOUT / "campaigns/two_joint.toml").read_text()
    path.write_text(text.replace("seeds = 2", f"seeds = {seeds}"))
    return path


def command(path: pathlib.Path, out: pathlib.Path) -> float:
    with clock() as taken:
        line = [sys.executable, "-m", "thetahat", "campaign", str(path), "--out", str(out), "--threads", str(WORKERS)]
        subprocess.run(line, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return taken[0]


def campaign() -> None:
    """5120 runs: the command, then every engine with one and two workers."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        path = campaign_file(folder, LONG)
        print(f"campaign, the command with {WORKERS} threads: {command(path, folder / 'command'):.2f} s")
        rows = (folder / "command/runs.parquet").read_bytes()
        for engine in engines():
            for workers in (1, WORKERS):
                out = folder / f"{engine}{workers}"
                with clock() as taken:
                    distributed.campaign(path, out, engine=engine, workers=workers)
                same = (out / "runs.parquet").read_bytes() == rows
                print(f"campaign {engine}, {workers} workers: {taken[0]:.2f} s with its beginning and end, same bytes: {same}")


def below() -> dict[int, str]:
    """Processes below this one, with their command lines."""
    lines = subprocess.check_output(["ps", "-eo", "pid,ppid,args", "--no-headers"], text=True).splitlines()
    rows = [line.split(None, 2) for line in lines]
    own, found, grown = {os.getpid()}, {}, True
    while grown:
        new = [(int(pid), args) for pid, parent, args in rows if int(parent) in own and int(pid) not in found]
        found.update(new)
        own |= {pid for pid, _ in new}
        grown = bool(new)
    return found


def wait(what: str, ready: Callable[[], object]) -> None:
    """Wait until it is so; a campaign that failed would never be."""
    end = time.monotonic() + 300
    while not ready():
        if time.monotonic() > end:
            raise TimeoutError(f"no {what} in 300 s")
        time.sleep(0.005)


def has_parts(parts: pathlib.Path, count: int) -> bool:
    return parts.is_dir() and len(list(parts.glob("*.parquet"))) >= count


def kill_one(engine: str, parts: pathlib.Path, killed: list[int]) -> None:
    wait("8 parts", lambda: has_parts(parts, 8))
    mark = {"dask": "spawn_main", "ray": "ray::work"}[engine]
    wait("worker", lambda: killed.extend([pid for pid, line in below().items() if mark in line][:1]) or killed)
    os.kill(killed[0], signal.SIGKILL)


def killed() -> None:
    """A worker, then the driver, killed in the middle of 512 runs."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        path = campaign_file(folder, SHORT)
        command(path, folder / "command")
        rows = (folder / "command/runs.parquet").read_bytes()
        for engine in engines()[1:]:
            out, pids = folder / engine, []
            killer = threading.Thread(target=kill_one, args=(engine, out / "parts", pids), daemon=True)
            killer.start()
            with clock() as taken:
                distributed.campaign(path, out, engine=engine, workers=WORKERS, recordings_per_job=1)
            killer.join()
            same = (out / "runs.parquet").read_bytes() == rows
            print(f"killed worker, {engine}: {len(pids)} killed, {taken[0]:.2f} s, same bytes: {same}")
        code = "import sys, thetahat as th\nif __name__ == '__main__': th.distributed.campaign(sys.argv[1], sys.argv[2], engine=sys.argv[3], workers=2, recordings_per_job=1)"
        script = folder / "driver.py"
        script.write_text(code)
        for engine in engines():
            out = folder / f"driver-{engine}"
            driver = subprocess.Popen(
                [sys.executable, str(script), str(path), str(out), engine], start_new_session=True, stderr=subprocess.DEVNULL
            )
            try:
                wait("24 parts", lambda: has_parts(out / "parts", 24))
            finally:
                driver.kill()
                driver.wait()
            time.sleep(2.0)  # Workers that lost their driver end.
            kept = len(list((out / "parts").glob("*.parquet")))
            told: list[str] = []
            with clock() as taken:
                distributed.campaign(path, out, engine=engine, workers=WORKERS, recordings_per_job=1, progress=told.append)
            same = (out / "runs.parquet").read_bytes() == rows
            print(f"killed driver, {engine}: {kept} of 64 records kept, then {told[-1]} in {taken[0]:.2f} s, same bytes: {same}")


def recorded(folder: pathlib.Path, count: int, seconds: float) -> list[pathlib.Path]:
    """Experiments with a recording each."""
    (folder / "arm.toml").write_text(th.testing.arm()._native.text())
    paths = []
    for number in range(count):
        log = th.testing.twin(seconds=seconds, seed=number).recording
        np.savez(folder / f"{number}.npz", q=log.position, tau=log.torque)
        text = (
            f"title = 'session {number}'\nrobot = 'arm.toml'\n[recording]\nsample_rate_hz = 1000\n"
            f"position = {{ file = '{number}.npz', columns = ['q'], unit = 'rad' }}\n"
            f"torque = {{ file = '{number}.npz', columns = ['tau'], unit = 'N m' }}\n"
            "[signal]\ncutoff_hz = 40\ndecimation = 10\n[estimation]\nmethods = ['idim-ls']\n"
        )
        paths.append(folder / f"{number}.toml")
        paths[-1].write_text(text)
    return paths


def reduce() -> None:
    """32 recordings of a minute, merged by eights."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        paths = recorded(folder, 32, 60.0)
        content = set()
        for engine in engines():
            for workers in (1, WORKERS):
                out = folder / f"{engine}{workers}"
                with clock() as taken:
                    found = distributed.reduce(paths, out, engine=engine, workers=workers)
                content.add(found.content)
                print(f"reduce {engine}, {workers} workers: {taken[0]:.2f} s for 32 recordings of 60000 samples, merged {len(found.content)} bytes")
        print(f"reduce: {len(content)} different contents")


def scattered(scatter: float, repeats: int = 10_000) -> None:
    """How often tests reject what is true, of fleets of 6 robots with 5 sessions each that scatter so many times as much as they say."""
    rng = np.random.default_rng(7)
    rejected = {"between robots": 0.0, "over time": 0.0, "drift": 0.0, "distance from the median": 0.0}
    for _ in range(repeats):
        lines = []
        for _ in range(6):
            s = rng.uniform(0.5, 2.0, 5)
            lines.append(_statistics.line_of(np.arange(5.0), 10.0 + scatter * s * rng.normal(size=5), s))
        dispersion = _statistics.dispersion_of(lines)
        rejected["between robots"] += _statistics.between_robots(lines, dispersion).p_value < 0.05
        rejected["over time"] += _statistics.over_time(lines, dispersion).p_value < 0.05
        rejected["drift"] += _statistics.slope(lines[0], dispersion).p_value < 0.05
        distances = _statistics.from_the_median(lines, dispersion)
        rejected["distance from the median"] += np.mean([distance.p_value < 0.05 for distance in distances])
    shares = ", ".join(f"{key} {100 * count / repeats:.1f} %" for key, count in rejected.items())
    print(f"sizes, sessions that scatter {scatter:g} times as they say, rejected at 5 %: {shares}")


def sizes(fleets: int = 30) -> None:
    """How often tests of fleets of twins reject what is true: 4 robots, 4 sessions of 8 s each."""
    scattered(1.0)
    scattered(3.0)
    arm = th.testing.arm()
    counts = {"between robots": [0, 0], "over time": [0, 0], "drift": [0, 0], "drift, adjusted": [0, 0]}
    with tempfile.TemporaryDirectory() as name:
        for number in range(fleets):
            sessions = [
                distributed.Session(
                    f"R{robot}", float(when), model=arm, settings={"cutoff_hz": 40, "decimation": 10},
                    recordings=th.testing.twin(seconds=8, seed=1000 * number + 10 * robot + when).recording,
                )
                for robot in range(4) for when in range(4)
            ]
            found = distributed.fleet(sessions, f"{name}/{number}", workers=WORKERS)
            p_values = {
                "between robots": [p.between_robots.p_value for p in found.parameters],
                "over time": [p.over_time.p_value for p in found.parameters],
                "drift": [d.estimate.p_value for d in found.drifts],
                "drift, adjusted": [min(d.adjusted for d in found.drifts)],
            }
            for key, values in p_values.items():
                counts[key][0] += sum(p < 0.05 for p in values)
                counts[key][1] += len(values)
    for key, (rejected, tests) in counts.items():
        print(f"sizes, {key}: {rejected} of {tests} rejected at 5 % ({100 * rejected / tests:.1f} %)")


def driver_costs() -> dict[str, float]:
    """What the driver does for each session, s, and what a session takes."""
    costs = {}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        paths = recorded(folder, 40, 20.0)
        sessions = [distributed.Session(f"R{k}", 0.0, experiment=path) for k, path in enumerate(paths)]
        from thetahat.distributed import _fleet, _store

        store = _store.Store(folder / "out")
        with clock() as taken:
            jobs = [_fleet._job(store, session, None) for session in sessions]
        costs["describe"] = taken[0] / len(jobs)
        with clock() as taken:
            for job in jobs:
                _fleet._SessionPart.work(job)
        costs["session"] = taken[0] / len(jobs)
        with clock() as taken:
            for _ in range(10):
                contents = store.read_all([job.name for job in jobs])
                found = [_fleet._result(job.session, content) for job, content in zip(jobs, contents, strict=True)]
        costs["read"] = taken[0] / (10 * len(jobs))
        rng = np.random.default_rng(0)
        one = found[0]
        pages = int(pathlib.Path("/proc/self/statm").read_text().split()[1])
        before = pages * resource.getpagesize()
        many = [
            distributed.SessionResult(
                f"R{robot}", float(when), "good", (), one.method,
                tuple(p._replace(estimate=p.estimate + p.standard_deviation * rng.normal()) for p in one.parameters),
            )
            for robot in range(500) for when in range(100)
        ]
        with clock() as taken:
            compared = distributed.compare(many)
        costs["compare"] = taken[0] / len(many)
        with clock() as taken:
            text = compared.to_json()
        costs["write"] = taken[0] / len(many)
        costs["json_bytes"] = len(text) / len(many)
        most = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        costs["memory_bytes"] = (most - before) / len(many)
        parts = [distributed.reduce(path, folder / f"r{k}").content for k, path in enumerate(paths[:8])]
        with clock() as taken:
            for _ in range(20):
                merged = th._thetahat.merge([(str(k), part) for k, part in enumerate(parts)])
        costs["merge_8"], costs["part_bytes"], costs["merged_bytes"] = taken[0] / 20, len(parts[0]), len(merged)
        costs["stored_bytes"] = len(store.read(jobs[0].name))
    return costs


def makespan(sessions: int, together: int, workers: int, seconds: float, driver_s: float) -> float:
    """Time of sessions that one driver hands to workers, so many together: a worker waits for the driver, works, and stores its parts."""
    # Times of sessions differ: log-normal, with a standard deviation of half the mean.
    spread = np.sqrt(np.log(1.0 + 0.25 / together))
    rng, mean = np.random.default_rng(0), together * seconds
    work = rng.lognormal(np.log(mean) - spread**2 / 2, spread, sessions // together) + together * STORE_S
    free = [0.0] * workers
    driver = last = 0.0
    for each in work.tolist():
        driver += driver_s
        end = max(heapq.heappop(free), driver) + each
        heapq.heappush(free, end)
        last = max(last, end)
    return last


def scale() -> None:
    """10 000 robots with 100 recordings each, by measured times of a job and simulated workers."""
    costs = driver_costs()
    for key, value in costs.items():
        print(f"scale, measured for a session, {key}: {value:.6g}")
    sessions = 1_000_000
    for seconds in (0.1, 10.0):
        for together, driver_s in ((1, 0.0006), (1, 0.0035), (100, 0.0035)):
            line = []
            for workers in (2, 64, 1024, 4096, 16384):
                taken = makespan(sessions, together, workers, seconds, driver_s)
                ideal = sessions * (seconds + STORE_S) / workers
                line.append(f"{workers}: {taken / 3600:.2f} h ({100 * ideal / taken:.0f} %)")
            what = f"sessions of {seconds:.3g} s, {together} a job, driver {1e3 * driver_s:g} ms a job"
            print(f"scale, {what}: {', '.join(line)}")
    alone = {key: sessions * costs[key] for key in ("describe", "read", "compare", "write")}
    print("scale, the driver alone: " + ", ".join(f"{key} {value / 60:.1f} min" for key, value in alone.items()))
    print(f"scale, objects of {1e3 * READ_S:g} ms each, 32 at a time: read in {sessions * READ_S / 32 / 60:.0f} min")
    merges = 10_000 * (13 + 2 + 1)
    print(f"scale, merges of 100 reductions of each robot by eights: {merges} jobs, {merges * costs['merge_8'] / 60:.1f} min of one worker")


def main() -> None:
    steps = {step.__name__: step for step in (overhead, campaign, killed, reduce, sizes, scale)}
    for name in sys.argv[1:] or steps:
        steps[name]()


if __name__ == "__main__":
    main()
