"""Covariances, intervals, tests, residuals, summaries and predictions of results."""

import math

import numpy as np
import pytest

import thetahat as th


def test_the_covariance_belongs_to_the_deviations(result):
    for run in result:
        covariance = run.covariance
        assert covariance.shape == (len(run), len(run))
        np.testing.assert_array_equal(covariance, covariance.T)
        np.testing.assert_allclose(np.sqrt(np.diag(covariance)), run.standard_deviations, rtol=1e-9)
        assert np.linalg.eigvalsh(covariance)[0] > -1e-12 * np.trace(covariance)
    model = result.model
    assert model.covariance.shape == (len(model.names), len(model.names))


def test_intervals_have_any_level(result):
    run = result["idim-iv"]
    np.testing.assert_allclose(run.conf_int(), run.intervals_95, rtol=1e-6, atol=1e-12)
    np.testing.assert_array_equal(run.conf_int(0.9), run.conf_int(alpha=1 - 0.9))
    narrow, wide = run.conf_int(0.8), run.conf_int(0.99)
    assert np.all(wide[:, 0] < narrow[:, 0]) and np.all(narrow[:, 1] < wide[:, 1])
    with pytest.raises(ValueError, match="for 95 % give alpha=0.05"):
        run.conf_int(0.05)
    with pytest.raises(ValueError, match="probability"):
        run.conf_int(95)


def test_tests_agree_with_intervals(result):
    run = result["idim-ls"]
    # The noise is white: far more degrees of freedom than a handful.
    assert 20 < run.degrees_of_freedom < 10_000
    np.testing.assert_allclose(run.t_values, run.estimates / run.standard_deviations)
    contains_zero = np.prod(run.conf_int(0.95), axis=1) < 0
    np.testing.assert_array_equal(run.p_values > 0.05, contains_zero)


def test_your_own_estimator_has_the_normal_distribution(twin):
    def least_squares(regression):
        X, y = regression.X, regression.y
        return np.linalg.lstsq(X, y, rcond=None)[0], np.linalg.inv(X.T @ X)

    run = th.identify(twin.robot, twin.recording, estimators={"own": least_squares}, cutoff_hz=40, decimation=10)["own"]
    assert math.isinf(run.degrees_of_freedom)
    np.testing.assert_allclose(run.conf_int(), run.intervals_95, rtol=1e-6)
    assert np.all((run.p_values >= 0) & (run.p_values <= 1))
    without = th.Run({**run.to_dict(), "covariance": None}, (np.zeros(1), np.zeros((1, 2)), np.zeros((0, 0))))
    assert np.all(np.isnan(without.covariance))
    with pytest.raises(th.ResultsError, match="no curves"):
        _ = without.residuals


def test_residuals_are_measured_minus_predicted(result):
    run = result["idim-ls"]
    np.testing.assert_array_equal(run.residuals, run.measured - run.predicted)


def test_summaries_name_every_parameter(result):
    text = result.summary()
    assert all(name in text for name in result.best.names) and "verdict good" in text
    assert repr(text) == str(text) and text._repr_html_().startswith("<pre>")
    assert "99 % from" in result["idim-ls"].summary(0.99)
    assert "idim-ls (nominal)" in result.summary(run=result["idim-ls"])


def relative(predicted, torque):
    inside = slice(250, -250)
    return np.linalg.norm((predicted - torque)[inside]) / np.linalg.norm(torque[inside])


def test_recordings_are_predicted_at_their_samples(result):
    other = th.testing.twin(seconds=10, seed=7)
    log = other.recording
    assert relative(result.predict(log), other.motion.torque) < 0.01
    np.testing.assert_array_equal(result.model.predict(log), result.predict(log))
    assert relative(result.predict(log, run=result["idim-iv"]), other.motion.torque) < 0.01
    motion = other.motion
    arrays = motion.position, motion.velocity, motion.acceleration
    np.testing.assert_array_equal(result.model.predict(*arrays), result.predict(*arrays))


def test_predictions_follow_the_times_of_the_samples(result):
    other = th.testing.twin(seconds=10, seed=7)
    even = np.arange(10_000) / 1000
    time = even + np.random.default_rng(1).uniform(-2e-4, 2e-4, len(even))
    position = np.column_stack([np.interp(time, even, column) for column in other.motion.position.T])
    torque = np.column_stack([np.interp(time, even, column) for column in other.motion.torque.T])
    assert relative(result.predict(th.Recording(time=time, position=position)), torque) < 0.05
    with pytest.raises(th.RecordingError, match="do not increase"):
        result.predict(th.Recording(time=time[::-1], position=position))


def test_coarse_encoders_do_not_spoil_predictions(twin):
    coarse = th.testing.twin(seconds=10, seed=3, encoder_counts_per_turn=2**16)
    result = th.identify(coarse.robot, coarse.recording, cutoff_hz=40, decimation=10)
    # With the cut-off of the identification, 40 Hz, the error is 2.2 %.
    assert relative(result.predict(coarse.recording), coarse.motion.torque) < 0.01


def test_peaks_of_the_torque_are_predicted(result):
    robot, rate = result.robot, 1000
    moving = th.testing.reference(2, 8, rate)
    reference = moving * np.minimum(1.0, np.arange(8 * rate) / (2 * rate))[:, np.newaxis]
    motion = th.simulate(robot, reference, rate, controller=th.PD(bandwidth_hz=10, velocity_feed_forward=1))
    noise = np.random.default_rng(0).normal(0, 1e-6, motion.position.shape)
    log = th.Recording(sample_rate_hz=rate, position=motion.position + noise, torque=motion.torque)
    predicted = result.predict(log)
    # The velocity of the reference jumps at 2 s, and the torque by 90 N m within 3 ms: most of the 3.2 % lies there.
    assert relative(predicted, motion.torque) < 0.035
    elsewhere = abs(np.arange(8 * rate) - 2 * rate) > 10
    assert relative(predicted[elsewhere], motion.torque[elsewhere]) < 0.022


def test_positions_alone_are_no_motion(result):
    with pytest.raises(TypeError, match="needs a recording, or q, dq and ddq"):
        result.predict([0.0, 0.0])
    with pytest.raises(ValueError, match="number of channels is 1, expected 2"):
        result.predict(th.Recording(sample_rate_hz=1000, position=np.zeros(500)))


def test_figures_show_themselves(result):
    pytest.importorskip("matplotlib")
    assert result.plot_torques()._repr_png_().startswith(b"\x89PNG")
