"""Through Python and through the command: the same results to the last bit."""

import json
import subprocess
import sys

import numpy as np
import pytest

import thetahat as th


def command(*arguments):
    return subprocess.run([sys.executable, "-m", "thetahat", *map(str, arguments)], capture_output=True, text=True)


def without_times(text):
    """Results without the wall-clock times of the runs."""
    results = json.loads(text)
    for run in results["runs"]:
        run.pop("seconds")
    if results["model"]:
        results["model"].pop("seconds")
    return results


def same_bytes(experiment, data, folder):
    done = command("identify", experiment, "--data", data, "--out", folder)
    assert done.returncode in (0, 1), done.stderr
    result = th.run(experiment, data=data)
    assert result.to_csv() == (folder / "parameters.csv").read_text()
    assert without_times(result.to_json()) == without_times((folder / "results.json").read_text())
    assert done.returncode == (result.verdict == "do-not-use")
    state = np.full(result.robot.n, 0.3)
    read = th.Result.read(folder / "results.json")
    np.testing.assert_array_equal(read.predict(state, state, state), result.predict(state, state, state))
    return result


def test_the_two_joint_arm(checkout, tmp_path):
    result = same_bytes(checkout / "experiments/two_joint.toml", checkout, tmp_path / "out")
    assert {run.case for run in result} == {"nominal", "gear_ratio_0.9"}


def test_the_recorded_axis(checkout, shared, tmp_path):
    result = same_bytes(checkout / "experiments/emps.toml", shared / "datasets", tmp_path / "out")
    assert result.robot.n == 1


def test_arrays_give_what_the_file_gives(tmp_path, twin):
    """An experiment on a file, and the same recording and settings through arrays."""
    (tmp_path / "arm.toml").write_text(twin.robot._native.text())
    log = twin.recording
    table = np.column_stack([log.position, log.torque])
    head = "position_1,position_2,torque_1,torque_2"
    np.savetxt(tmp_path / "log.csv", table, delimiter=",", header=head, comments="", fmt="%.17g")
    (tmp_path / "experiment.toml").write_text(
        'title = "x"\nrobot = "arm.toml"\n[recording]\nsample_rate_hz = 1000\n'
        'position = { file = "log.csv", columns = ["position_1", "position_2"], unit = "rad" }\n'
        'torque = { file = "log.csv", columns = ["torque_1", "torque_2"], unit = "N m" }\n'
        "[signal]\ncutoff_hz = 40\ndecimation = 10\n[estimation]\nmethods = ['idim-ls']\n"
    )
    from_file = th.run(tmp_path / "experiment.toml")
    arrays = th.Recording(sample_rate_hz=1000, position=log.position, torque=log.torque)
    assert th.identify(twin.robot, arrays, cutoff_hz=40, decimation=10).to_csv() == from_file.to_csv()


def test_a_remedy_is_applied(tmp_path, twin):
    """The torques exchanged: the remedy writes the next version of the file, whose results are right."""
    (tmp_path / "arm.toml").write_text(twin.robot._native.text())
    table = np.column_stack([twin.recording.position, twin.recording.torque])
    head = "position_1,position_2,torque_1,torque_2"
    np.savetxt(tmp_path / "log.csv", table, delimiter=",", header=head, comments="", fmt="%.17g")
    text = (
        'title = "x"\nrobot = "arm.toml"\n[recording]\nsample_rate_hz = 1000\n'
        'position = { file = "log.csv", columns = ["position_1", "position_2"], unit = "rad" }\n'
        'torque = { file = "log.csv", columns = ["torque_1", "torque_2"], unit = "N m" }\n'
        "[signal]\ncutoff_hz = 40\ndecimation = 10\n[estimation]\nmethods = ['idim-ls']\n"
    )
    (tmp_path / "right.toml").write_text(text)
    (tmp_path / "experiment.toml").write_text(text.replace('"torque_1", "torque_2"', '"torque_2", "torque_1"'))
    result = th.run(tmp_path / "experiment.toml")
    assert result.verdict == "do-not-use"
    assert "joints-swapped-1-2" in [remedy["code"] for remedy in result.remedies]
    path = result.apply("joints-swapped-1-2", out=tmp_path / "experiment.2.toml")
    mended = th.run(path)
    assert mended.to_csv() == th.run(tmp_path / "right.toml").to_csv()
    with pytest.raises(FileExistsError):
        result.apply("joints-swapped-1-2", out=path)
    with pytest.raises(th.ExperimentError, match="joints-swapped-1-2"):
        result.apply("lag", out=tmp_path / "other.toml")
    arrays = th.identify(twin.robot, twin.recording, cutoff_hz=40, decimation=10)
    with pytest.raises(th.ResultsError, match="of arrays"):
        arrays.apply("lag", out=tmp_path / "other.toml")


def test_the_command_says_what_is_wrong(tmp_path):
    assert command("--version").stdout == f"thetahat {th.__version__}\n"
    done = command("identify", tmp_path / "absent.toml")
    assert done.returncode == 2 and "absent.toml: cannot be read" in done.stderr
    with pytest.raises(th.ExperimentError, match=r"absent\.toml: cannot be read"):
        th.run(tmp_path / "absent.toml")
    assert command("identfy").returncode == 2
