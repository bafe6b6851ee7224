"""Campaigns, reductions and fleets on every engine: the same bytes, whoever is killed."""

import datetime
import json
import os
import pickle
import shutil
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import thetahat as th
from thetahat import distributed
from thetahat.distributed import _campaign, _engines, _fleet, _statistics, _store

ENGINES = ["threads", "dask", "ray"]


def module_of(engine):
    """Skip where an engine is not installed."""
    if engine != "threads":
        pytest.importorskip({"dask": "distributed", "ray": "ray"}[engine])
    return engine


@pytest.fixture(scope="module")
def running():
    """Engines that run for all tests: what to give to each."""
    found = {}
    cluster = None
    try:
        yield lambda engine: found.get(engine) or found.setdefault(engine, begin(engine))
    finally:
        cluster = found.get("dask", {}).get("cluster")
        if cluster is not None:
            cluster.close()
        if "ray" in found:
            sys.modules["ray"].shutdown()


def begin(engine):
    module_of(engine)
    if engine == "dask":
        import distributed as dask_distributed

        local = {"host": "127.0.0.1", "dashboard_address": "127.0.0.1:0", "worker_dashboard_address": "127.0.0.1:0"}
        cluster = dask_distributed.LocalCluster(n_workers=2, threads_per_worker=1, **local)
        return {"cluster": cluster, "options": {"engine": "dask", "address": cluster.scheduler_address}}
    if engine == "ray":
        import ray

        ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, _node_ip_address="127.0.0.1")
    return {"options": {"engine": engine, "workers": 2}}


def command(*arguments):
    done = subprocess.run([sys.executable, "-m", "thetahat", *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    return done


@pytest.fixture(scope="module")
def described(checkout):
    return checkout / "campaigns/two_joint.toml"


@pytest.fixture(scope="module")
def rows(described, tmp_path_factory):
    """The rows that the command writes."""
    folder = tmp_path_factory.mktemp("command")
    command("campaign", described, "--out", folder)
    return (folder / "runs.parquet").read_bytes()


@pytest.mark.parametrize("engine", ENGINES)
def test_a_campaign_has_the_bytes_of_the_command(engine, running, described, rows, tmp_path):
    options = running(engine)["options"]
    told = []
    found = distributed.campaign(described, tmp_path, recordings_per_job=2, progress=told.append, **options)
    assert (tmp_path / "runs.parquet").read_bytes() == rows
    assert (found.runs, found.converged) == (64, 64) and "idim-iv" in found.text
    assert told[0] == "0 of 4 jobs" and told[-1] == "4 of 4 jobs"
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        ["campaign.html", "campaign.json", "parts", "runs.parquet", "timing.parquet"]
    )
    assert not list((tmp_path / "parts").iterdir())


@pytest.mark.parametrize(("workers", "records"), [(1, 1), (3, 5)])
def test_neither_workers_nor_jobs_change_rows(described, rows, tmp_path, workers, records):
    distributed.campaign(described, tmp_path, workers=workers, recordings_per_job=records)
    assert (tmp_path / "runs.parquet").read_bytes() == rows


def test_the_command_goes_on_where_a_part_of_a_campaign_is_done_and_the_other_way_round(described, rows, tmp_path):
    distributed.campaign(described, tmp_path / "a", seeds=1)
    command("campaign", described, "--out", tmp_path / "a")
    command("campaign", described, "--out", tmp_path / "b", "--seeds", "1")
    told = []
    distributed.campaign(described, tmp_path / "b", recordings_per_job=1, progress=told.append)
    assert told[0] == "0 of 4 jobs"
    for folder in "ab":
        assert (tmp_path / folder / "runs.parquet").read_bytes() == rows


def test_a_folder_of_another_campaign_is_refused(described, checkout, tmp_path):
    distributed.campaign(described, tmp_path, seeds=1, starts=1)
    with pytest.raises(th.CampaignError, match="holds runs of another campaign"):
        distributed.campaign(checkout / "campaigns/birdy.toml", tmp_path, seeds=1, starts=1)
    with pytest.raises(th.CampaignError, match=r"absent\.toml: cannot be read"):
        distributed.campaign(tmp_path / "absent.toml", tmp_path / "out")


def test_remedies_name_arguments_and_not_flags(described, tmp_path):
    (tmp_path / "campaign.html").write_text("a page of others")
    with pytest.raises(th.CampaignError, match="exists and is not a file of this kind that thetahat wrote; take another `out`$"):
        distributed.campaign(described, tmp_path)
    with pytest.raises(th.CampaignError, match="expected a folder, found a file; give another folder with `out`$"):
        distributed.campaign(described, tmp_path / "campaign.html")


@pytest.fixture
def followed(described, tmp_path):
    """A campaign whose twin follows a file, and a function that writes another motion into it."""
    path = slow_campaign(described, tmp_path)
    experiment = tmp_path / "experiments/two_joint.toml"
    reference = "reference = { file = 'motion.csv', columns = ['a', 'b'], unit = 'rad' }"
    lines = [reference if line.startswith("points") else line for line in experiment.read_text().splitlines()]
    experiment.write_text("\n".join(lines))

    def write(amplitude):
        times = np.arange(0, 4, 0.002)[:, np.newaxis]
        motion = amplitude * np.sin(times * [1.3, 2.1]) ** 3
        np.savetxt(experiment.with_name("motion.csv"), motion, delimiter=",", header="a,b", comments="")

    write(1.0)
    return path, write


def test_a_campaign_knows_the_motion_that_its_twin_follows(followed, tmp_path, monkeypatch):
    """The motion is in none of the campaign's texts: half of it must not be of another one."""
    path, write = followed
    # A relative path is that of the driver; workers may be elsewhere.
    monkeypatch.chdir(tmp_path)
    distributed.campaign(path.relative_to(tmp_path), tmp_path / "out", seeds=1, starts=1)
    texts = th._thetahat.campaign_texts(str(path.relative_to(tmp_path)))
    assert texts[0].is_absolute() and texts[2].is_absolute() and len(texts[5]) == 64
    first = (tmp_path / "out/runs.parquet").read_bytes()
    write(0.8)
    with pytest.raises(th.CampaignError, match=r"the file of \[twin\] reference is not what it was"):
        distributed.campaign(path, tmp_path / "out", seeds=2, starts=1)
    with pytest.raises(th.CampaignError, match="not the one that the campaign was begun with"):
        th._thetahat.Bench(texts, 1)
    assert (tmp_path / "out/runs.parquet").read_bytes() == first
    distributed.campaign(path, tmp_path / "other", seeds=1, starts=1)
    assert (tmp_path / "other/runs.parquet").read_bytes() != first


def slow_campaign(described, folder):
    """A campaign of 48 records, whose runs take a few seconds."""
    path = folder / "campaigns" / "slow.toml"
    path.parent.mkdir()
    for name in ("experiments", "robots"):
        shutil.copytree(described.parent.parent / name, folder / name)
    path.write_text(described.read_text().replace("seeds = 2", "seeds = 12"))
    return path


@pytest.fixture(scope="module")
def slow(described, tmp_path_factory):
    """A longer campaign, and its rows by threads."""
    folder = tmp_path_factory.mktemp("slow")
    path = slow_campaign(described, folder)
    distributed.campaign(path, folder / "out")
    return path, (folder / "out" / "runs.parquet").read_bytes()


def wait_for_parts(folder, count=2, seconds=60):
    """Wait until so many parts are there."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if folder.is_dir() and len([p for p in folder.iterdir() if p.suffix == ".parquet"]) >= count:
            return
        time.sleep(0.005)
    raise AssertionError(f"no {count} parts in {seconds} s")


def worker_pids(engine):
    """The processes below this one that do jobs."""
    psutil = pytest.importorskip("psutil")
    below = psutil.Process().children(recursive=True)
    lines = {process.pid: " ".join(process.cmdline()) for process in below if process.is_running()}
    if engine == "dask":
        return [pid for pid, line in lines.items() if "spawn_main" in line]
    return [pid for pid, line in lines.items() if line.startswith("ray::work")]


@pytest.mark.parametrize("engine", ["dask", "ray"])
def test_a_killed_worker_is_replaced_and_its_jobs_done_again(engine, slow, tmp_path):
    module_of(engine)
    path, rows = slow
    # Ray may run already, as Dask of another test may, whose workers do not count.
    before = set(worker_pids("dask"))
    killed = []

    def kill():
        wait_for_parts(tmp_path / "out" / "parts")
        end = time.monotonic() + 60
        while not killed and time.monotonic() < end:
            killed.extend([pid for pid in worker_pids(engine) if pid not in before][:1])
        for pid in killed:
            os.kill(pid, signal.SIGKILL)

    killer = threading.Thread(target=kill, daemon=True)
    killer.start()
    distributed.campaign(path, tmp_path / "out", engine=engine, workers=2, recordings_per_job=1)
    killer.join(timeout=60)
    assert killed
    assert (tmp_path / "out" / "runs.parquet").read_bytes() == rows


def test_a_killed_driver_goes_on_where_it_was(slow, tmp_path):
    path, rows = slow
    code = "import sys, thetahat as th; th.distributed.campaign(sys.argv[1], sys.argv[2], workers=2, recordings_per_job=1)"
    driver = subprocess.Popen([sys.executable, "-c", code, str(path), str(tmp_path)])
    try:
        wait_for_parts(tmp_path / "parts", count=5)
    finally:
        driver.kill()
        driver.wait()
    assert not (tmp_path / "runs.parquet").exists()
    kept = len([p for p in (tmp_path / "parts").iterdir() if p.suffix == ".parquet"])
    assert kept >= 5
    told = []
    distributed.campaign(path, tmp_path, recordings_per_job=1, progress=told.append)
    assert told[-1] == f"{48 - kept} of {48 - kept} jobs"
    assert (tmp_path / "runs.parquet").read_bytes() == rows


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """An experiment with three recordings, and experiments with one each."""
    folder = tmp_path_factory.mktemp("recorded")
    (folder / "arm.toml").write_text(th.testing.arm()._native.text())
    tables = []
    head = "position_1,position_2,torque_1,torque_2"
    for number in range(3):
        log = th.testing.twin(seconds=6, seed=number).recording
        table = np.column_stack([log.position, log.torque])
        np.savetxt(folder / f"{number}.csv", table, delimiter=",", header=head, comments="", fmt="%.12g")
        tables.append(
            f"[[recording]]\nsample_rate_hz = 1000\n"
            f"position = {{ file = '{number}.csv', columns = ['position_1', 'position_2'], unit = 'rad' }}\n"
            f"torque = {{ file = '{number}.csv', columns = ['torque_1', 'torque_2'], unit = 'N m' }}\n"
        )
    rest = "[signal]\ncutoff_hz = 40\ndecimation = 10\n[estimation]\nmethods = ['idim-ls']\n"
    for name, own in [("all", tables), *((str(k), [table]) for k, table in enumerate(tables))]:
        (folder / f"{name}.toml").write_text(f"title = '{name}'\nrobot = 'arm.toml'\n{''.join(own)}{rest}")
    return folder


@pytest.mark.parametrize("engine", ENGINES)
def test_a_reduction_has_the_bytes_of_the_command(engine, running, recorded, tmp_path):
    options = running(engine)["options"]
    paths = [recorded / f"{number}.toml" for number in range(3)]
    found = distributed.reduce(paths, tmp_path / "out", fan_in=2, **options)
    for number, path in enumerate(paths):
        command("reduce", path, "--out", tmp_path / f"{number}.reduction")
    files = [tmp_path / f"{number}.reduction" for number in range(3)]
    command("solve", *files, "--merged", tmp_path / "merged.reduction", "--out", tmp_path / "solved")
    assert (tmp_path / "out/merged.reduction").read_bytes() == found.content
    assert found.content == (tmp_path / "merged.reduction").read_bytes()
    result, solved = found.solve(), th.Result.read(tmp_path / "solved/results.json")
    np.testing.assert_array_equal(result["idim-ls"].estimates, solved["idim-ls"].estimates)
    np.testing.assert_array_equal(result["idim-ls"].intervals_95, solved["idim-ls"].intervals_95)


def test_a_solved_reduction_has_a_best_run(recorded, tmp_path):
    """Its advice is that of an identification by the methods that a reduction has."""
    result = distributed.reduce(recorded / "0.toml", tmp_path).solve()
    assert [a.recommended for a in result.advice] == ["idim-ls"] and result.best.method == "idim-ls"
    torques = result.predict([0.1, 0.2], [0.3, 0.4], [0.5, 0.6])
    assert torques.shape == (2,) and np.all(np.isfinite(torques))


def test_recordings_of_one_experiment_are_jobs_of_their_own(recorded, tmp_path):
    """Merged, they give what all recordings in one regression give."""
    found = distributed.reduce(recorded / "all.toml", tmp_path, workers=2)
    assert len(found.parts) == 3
    merged, whole = found.solve()["idim-ls"], th.run(recorded / "all.toml")["idim-ls"]
    np.testing.assert_allclose(merged.estimates, whole.estimates, rtol=1e-9)
    assert found.solve().robot.n == 2


def test_parts_are_found_again_unless_their_recording_changed(recorded, tmp_path):
    first = distributed.reduce(recorded / "all.toml", tmp_path)
    states = {path: path.stat().st_mtime_ns for path in (tmp_path / "parts").iterdir()}
    told = []
    again = distributed.reduce(recorded / "all.toml", tmp_path, progress=told.append)
    assert told == ["3 of 3 parts"] and again.content == first.content
    assert {path: path.stat().st_mtime_ns for path in (tmp_path / "parts").iterdir()} == states
    os.utime(recorded / "1.csv")
    distributed.reduce(recorded / "all.toml", tmp_path, progress=told.append)
    assert told[1] == "0 of 3 parts", "the experiment reads the file"


def test_stretches_of_time_are_nearly_the_whole(recorded, tmp_path):
    parts = distributed.reduce(recorded / "0.toml", tmp_path / "parts", stretch_s=2.5, workers=2)
    whole = distributed.reduce(recorded / "0.toml", tmp_path / "whole")
    assert len(parts.parts) == 3
    a, b = parts.solve()["idim-ls"], whole.solve()["idim-ls"]
    # At four inner ends the decimation's transients change some three rows of either joint, 2 % of 1150: estimates move by the root of
    # that in standard deviations, 0.14, and by three times as much at the most.
    assert np.max(np.abs(a.estimates - b.estimates) / b.standard_deviations) < 3 * np.sqrt(24 / 1150)
    with pytest.raises(ValueError, match="stretch_s is 0"):
        distributed.reduce(recorded / "0.toml", tmp_path, stretch_s=0)


def test_twins_have_no_stretches(checkout, tmp_path):
    with pytest.raises(ValueError, match=r"two_joint\.toml: describes a twin, .* leave out stretch_s"):
        distributed.reduce(checkout / "experiments/two_joint.toml", tmp_path, stretch_s=1.0)


def test_what_a_job_refuses_is_raised_as_everywhere(recorded, tmp_path):
    broken = (recorded / "0.toml").read_text().replace("0.csv", "absent.csv")
    (recorded / "broken.toml").write_text(broken)
    with pytest.raises(th.RecordingError, match=r"absent\.csv"):
        distributed.reduce([recorded / "1.toml", recorded / "broken.toml"], tmp_path)
    with pytest.raises(th.ReductionError, match="hold the same samples"):
        distributed.reduce([recorded / "0.toml", recorded / "0.toml"], tmp_path)
    assert not (tmp_path / "merged.reduction").exists()


@pytest.mark.parametrize("engine", ["dask", "ray"])
def test_errors_of_workers_are_those_of_threads(engine, running, recorded, tmp_path):
    options = running(engine)["options"]
    broken = (recorded / "0.toml").read_text().replace("0.csv", "absent.csv")
    (recorded / "broken.toml").write_text(broken)
    with pytest.raises(th.RecordingError, match=r"absent\.csv"):
        distributed.reduce(recorded / "broken.toml", tmp_path, **options)


def sessions_of(robots=3, times=4, seconds=10, change=lambda robot, time: {}):
    """Sessions of twins; `change` gives the parameters that differ."""
    arm = th.testing.arm()
    text = arm._native.text()
    for robot in range(robots):
        for when in range(times):
            changed = {**dict(zip(arm.parameter_names, arm.a_priori, strict=True)), **change(robot, when)}
            head = text.split("[parameters]")[0]
            lines = "".join(f"{name} = {float(value)!r}\n" for name, value in changed.items() if value)
            model = th.Robot.from_text(f"{head}[parameters]\n{lines}", name=f"robot {robot}")
            log = th.testing.twin(model, seconds=seconds, seed=100 * robot + when).recording
            yield distributed.Session(
                robot=f"R{robot}",
                time=float(when),
                model=arm,
                recordings=log,
                settings={"cutoff_hz": 40, "decimation": 10},
            )


@pytest.mark.parametrize("engine", ENGINES)
def test_a_fleet_has_the_same_bytes_on_any_engine(engine, running, tmp_path):
    options = running(engine)["options"]
    sessions = list(sessions_of(robots=2, times=2))
    found = distributed.fleet(sessions, tmp_path / "a", workers=1)
    other = distributed.fleet(reversed(sessions), tmp_path / "b", sessions_per_job=3, **options)
    assert found.to_json() == other.to_json()
    assert (tmp_path / "a/fleet.html").read_bytes() == (tmp_path / "b/fleet.html").read_bytes()
    parts = [sorted((path.name, path.read_bytes()) for path in (tmp_path / f / "sessions").iterdir()) for f in "ab"]
    assert parts[0] == parts[1] and len(parts[0]) == 4


def test_a_fleet_finds_drift_and_the_robot_that_differs(tmp_path):
    def change(robot, when):
        return {"fv1": 2.0 * (1 + 0.05 * when * (robot == 1)), "fc2": 0.4 + 0.1 * (robot == 2)}

    found = distributed.fleet(sessions_of(change=change), tmp_path)
    assert [(drift.robot, drift.name) for drift in found.drifting] == [("R1", "fv1")]
    drift = found.drifting[0].estimate
    assert drift.low < 0.1 < drift.high and drift.high - drift.low < 0.1
    assert "fc2" in found.differing and "fv1" in found.changing
    # The robot that drifts differs from the others too.
    far = {(d.robot, d.name): d.estimate for d in found.deviations if d.estimate.p_value < 1e-3}
    assert 0.05 < far["R2", "fc2"].value < 0.15
    told = []
    again = distributed.fleet(sessions_of(change=change), tmp_path, progress=told.append)
    assert told == ["12 of 12 sessions"] and again.to_json() == found.to_json()


def test_a_fleet_without_drift_has_none(tmp_path):
    found = distributed.fleet(sessions_of(), tmp_path)
    assert found.drifting == [] and found.changing == [] and found.differing == []
    truth = th.testing.arm().base_values()
    inside = [p.mean.low < truth[p.name] < p.mean.high for p in found.parameters]
    # Of 13 intervals of 95 %, four or more miss once in 300 fleets, were they independent.
    assert len(inside) == 13 and sum(inside) >= 10
    tests = [p.between_robots.p_value for p in found.parameters] + [p.over_time.p_value for p in found.parameters]
    # Of 26 tests at 5 %, six or more are rejected once in a thousand, were they independent.
    assert sum(p < 0.05 for p in tests) < 6


@pytest.mark.parametrize("scatter", [1.0, 3.0])
def test_tests_reject_what_is_true_as_often_as_they_say(scatter):
    """Of fleets whose sessions scatter as stated, or three times as much: 5 %, and never more than 7 %."""
    rng = np.random.default_rng(7)
    rejected, repeats = np.zeros(4), 1500
    for _ in range(repeats):
        lines = []
        for _ in range(6):
            s = rng.uniform(0.5, 2.0, 5)
            lines.append(_statistics.line_of(np.arange(5.0), 10.0 + scatter * s * rng.normal(size=5), s))
        dispersion = _statistics.dispersion_of(lines)
        tests = [_statistics.between_robots(lines, dispersion), _statistics.over_time(lines, dispersion)]
        p_values = [*(test.p_value for test in tests), _statistics.slope(lines[0], dispersion).p_value]
        distances = [distance.p_value < 0.05 for distance in _statistics.from_the_median(lines, dispersion)]
        rejected += [*(p < 0.05 for p in p_values), np.mean(distances)]
    *tested, from_the_median = rejected / repeats
    # Standard deviation of a share of 5 % among 1500: 0.56 %.
    assert all(0.02 < share < 0.07 for share in tested), tested
    # Variances are a little too large there: fewer are rejected than 5 %.
    assert 0.01 < from_the_median < 0.05, from_the_median


def test_holm_is_that_of_the_paper():
    assert _statistics.holm([0.01, 0.02, 0.03]) == [0.03, 0.04, 0.04]
    assert np.isnan(_statistics.holm([float("nan")])[0])


def test_reports_of_a_fleet_escape_what_they_show(tmp_path):
    sessions = [
        distributed.SessionResult("<b>|x", float(t), "good", (), "idim-ls", (distributed.ParameterEstimate("fv1", 1.0 + t, 0.1, "u"),))
        for t in range(3)
    ] + [distributed.SessionResult("other", 0.0, "refused", ("a | b",), "", ())]
    found = distributed.compare(sessions)
    assert "<b>" not in found.to_html() and "&lt;b&gt;" in found.to_html()
    assert "\\|x" in found.to_markdown() and "a \\| b" in found.to_markdown()
    assert found.drifting[0].estimate.value == pytest.approx(1.0)
    json.loads(found.to_json())
    found.report(tmp_path / "fleet.md")
    found.report(tmp_path / "page.html")
    assert (tmp_path / "fleet.md").read_text() == found.to_markdown()
    with pytest.raises(th.ReportError, match="there is no folder"):
        found.report(tmp_path / "absent" / "fleet.md")


@pytest.mark.parametrize("same", [True, False])
def test_robots_whose_parameters_stand_for_other_things_are_not_compared(same):
    """Two arms whose second links have other lengths: zz1r holds another part of m2."""
    formulas = ["zz1 + ia1 + 0.16*m2", "zz1 + ia1 + 0.16*m2" if same else "zz1 + ia1 + 0.25*m2"]
    sessions = [
        distributed.SessionResult(f"R{k}", 0.0, "good", (), "idim-ls", (distributed.ParameterEstimate("zz1r", 1.0, 0.1, "kg m^2", formula),))
        for k, formula in enumerate(formulas)
    ]
    if same:
        found = distributed.compare(sessions)
        assert found.parameters[0].expression == formulas[0] and found.differing == []
        return
    message = r"zz1r is zz1 \+ ia1 \+ 0\.16\*m2 \[kg m\^2\] of R0 at first, and zz1 \+ ia1 \+ 0\.25\*m2 .* make a fleet of each kind"
    with pytest.raises(th.RobotError, match=message):
        distributed.compare(sessions)
    left_out = [sessions[0], distributed.SessionResult("R1", 0.0, "do-not-use", (), "idim-ls", sessions[1].parameters)]
    assert len(distributed.compare(left_out).parameters) == 1


def test_formulas_of_sessions_are_compared(tmp_path):
    """Of an arm with a longer upper arm the formulas are others, though all names are the same."""
    arm = th.testing.arm()
    text = arm._native.text()
    assert "0.4" in text
    longer = th.Robot.from_text(text.replace("0.4", "0.5"))
    settings = {"cutoff_hz": 40, "decimation": 10}
    sessions = [
        distributed.Session(f"R{k}", model=model, recordings=th.testing.twin(model, seconds=8, seed=k).recording, settings=settings)
        for k, model in enumerate([arm, longer])
    ]
    with pytest.raises(th.RobotError, match="make a fleet of each kind"):
        distributed.fleet(sessions, tmp_path)


@pytest.mark.parametrize("when", [float("nan"), float("inf")])
def test_sessions_have_times(when):
    """A time that is no number would take the dispersion and the slopes away, without a word."""
    with pytest.raises(ValueError, match="session of R1: its time is"):
        distributed.Session("R1", time=when, experiment="e.toml")
    with pytest.raises(ValueError, match="session of R1: its time is"):
        distributed.SessionResult("R1", when, "good", (), "idim-ls", ())


def test_a_time_has_a_time_zone():
    naive = datetime.datetime(2026, 3, 1, 12)
    with pytest.raises(ValueError, match="has no time zone"):
        distributed.Session("R1", time=naive, experiment="e.toml")
    here = distributed.Session("R1", time=naive.replace(tzinfo=datetime.timezone.utc), experiment="e.toml")
    east = datetime.timezone(datetime.timedelta(hours=6))
    there = distributed.Session("R1", time=naive.replace(tzinfo=east), experiment="e.toml")
    assert here.days - there.days == pytest.approx(0.25, abs=1e-9)


def log_of(value):
    return th.Recording(sample_rate_hz=100, position=np.full((10, 2), value))


def test_recordings_among_settings_make_another_session():
    arm = th.testing.arm()

    def digest(**settings):
        return _fleet._digest(distributed.Session("R1", model=arm, recordings=log_of(0.0), settings=settings))

    assert digest(validation=log_of(1.0)) == digest(validation=log_of(1.0)) != digest(validation=log_of(2.0))
    assert digest(validation=[log_of(1.0), log_of(2.0)]) != digest(validation=[log_of(2.0), log_of(1.0)])
    assert digest(controller=th.PD(bandwidth_hz=10)) != digest(controller=th.PD(bandwidth_hz=20))
    assert digest(parameters={"fix": {"ia1": np.float64(0.1)}}) != digest(parameters={"fix": {"ia1": np.float64(0.2)}})
    with pytest.raises(TypeError, match="session of R1: its settings: they hold a builtin_function_or_method"):
        digest(progress=len)


def test_a_locked_joint_makes_another_session():
    """Two robots of one description are not the same session where a joint is locked elsewhere."""
    text = th.testing.arm()._native.text()
    log = th.Recording(sample_rate_hz=100, position=np.zeros((10, 1)))
    models = [th.Robot.from_text(text, locked={"elbow": angle}) for angle in (0.0, 0.5, 0.5)]
    digests = [_fleet._digest(distributed.Session("R1", model=model, recordings=log)) for model in models]
    assert digests[0] != digests[1] == digests[2]


def test_a_session_that_is_refused_is_listed_and_left_out(tmp_path):
    good = next(sessions_of(robots=1, times=1))
    one = good.recordings.position[:, :1]
    bad = distributed.Session("R9", model=good.model, recordings=th.Recording(sample_rate_hz=1000, position=one, torque=one), settings=good.settings)
    found = distributed.fleet([good, bad], tmp_path)
    refused = next(session for session in found.sessions if not session.is_used)
    assert refused.robot == "R9" and refused.verdict == "refused" and "expected 2" in refused.reasons[0]
    with pytest.raises(ValueError, match="give each only once"):
        distributed.fleet([good, good], tmp_path)
    with pytest.raises(ValueError, match="either an experiment, or a model"):
        distributed.Session("R1")


def test_a_recording_that_could_not_be_read_is_tried_again(recorded, tmp_path):
    """As where one worker's disk was away: what it could not read is no verdict on the session."""
    session, log = distributed.Session("R1", experiment=recorded / "2.toml"), recorded / "2.csv"
    away = log.rename(recorded / "away.csv")
    first = distributed.fleet([session], tmp_path)
    assert first.sessions[0].verdict == "refused" and "2.csv" in first.sessions[0].reasons[0]
    away.rename(log)
    # The name of the session's file follows from the recording, too: it is made as the worker would find it.
    job = _fleet._job(_store.Store(tmp_path), session, None)
    unread = next((tmp_path / "sessions").iterdir())
    unread.rename(tmp_path / job.unread_name)
    second = distributed.fleet([session], tmp_path)
    assert second.sessions[0].is_used
    told = []
    assert distributed.fleet([session], tmp_path, progress=told.append).to_json() == second.to_json()
    assert told == ["1 of 1 sessions"]


def test_a_method_that_there_is_not_is_refused_before_any_job(tmp_path):
    with pytest.raises(th.SettingsError, match="idim-vi"):
        distributed.fleet(sessions_of(robots=1, times=1), tmp_path, method="idim-vi")
    assert list(tmp_path.iterdir()) == []


class Found:
    """A result with this verdict, which takes this run of those that there are."""

    def __init__(self, verdict, reasons, taken=None, runs=()):
        self.verdict, self.reasons, self._run, self._runs = verdict, reasons, taken, dict(runs)

    def _recommended_run(self):
        return self._run

    def __contains__(self, method):
        return method in self._runs

    def __getitem__(self, method):
        return self._runs[method]


def test_a_session_without_a_method_to_take_keeps_its_verdict(result):
    kept = _fleet._kept(Found("do-not-use", ["gains are uncertain"]), None)
    assert (kept["verdict"], kept["reasons"], kept["parameters"]) == (
        "do-not-use",
        ["gains are uncertain", "no method has a usable estimate"],
        [],
    )
    diverged = th.Run({"case": "nominal", "method": "idim-iv", "status": "diverged", "reason": "the loop is unstable"}, ())
    kept = _fleet._kept(Found("good", ["rows are few"], None, {"idim-iv": diverged}), "idim-iv")
    assert (kept["reasons"], kept["method"]) == (["the loop is unstable", "rows are few"], "idim-iv")
    kept = _fleet._kept(result, "didim")
    assert (kept["verdict"], kept["reasons"][0]) == ("good", "didim is not among the methods of the session")
    assert [p[0] for p in _fleet._kept(result, None)["parameters"]] == result.best.names


def test_an_engine_that_is_not_installed_says_how_to_get_it(described, tmp_path, monkeypatch):
    for engine, module in [("dask", "distributed"), ("ray", "ray")]:
        monkeypatch.setitem(sys.modules, module, None)
        with pytest.raises(th.EngineError, match=rf'pip install "thetahat\[{engine}\]"'):
            distributed.campaign(described, tmp_path / engine, engine=engine)
    with pytest.raises(ValueError, match="expected 'threads', 'dask', 'ray'"):
        distributed.campaign(described, tmp_path / "x", engine="slurm")


def test_another_cluster_than_the_connected_one_is_refused(running, described, tmp_path):
    """Ray would take the connected one, without a word."""
    running("ray")
    with pytest.raises(th.EngineError, match=r"Ray already runs in this process, at .*, and not at 192\.0\.2\.1:6379: leave out"):
        distributed.campaign(described, tmp_path, engine="ray", address="192.0.2.1:6379")


def test_engines_are_imported_only_when_they_are_asked_for():
    modules = ["thetahat.distributed", "dask", "distributed", "ray", "pyarrow"]
    code = f"import sys, thetahat; print([m for m in {modules} if m in sys.modules], thetahat.distributed.Session.__name__)"
    assert subprocess.check_output([sys.executable, "-c", code], text=True).strip() == "[] Session"
    with pytest.raises(AttributeError, match="has no attribute 'distribute'"):
        th.distribute  # noqa: B018


class Growing:
    """An engine whose workers come while it works; jobs are done in order, one at a time."""

    def __init__(self):
        self.slots, self.most, self.pending = 1, 0, []

    def submit(self, function, job):
        self.pending.append(job)
        self.most = max(self.most, len(self.pending))
        return job

    def finished(self):
        self.slots = 32
        return [self.pending.pop(0)]

    def value(self, handle):
        return handle


def test_workers_that_join_later_get_jobs():
    pool = Growing()
    assert len(list(_engines.Driver(pool).each(None, range(500)))) == 500
    assert pool.most == 4 * 32


def test_workers_are_counted_now_and_then(monkeypatch):
    counts, clock = iter([1, 8]), [0.0]
    monkeypatch.setattr(_engines.time, "monotonic", lambda: clock[0])
    slots = _engines._Slots(lambda: next(counts))
    assert [slots(), slots()] == [1, 1]
    clock[0] = 2.0
    assert [slots(), slots()] == [8, 8]


@pytest.mark.parametrize(("engine", "address"), [("dask", "tcp://127.0.0.1:1"), ("dask", "nowhere"), ("ray", "127.0.0.1:1")])
def test_an_engine_that_does_not_answer_is_named_with_a_remedy(engine, address, described, tmp_path, monkeypatch):
    module_of(engine)
    if engine == "dask":
        import dask

        dask.config.set({"distributed.comm.timeouts.connect": "1s"})
    else:
        import ray

        # A cluster that is not there is looked for during a minute; what is tested is what becomes of Ray's error.
        monkeypatch.setattr(ray, "is_initialized", lambda: False)
        monkeypatch.setattr(ray, "init", lambda **_: (_ for _ in ()).throw(ConnectionError("no answer")))
    with pytest.raises(th.EngineError, match=rf"answers at {address} .*: start it, or leave out `address`"):
        distributed.campaign(described, tmp_path, engine=engine, address=address)


def test_jobs_are_taken_as_workers_get_free():
    taken = []

    def jobs():
        for number in range(100):
            taken.append(number)
            yield number

    with _engines.started("threads", 2, None, 0) as driver:
        values = driver.each(lambda number: number * number, jobs())
        next(values)
        assert len(taken) < 20
        assert sorted([0, *(value for _, value in values)])[-1] == 99 * 99


@pytest.mark.parametrize("name", ["fleet.json", "fleet.html", "merged.reduction"])
def test_files_of_others_are_not_replaced(name, recorded, tmp_path):
    (tmp_path / name).write_text("mine")
    with pytest.raises(th.ReportError, match=rf"{name}: exists and was not written by thetahat; take another place"):
        if name == "merged.reduction":
            distributed.reduce(recorded / "0.toml", tmp_path)
        else:
            distributed.fleet([distributed.Session("R1", experiment=recorded / "0.toml")], tmp_path)
    assert (tmp_path / name).read_text() == "mine" and len(list(tmp_path.iterdir())) == 1


def test_files_are_whole_or_not_there(tmp_path):
    store = pickle.loads(pickle.dumps(_store.Store(tmp_path)))
    store.write("a/b", b"1")
    store.write("a/b", b"22")
    assert store.read("a/b") == b"22" and store.names("a") == {"a/b"} and store.names("none") == set()
    assert [path.name for path in (tmp_path / "a").iterdir()] == ["b"]
    with pytest.raises(th.EngineError, match="workers have another folder"):
        store.require(["a/b", "a/c"])


@pytest.fixture(scope="module")
def bucket():
    """A server of S3 on this machine."""
    moto = pytest.importorskip("moto.server")
    boto3 = pytest.importorskip("boto3")
    pytest.importorskip("pyarrow.fs")
    server = moto.ThreadedMotoServer(ip_address="127.0.0.1", port=0)
    server.start()
    host, port = server.get_host_and_port()
    keys = {"AWS_ACCESS_KEY_ID": "none", "AWS_SECRET_ACCESS_KEY": "none"}
    before = {key: os.environ.get(key) for key in keys}
    os.environ.update(keys)
    boto3.client("s3", endpoint_url=f"http://{host}:{port}", region_name="us-east-1").create_bucket(Bucket="bucket")
    yield lambda prefix: f"s3://bucket/{prefix}?endpoint_override={host}:{port}&scheme=http&region=us-east-1"
    server.stop()
    for key, value in before.items():
        os.environ.pop(key, None) if value is None else os.environ.update({key: value})


def test_a_killed_driver_goes_on_from_its_objects(bucket, described, rows, checkout, monkeypatch):
    """It is killed before it puts the parts together, and so leaves what is there when a driver dies."""
    place, finish = bucket("killed"), th._thetahat.finish_campaign

    def die(*arguments):
        raise RuntimeError("killed")

    monkeypatch.setattr(th._thetahat, "finish_campaign", die)
    with pytest.raises(RuntimeError, match="^killed$"):
        distributed.campaign(described, place, seeds=1)
    monkeypatch.setattr(th._thetahat, "finish_campaign", finish)
    with pytest.raises(th.CampaignError, match="holds runs of another campaign"):
        distributed.campaign(checkout / "campaigns/birdy.toml", place)
    told = []
    distributed.campaign(described, place, recordings_per_job=1, progress=told.append)
    assert told[-1] == "4 of 4 jobs"
    assert _store.Store(place).read("runs.parquet") == rows


def test_objects_of_s3_are_kept_like_files(bucket, described, rows, recorded, tmp_path):
    place = bucket("campaign")
    distributed.campaign(described, place, seeds=1)
    distributed.campaign(described, place)
    store = _store.Store(place)
    assert store.read("runs.parquet") == rows and store.names("parts") == set()
    assert store.names("") == {f"/{name}" for name in _campaign._FILES}
    found = distributed.reduce(recorded / "all.toml", bucket("reduction"), fan_in=2)
    assert found.content == distributed.reduce(recorded / "all.toml", tmp_path, fan_in=2).content
    sessions = list(sessions_of(robots=2, times=1))
    fleet = distributed.fleet(sessions, bucket("fleet"))
    assert fleet.to_json() == distributed.fleet(sessions, tmp_path / "fleet").to_json()


def test_reports_of_a_fleet_replace_files_of_others_with_force_only(tmp_path):
    fleet = distributed.fleet(list(sessions_of(robots=2, times=1)), tmp_path / "out")
    for name in ("page.html", "page.md"):
        (tmp_path / name).write_text("mine")
        with pytest.raises(th.ReportError, match=f"{name}: exists and was not written"):
            fleet.report(tmp_path / name)
        assert (tmp_path / name).read_text() == "mine"
        fleet.report(tmp_path / name, force=True)
        fleet.report(tmp_path / name)


def test_a_fleet_reads_recordings_from_s3(bucket, recorded, tmp_path):
    """The experiments are here, and their recordings objects: what is found is what files give, and is found again."""

    def sessions(data, robots=2):
        of = [(f"R{k}", float(time), recorded / f"{k}.toml") for k in range(robots) for time in range(2)]
        return [distributed.Session(robot, time, experiment, data=data) for robot, time, experiment in of]

    logs = _store.Store(bucket("logs"))
    for number in range(2):
        logs.write(f"{number}.csv", (recorded / f"{number}.csv").read_bytes())
    files = distributed.fleet(sessions(None), tmp_path / "files")
    objects = distributed.fleet(sessions(logs.place), tmp_path / "objects")
    assert objects.to_json() == files.to_json() and len(objects.sessions) == 4
    assert all(session.parameters for session in objects.sessions)
    told = []
    distributed.fleet(sessions(logs.place), tmp_path / "objects", progress=told.append)
    assert told == ["4 of 4 sessions"]
    # Another object of that name is another recording.
    logs.write("0.csv", (recorded / "1.csv").read_bytes())
    changed = distributed.fleet(sessions(logs.place), tmp_path / "objects")
    assert [s.parameters for s in changed.sessions[:2]] == [s.parameters for s in changed.sessions[2:]]
    # One that is not there is the session's verdict, which names the object and no key, and is looked for again.
    missing = distributed.fleet(sessions(logs.place, robots=3), tmp_path / "objects").sessions[-1]
    assert missing.verdict == "refused" and missing.reasons[0].startswith("s3://bucket/logs/2.csv: cannot be read")
    assert "endpoint_override" not in missing.reasons[0]
    logs.write("2.csv", (recorded / "2.csv").read_bytes())
    assert distributed.fleet(sessions(logs.place, robots=3), tmp_path / "objects").sessions[-1].parameters
