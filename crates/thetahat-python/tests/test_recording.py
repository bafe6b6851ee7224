"""Recordings: arrays are those of the recording alone, and files are read as the command line reads them."""

import numpy as np
import pytest

import thetahat as th


@pytest.mark.parametrize("order", ["C", "F"])
def test_a_recording_does_not_change_with_the_arrays_of_the_caller(order):
    q = np.asarray(np.random.default_rng(0).normal(size=(100, 3)), order=order)
    before = q.copy()
    log = th.Recording(sample_rate_hz=100, position=q, torque=q[::-1], channels={"extra": q[:, 0]})
    q[:] = 5
    np.testing.assert_array_equal(log.position, before)
    np.testing.assert_array_equal(log.torque, before[::-1])
    np.testing.assert_array_equal(log.channels["extra"][:, 0], before[:, 0])
    with pytest.raises(ValueError, match="read-only"):
        log.position[0, 0] = 1


def test_read_only_arrays_are_not_copied():
    q = np.zeros((100, 3))
    view = q[10:]
    view.flags.writeable = False
    assert not np.shares_memory(th.Recording(sample_rate_hz=100, position=view).position, q)
    q.flags.writeable = False
    log = th.Recording(sample_rate_hz=100, position=q)
    assert np.shares_memory(log.position, q) and np.shares_memory(log[20:40].position, q)


def test_frames_of_pandas_are_arrays():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"t": np.arange(50) / 50, "a": np.arange(50.0), "b": np.ones(50)})
    log = th.Recording(time=frame["t"], position=frame[["a", "b"]], torque=frame[["b", "a"]])
    np.testing.assert_array_equal(log.position[:, 0], np.arange(50.0))
    assert log.torque.shape == (50, 2)


def test_lower_precision_is_converted_with_a_word():
    q = np.ones((10, 2), dtype=np.float32)
    with pytest.warns(th.PrecisionWarning, match="position is float32") as caught:
        log = th.Recording(sample_rate_hz=100, position=q)
    assert log.position.dtype == np.float64
    assert caught[0].filename == __file__
    assert th.Recording(sample_rate_hz=100, position=np.ones((10, 2), dtype=int)).position.dtype == np.float64
    for bad in [np.ones((10, 2), dtype=complex), np.array([["a"]]), np.array([[None]])]:
        with pytest.raises(TypeError, match="position must hold real numbers"):
            th.Recording(sample_rate_hz=100, position=bad)


def test_what_does_not_fit_is_refused():
    q = np.zeros((10, 2))
    with pytest.raises(th.RecordingError, match="needs its time or its sample_rate_hz"):
        th.Recording(position=q)
    with pytest.raises(th.RecordingError, match="torque has 9 samples and position has 10"):
        th.Recording(sample_rate_hz=1, position=q, torque=q[1:])
    with pytest.raises(th.RecordingError, match="reference has 1 columns and position has 2"):
        th.Recording(sample_rate_hz=1, position=q, reference=q[:, 0])
    with pytest.raises(ValueError, match="row for each sample"):
        th.Recording(sample_rate_hz=1, position=np.zeros((2, 2, 2)))


def test_times_are_brought_to_equal_steps(twin):
    log = twin.recording
    rng = np.random.default_rng(3)
    time = np.arange(len(log)) / 1000 + rng.uniform(-1e-4, 1e-4, len(log))
    even = np.arange(len(log)) / 1000
    resampled = [np.column_stack([np.interp(time, even, c) for c in a.T]) for a in (log.position, log.torque)]
    jittered = th.Recording(time=time, position=resampled[0], torque=resampled[1])
    estimates = [
        th.identify(twin.robot, recording, cutoff_hz=40, decimation=10)["idim-ls"] for recording in (log, jittered)
    ]
    assert np.max(np.abs(estimates[0].estimates - estimates[1].estimates) / estimates[0].standard_deviations) < 3
    falling = th.Recording(time=time[::-1], position=log.position, torque=log.torque)
    with pytest.raises(th.RecordingError, match="arrays"):
        th.identify(twin.robot, falling, cutoff_hz=40, decimation=10)


def test_a_reference_goes_along_with_the_times(twin):
    log = twin.recording
    shifted = th.Recording(
        time=np.arange(len(log)) / 1000, position=log.position, torque=log.torque, reference=log.reference
    )
    options = {"methods": ["idim-iv"], "controller": twin.controller, "cutoff_hz": 40, "decimation": 10}
    at_times, at_rate = (th.identify(twin.robot, r, **options)["idim-iv"].estimates for r in (shifted, log))
    np.testing.assert_allclose(at_times, at_rate, rtol=1e-6, atol=1e-9)


def write_log(twin, path):
    log = twin.recording
    table = np.column_stack([np.arange(len(log)) / 1000, log.position, log.torque])
    names = "time_s,position_1,position_2,torque_1,torque_2"
    np.savetxt(path, table, delimiter=",", header=names, comments="", fmt="%.17g")


def test_a_file_is_read_as_the_command_line_reads_it(twin, tmp_path):
    write_log(twin, tmp_path / "log.csv")
    log = th.read(tmp_path / "log.csv", robot=twin.robot)
    np.testing.assert_array_equal(log.position, twin.recording.position)
    np.testing.assert_array_equal(log.torque, twin.recording.torque)
    assert log.sample_rate_hz == pytest.approx(1000)
    result = th.identify(twin.robot, log, cutoff_hz=40, decimation=10)
    assert result["idim-ls"].relative_error_percent < 2


def test_files_that_cannot_be_read_are_refused(twin, tmp_path):
    with pytest.raises(th.RecordingError, match=r"absent\.csv"):
        th.read(tmp_path / "absent.csv", robot=twin.robot)
    (tmp_path / "log.csv").write_text("a,b\n1,2\n3,4\n")
    with pytest.raises(th.RecordingError):
        th.read(tmp_path / "log.csv", robot=twin.robot)
    with pytest.raises(th.RecordingError, match="no file"):
        th.read_all(robot=twin.robot)
