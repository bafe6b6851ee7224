"""Signals, regression, estimators and simulation, piece by piece."""

import numpy as np
import pytest

import thetahat as th


def test_the_pieces_put_together_are_the_whole(twin):
    log = twin.recording
    signal = {"mask": "none", "window_start_s": 1.0, "window_end_s": 9.0}
    result = th.identify(twin.robot, log, cutoff_hz=40, decimation=10, signal=signal)
    window = slice(1000, 9000)
    motion = [array[window] for array in th.band_pass(log.position, 1000, 40)]
    X = th.observation_matrix(twin.robot, *motion, decimation=10)
    y = th.measurement_vector(log.torque[window], decimation=10)
    fit = th.estimate("idim-ls", X, y, joints=2)
    run = result["idim-ls"]
    assert X.flags.f_contiguous and X.shape == (len(y), len(run.names))
    np.testing.assert_array_equal(fit.theta, run.estimates)
    np.testing.assert_array_equal(fit.standard_deviation_robust, run.standard_deviations)
    np.testing.assert_array_equal(fit.interval_95, run.intervals_95)


def test_an_estimator_of_ones_own_agrees():
    rng = np.random.default_rng(0)
    x, e = rng.normal(size=(500, 3)), rng.normal(size=500)
    y = x @ [1.0, -2.0, 0.5] + 0.1 * e
    fit = th.estimate("idim-ls", x, y)
    np.testing.assert_allclose(fit.theta, np.linalg.lstsq(x, y, rcond=None)[0], rtol=1e-12)
    variance = np.sum((y - x @ fit.theta) ** 2) / (500 - 3)
    np.testing.assert_allclose(fit.covariance, variance * np.linalg.inv(x.T @ x), rtol=1e-10)
    assert fit.interval_95.shape == (3, 2) and np.all(fit.interval_95[:, 0] < fit.interval_95[:, 1])
    z = x + 0.1 * rng.normal(size=x.shape)
    iv = th.estimate("idim-iv", x, y, z)
    np.testing.assert_allclose(iv.theta, np.linalg.solve(z.T @ x, z.T @ y), rtol=1e-10)
    weighted = th.estimate("idim-ls", x, y, weights=np.r_[np.full(250, 1e-9), np.ones(250)])
    np.testing.assert_allclose(weighted.theta, np.linalg.lstsq(x[250:], y[250:], rcond=None)[0], rtol=1e-6)


def test_a_regression_without_an_estimate_is_refused():
    x = np.ones((10, 2))
    with pytest.raises(th.EstimationError, match="separates only 1 of 2"):
        th.estimate("idim-ls", x, np.arange(10.0))
    with pytest.raises(th.EstimationError, match="needs instruments"):
        th.estimate("idim-iv", x, np.arange(10.0))
    with pytest.raises(th.SettingsError, match="unknown method `ols`"):
        th.estimate("ols", x, np.arange(10.0))
    with pytest.raises(ValueError, match="10 rows cannot be divided among 3 joints"):
        th.estimate("idim-ls", x, np.arange(10.0), joints=3)


def test_filters_keep_their_shape_and_leave_slow_motion_alone():
    t = np.arange(2000) / 1000
    slow = np.column_stack([np.sin(2 * np.pi * t), np.cos(2 * np.pi * t)])
    filtered = th.zero_phase(slow, 1000, 50)
    np.testing.assert_allclose(filtered[200:-200], slow[200:-200], atol=1e-6)
    assert th.zero_phase(slow[:, 0], 1000, 50).shape == (2000,)
    velocity = th.derivative(slow, 1000)
    np.testing.assert_allclose(velocity[10:-10, 0], 2 * np.pi * slow[10:-10, 1], rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(th.derivative(slow, 1000, kind="central"), np.gradient(slow, 1e-3, axis=0), rtol=1e-9)
    assert th.decimate(slow, 10).shape == (200, 2) and th.decimate(slow[:, 0], 7).shape == (286,)


def test_signals_that_cannot_be_filtered_are_refused():
    with pytest.raises(th.SignalError, match="Nyquist"):
        th.zero_phase(np.zeros(100), 100, 60)
    with pytest.raises(th.SignalError, match="at least 1"):
        th.decimate(np.zeros(100), 0)
    with pytest.raises(th.SignalError, match="13 are needed"):
        th.band_pass(np.zeros(5), 100, 10)
    with pytest.raises(ValueError, match="two samples"):
        th.derivative(np.zeros(1), 100)


def test_a_simulated_loop_follows_its_reference(twin):
    motion = twin.motion
    assert motion.position.shape == (10_000, 2) and motion.time[1] == 0.001
    assert np.max(np.abs(motion.position - twin.recording.reference)) < 0.01
    biased = th.simulate(
        twin.robot, twin.recording.reference, 1000, controller=twin.controller, bias={"gear_ratio": 0.9}
    )
    assert np.max(np.abs(biased.torque - motion.torque)) > 0.5
    with pytest.raises(th.SettingsError, match="bandwidth_hz has 3 entries"):
        th.simulate(twin.robot, twin.recording.reference, 1000, controller=th.PD(bandwidth_hz=[1, 2, 3]))
    with pytest.raises(th.SimulationError):
        th.simulate(
            twin.robot, twin.recording.reference, 1000,
            controller=th.PD(position_gain=-1e4, velocity_gain=-1e3),
        )


def test_twins_repeat_by_their_seed():
    first, again, other = (th.testing.twin(seconds=2, seed=seed).recording.torque for seed in (3, 3, 4))
    np.testing.assert_array_equal(first, again)
    assert np.any(first != other)
