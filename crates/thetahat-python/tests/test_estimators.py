"""Estimators and torque terms of one's own inside an identification."""

import csv
import io
import json
import pickle

import numpy as np
import pytest

import thetahat as th


def least_squares(regression):
    return np.linalg.lstsq(regression.X, regression.y, rcond=None)[0]


def with_covariance(regression):
    """Least squares with the classical covariance."""
    theta = least_squares(regression)
    residual = regression.y - regression.X @ theta
    variance = residual @ residual / (round(np.sum(regression.share**2)) - len(theta))
    return theta, variance * np.linalg.inv(regression.X.T @ regression.X)


class LinearModel:
    """A linear model as scikit-learn has them."""

    def __init__(self, intercept=0.0):
        self.intercept = intercept

    def fit(self, X, y):
        assert not hasattr(self, "coef_"), "a model that was fitted before is fitted again"
        self.coef_ = np.linalg.lstsq(X, y, rcond=None)[0]
        self.intercept_ = self.intercept
        return self


def identify(twin, estimators, **settings):
    return th.identify(twin.robot, twin.recording, estimators=estimators, cutoff_hz=40, decimation=10, **settings)


@pytest.fixture(scope="module")
def own(twin):
    """A result with methods and estimators."""
    seen = []

    def iv(regression):
        seen.append(regression)
        return np.linalg.solve(regression.Z.T @ regression.X, regression.Z.T @ regression.y)

    estimators = {"bare": least_squares, "least-squares": with_covariance, "iv": iv, "model": LinearModel()}
    options = {"methods": ["idim-ls", "idim-iv"], "controller": twin.controller}
    return identify(twin, estimators, **options), seen


def test_its_run_stands_beside_the_methods(own, twin):
    result, seen = own
    run, ls = result["bare"], result["idim-ls"]
    np.testing.assert_allclose(run.estimates, ls.estimates, rtol=1e-9)
    assert run.relative_error_percent == pytest.approx(ls.relative_error_percent, rel=1e-9)
    # Parts are left out of both alike.
    assert run.cross_validation_relative_error_percent == pytest.approx(
        ls.cross_validation_relative_error_percent, rel=1e-9
    )
    assert [run.method for run in result] == ["idim-ls", "idim-iv", "bare", "least-squares", "iv", "model"]
    assert run.is_own and not ls.is_own and "bare" in result
    np.testing.assert_allclose(result["model"].estimates, ls.estimates, rtol=1e-9)
    np.testing.assert_allclose(result["iv"].estimates, result["idim-iv"].estimates, rtol=1e-6)
    motion = twin.motion.position, twin.motion.velocity, twin.motion.acceleration
    np.testing.assert_allclose(result.predict(*motion, run=run), result.predict(*motion, run=ls), rtol=1e-6, atol=1e-9)
    # All rows once, then without each of five parts; rows belong together.
    assert len(seen) == 6
    assert seen[0].X.shape == seen[0].Z.shape == (len(seen[0].y), len(seen[0].names)) == (1950, 13)
    assert len(seen[1].y) == len(seen[1].joint) == len(seen[1].recording) == 1560
    assert list(seen[0].names) == ls.names and set(seen[0].joint) == {0, 1} and set(seen[0].recording) == {0}


def test_intervals_are_those_of_its_own_covariance(own):
    result, _ = own
    run, ls = result["least-squares"], result["idim-ls"]
    classical = [parameter.standard_deviation for parameter in ls]
    np.testing.assert_allclose(run.standard_deviations, classical, rtol=1e-6)
    half = 0.5 * (run.intervals_95[:, 1] - run.intervals_95[:, 0])
    np.testing.assert_allclose(half, 1.959964 * run.standard_deviations, rtol=1e-6)
    assert np.isnan(result["bare"].intervals_95).all() and np.isnan(result["bare"].standard_deviations).all()
    assert all(parameter.standard_deviation_robust is None for parameter in run)


def test_verdict_advice_and_exports_know_nothing_of_it(own, result, tmp_path):
    with_own, _ = own
    assert (with_own.verdict, with_own.advice, with_own.reasons) == (result.verdict, result.advice, result.reasons)
    assert with_own.best.method == result.best.method
    with pytest.raises(th.SettingsError, match="unknown method `bare`"):
        with_own.export(tmp_path / "arm.urdf", method="bare")


def test_files_and_tables_show_it_as_the_users_own(own, tmp_path):
    result, _ = own
    result.write(tmp_path)
    written = json.loads((tmp_path / "results.json").read_text())
    assert [run["method"] for run in written["runs"]] == ["idim-ls", "idim-iv"]
    assert [run["name"] for run in written["user_runs"]] == ["bare", "least-squares", "iv", "model"]
    rows = list(csv.DictReader(io.StringIO(result.to_csv())))
    assert {row["method"] for row in rows} >= {"idim-ls", "user:bare"}
    assert all(row["interval_95_low"] == "" for row in rows if row["method"] == "user:bare")
    text = " ".join(result.text().split())
    assert "The user's own estimators, which thetahat has not examined" in text
    assert "bare gave no covariance" in text and "least-squares gave no covariance" not in text
    assert "has not examined" in (tmp_path / "report.html").read_text()
    assert "bare (your own)" in result._repr_html_() and "(your own)" in repr(result["bare"])
    again = th.Result.read(tmp_path / "results.json")
    np.testing.assert_array_equal(again["bare"].estimates, result["bare"].estimates)
    assert again["bare"].is_own


def test_a_pickled_result_keeps_it_with_its_curves(own):
    result, _ = own
    copy = pickle.loads(pickle.dumps(result))
    np.testing.assert_array_equal(copy["bare"].predicted, result["bare"].predicted)
    assert copy["bare"].predicted.shape == copy["bare"].measured.shape
    assert copy._native.render("report.html") == result._native.render("report.html")


def test_recordings_held_back_are_predicted(twin):
    other = th.testing.twin(seconds=5, seed=2).recording
    result = identify(twin, {"own": least_squares}, validation=other)
    ls = result["idim-ls"]
    assert result["own"].cross_validation_relative_error_percent == pytest.approx(
        ls.cross_validation_relative_error_percent, rel=1e-9
    )


def test_weights_of_recordings_are_in_the_rows(twin):
    both = [twin.recording, th.testing.twin(seconds=5, seed=2).recording]
    both[1].name, both[1].weight = "light", 0.1
    result = th.identify(twin.robot, both, estimators={"own": least_squares}, cutoff_hz=40, decimation=10)
    np.testing.assert_allclose(result["own"].estimates, result["idim-ls"].estimates, rtol=1e-9)


def fails(regression):
    raise ZeroDivisionError("by nothing")


@pytest.mark.parametrize(
    ("estimator", "message"),
    [
        (fails, "the estimator own: ZeroDivisionError: by nothing"),
        (lambda r: [1.0, 2.0], "the estimator own: it returned 2 estimates for 13 parameters"),
        (lambda r: [np.nan] * 13, "the estimator own: its estimate of zz1r is NaN"),
        (lambda r: (least_squares(r), -np.eye(13)), "the estimator own: its variance of zz1r is -1"),
        (lambda r: (least_squares(r), np.eye(2)), "the estimator own: its covariance is 2 by 2 for 13 parameters"),
        (lambda r: np.linalg.lstsq(r.X, r.y, rcond=None), "the estimator own: TypeError: .*return theta"),
        (lambda r: "text", "the estimator own: TypeError: .*return theta"),
        (lambda r: None, "the estimator own: TypeError: .*return theta"),
        (LinearModel(intercept=0.3), "the estimator own: ValueError: LinearModel has an intercept"),
    ],
)
def test_a_failure_names_it(twin, estimator, message):
    with pytest.raises(th.EstimationError, match=message):
        identify(twin, {"own": estimator})


def test_what_it_raised_is_the_cause(twin):
    with pytest.raises(th.EstimationError) as raised:
        identify(twin, {"own": fails})
    assert isinstance(raised.value.__cause__, ZeroDivisionError)


def test_a_failure_without_a_part_names_the_part(twin):
    calls = []

    def second(regression):
        calls.append(len(regression.y))
        return fails(regression) if len(calls) == 3 else least_squares(regression)

    with pytest.raises(th.EstimationError, match="the estimator own without part 2: ZeroDivisionError"):
        identify(twin, {"own": second})


def test_names_of_methods_and_things_that_are_no_estimators_are_refused(twin):
    with pytest.raises(th.SettingsError, match="cannot be called `idim-ls`"):
        identify(twin, {"idim-ls": least_squares})
    with pytest.raises(TypeError, match="the estimator own must be a function"):
        identify(twin, {"own": 3})
    with pytest.raises(TypeError, match="the estimator own must be a function"):
        identify(twin, {"own": LinearModel})
    with pytest.raises(TypeError, match="give estimators of your own by name"):
        identify(twin, {}, methods=["idim-ls", least_squares])


def test_a_model_of_scikit_learn(twin):
    linear_model = pytest.importorskip("sklearn.linear_model")
    result = identify(twin, {"ridge": linear_model.Ridge(alpha=1e-6, fit_intercept=False)})
    np.testing.assert_allclose(result["ridge"].estimates, result["idim-ls"].estimates, rtol=1e-3)


def arm_with(expression, value=0.0):
    """The arm with a torque term of its shoulder."""
    head, parameters = th.testing.arm()._native.text().split("[parameters]")
    term = "kind = 'expression'\nname = 'cubic1'\njoint = 'shoulder'\nunit = 'N m s^3/rad^3'\n"
    text = f"{head}[[term]]\n{term}expression = '{expression}'\n[parameters]\ncubic1 = {value}\n{parameters}"
    return th.Robot.from_text(text, name="arm")


def test_a_torque_term_is_computed_in_python():
    """A channel computed of the filtered motion gives what the formula inside thetahat gives."""
    twin = th.testing.twin(arm_with("dq^3", 0.4), seconds=10, seed=1)
    motion = th.band_pass(twin.recording.position, 1000, 40)
    log = th.Recording(
        sample_rate_hz=1000,
        position=twin.recording.position,
        torque=twin.recording.torque,
        reference=twin.recording.reference,
        channels={"cube": motion.velocity[:, 0] ** 3},
    )
    settings = {"methods": ["idim-ls", "idim-iv"], "controller": twin.controller, "cutoff_hz": 40, "decimation": 10}
    own, formula = (th.identify(robot, log, **settings) for robot in (arm_with("cube"), twin.robot))
    without = th.identify(th.testing.arm(), log, **settings)
    for method in settings["methods"]:
        low, high = own[method]["cubic1"].interval_95
        assert low < 0.4 < high < low + 0.02
        apart = (own[method].estimates - formula[method].estimates) / formula[method].standard_deviations
        assert np.max(np.abs(apart)) < 0.05
        assert own[method].relative_error_percent < 0.3 * without[method].relative_error_percent
