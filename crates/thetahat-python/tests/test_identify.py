"""The whole way: recordings to results, and what results give."""

import json
import pickle

import numpy as np
import pytest

import thetahat as th


def identify(twin, **options):
    return th.identify(twin.robot, twin.recording, **{"cutoff_hz": 40, "decimation": 10, **options})


def test_the_truth_of_a_twin_lies_in_the_intervals(twin, result):
    assert result.verdict == "good", result.reasons
    run = result["idim-iv"]
    assert run.names == list(twin.truth)
    truth = np.array(list(twin.truth.values()))
    low, high = run.intervals_95.T
    # 13 intervals of 95 %: more than three misses are as rare as one in 400.
    assert np.sum((low > truth) | (truth > high)) <= 3
    assert np.max(np.abs(run.estimates - truth) / run.standard_deviations) < 5


def test_a_result_is_read_by_its_keys(result):
    assert [run.method for run in result] == ["idim-ls", "idim-iv"]
    run = result["idim-iv", "nominal"]
    assert run["fv1"].unit == "N m s/rad" and run["fv1"].estimate == run.estimates[run.names.index("fv1")]
    assert result.best.method == result.advice[0].recommended
    with pytest.raises(KeyError, match="there is no run of didim"):
        result["didim"]
    with pytest.raises(KeyError, match="idim-iv estimates no m1"):
        run["m1"]


def test_what_is_in_a_result_is_told_by_its_keys(result):
    assert "idim-iv" in result and ("idim-iv", "nominal") in result
    assert "didim" not in result and ("idim-iv", "other") not in result
    assert "fv1" in result["idim-iv"] and "m1" not in result["idim-iv"]


def test_one_method_is_named_by_its_name(twin):
    assert [run.method for run in identify(twin, methods="idim-ls")] == ["idim-ls"]


def test_a_run_without_estimate_is_not_replaced_by_another(twin, result):
    data = {**result["idim-ls"].to_dict(), "parameters": [], "reason": "it diverged"}
    without = th.Run(data, (np.zeros(1), np.zeros((1, 2)), np.zeros((0, 0))))
    motion = [array[0] for array in (twin.motion.position, twin.motion.velocity, twin.motion.acceleration)]
    with pytest.raises(th.ResultsError, match="idim-ls has no estimate in the case nominal: it diverged"):
        result.predict(*motion, run=without)


def test_a_table_has_a_row_for_each_parameter(result):
    pytest.importorskip("pandas")
    run = result["idim-iv"]
    table = run.to_pandas()
    assert list(table.index) == run.names
    np.testing.assert_array_equal(table["estimate"], run.estimates)
    np.testing.assert_array_equal(table[["interval_95_low", "interval_95_high"]], run.intervals_95)


def test_predictions_are_the_torques_without_noise(twin, result):
    motion = twin.motion
    predicted = result.predict(motion.position, motion.velocity, motion.acceleration)
    # Where a joint rests, the simulated friction is not that of a sign.
    moving = np.all(np.abs(motion.velocity) > 0.1, axis=1)
    error = np.linalg.norm((predicted - motion.torque)[moving]) / np.linalg.norm(motion.torque[moving])
    assert error < 2e-3
    one = result.predict(motion.position[500], motion.velocity[500], motion.acceleration[500])
    np.testing.assert_array_equal(one, predicted[500])


def test_the_model_is_what_predicts(twin, result):
    model = result.model
    assert model.uses["predict-torques"] == "good" and model.unseen_percent < 5
    assert list(result.standard_parameters()) == [model.standard[name] for name in twin.robot.parameter_names]
    decided = [p for p in model.parameters if p.decided_percent >= 90]
    assert decided and all(p.interval_95[0] <= p.interval_95[1] for p in decided)
    assert model.friction_transition > 0 and model.belief_weight > 0 and isinstance(model.causes, list)
    assert "predict-torques" in repr(model)


def test_curves_belong_together(result):
    run = result["idim-ls"]
    assert run.measured.shape == run.predicted.shape == (len(run.time), 2)
    error = 100 * np.linalg.norm(run.measured - run.predicted) / np.linalg.norm(run.measured)
    assert error == pytest.approx(run.relative_error_percent, rel=1e-6)


def test_the_report_is_one_file(result, tmp_path):
    path = tmp_path / "report.html"
    result.report(path)
    assert path.read_bytes() == result._native.render("report.html")
    assert "idim-iv" in path.read_text()
    written = result.write(tmp_path / "all")
    assert [name.rsplit("/", 1)[-1] for name in written] == ["results.json", "parameters.csv", "report.html"]
    with pytest.raises(th.ReportError, match="there is no such folder"):
        result.report(tmp_path / "absent" / "report.html")


def test_the_robot_is_exported(result, tmp_path):
    said = result.export(tmp_path / "arm.urdf")
    assert said[0].startswith("the model")
    assert any("URDF has no motor inertia" in line for line in said)
    text = (tmp_path / "arm.urdf").read_text()
    damping = float(text.partition('damping="')[2].partition('"')[0])
    assert "<inertial>" in text and damping == pytest.approx(result.model["fv1"], rel=1e-9)
    result.export(tmp_path / "arm.xml", method="idim-ls")
    assert "fullinertia" in (tmp_path / "arm.xml").read_text()
    with pytest.raises(th.errors.ResultsError, match="urdf, mjcf, sdf, json"):
        result.export(tmp_path / "arm.dae")
    with pytest.raises(th.errors.ResultsError, match="there are nominal idim-ls, nominal idim-iv"):
        result.export(tmp_path / "arm.urdf", method="didim")


@pytest.mark.parametrize(
    ("name", "write"),
    [
        ("arm.urdf", lambda result, path, **options: result.export(path, **options)),
        ("page.html", lambda result, path, **options: result.report(path, **options)),
        ("results.json", lambda result, path, **options: result.write(path.parent, **options)),
    ],
)
def test_files_of_others_are_replaced_with_force_only(result, tmp_path, name, write):
    path = tmp_path / name
    path.write_text("mine")
    with pytest.raises(th.ReportError, match=f"{name}: exists and .*; give another place, or replace it with force=True"):
        write(result, path)
    assert path.read_text() == "mine" and list(tmp_path.iterdir()) == [path]
    write(result, path, force=True)
    written = path.read_text()
    assert written != "mine"
    # What thetahat wrote is replaced.
    write(result, path)
    assert path.read_text() == written


def test_a_proposal_that_may_be_edited_is_not_replaced(result, tmp_path):
    path = tmp_path / "experiment.toml"
    path.write_text("# Proposed by thetahat from log.csv")
    with pytest.raises(th.ReportError, match="may contain your changes; give another place, or replace it with force=True"):
        result.report(path)


def test_notebooks_show_verdict_and_estimates(result):
    html = result._repr_html_()
    assert "good" in html and html.count("<tr>") == 1 + len(result["idim-iv"])
    assert "<script" not in th.Result._repr_html_(result)


def test_torques_are_plotted(result):
    pytest.importorskip("matplotlib")
    figure = result.plot_torques()
    assert len(figure.axes) == 2 and len(figure.axes[0].lines) == 2


def test_everything_is_pickled(twin, result):
    copy = pickle.loads(pickle.dumps(result))
    for name in ["results.json", "parameters.csv", "report.html"]:
        assert copy._native.render(name) == result._native.render(name), name
    motion = twin.motion
    arrays = motion.position, motion.velocity, motion.acceleration
    np.testing.assert_array_equal(copy.predict(*arrays), result.predict(*arrays))
    log = pickle.loads(pickle.dumps(twin.recording))
    again = th.identify(pickle.loads(pickle.dumps(twin.robot)), log, cutoff_hz=40, decimation=10)
    np.testing.assert_array_equal(again["idim-ls"].estimates, result["idim-ls"].estimates)
    for value in [th.PD(bandwidth_hz=3), th.RobotError("a text"), result.advice, result["idim-ls"]["fv1"]]:
        assert str(pickle.loads(pickle.dumps(value))) == str(value)


def test_results_are_read_from_their_file(result, tmp_path):
    result.write(tmp_path)
    read = th.Result.read(tmp_path / "results.json")
    assert read.to_json() == result.to_json()
    assert read.robot is None
    with pytest.raises(th.ResultsError, match="have no robot"):
        read.predict([0, 0], [0, 0], [0, 0])
    (tmp_path / "other.json").write_text(json.dumps({"a": 1}))
    with pytest.raises(th.ResultsError, match=r"other\.json"):
        th.Result.read(tmp_path / "other.json")


def test_without_a_filter_one_is_chosen(twin):
    chosen = th.choose_filter(twin.robot, twin.recording)
    assert 5 < chosen.cutoff_hz < 200 and chosen.decimation > 1 and "twin" in chosen.reasons[0]
    result = th.identify(twin.robot, twin.recording)
    assert result.to_dict()["bandwidth"]["position_cutoff_hz"] == chosen.cutoff_hz


def test_tables_of_an_experiment_file_are_settings(twin):
    result = identify(
        twin,
        methods=["idim-ls", "idim-iv"],
        controller={"law": "pd", "bandwidth_hz": 10, "velocity_feed_forward": 1, "acceleration_feed_forward": 1},
        parameters={"physical": True, "exclude": ["off1", "off2"]},
        estimation={"weighting": {"idim-iv": "per-joint"}},
        cases=[{"name": "wrong gears", "simulator": {"gear_ratio": 0.9}}],
        title="two cases",
    )
    assert "off1" not in result["idim-ls"].names
    assert result["idim-iv"].to_dict()["weighting"] == "per-joint"
    assert result["idim-iv", "wrong gears"].status == "converged"
    assert result.to_dict()["title"] == "two cases"


def test_fixed_parameters_stay_in_predictions(twin, result):
    fixed = identify(twin, parameters={"fix": {"m2": 2.0, "mx2": 0.3}})
    assert "mx2" not in fixed["idim-ls"].names
    motion = twin.motion
    arrays = motion.position, motion.velocity, motion.acceleration
    difference = fixed.predict(*arrays, run=fixed["idim-ls"]) - result.predict(*arrays, run=result["idim-ls"])
    assert np.max(np.abs(difference)) < 0.05


def test_several_recordings_are_one_regression(twin):
    other = th.testing.twin(seconds=10, seed=2)
    both = th.identify(twin.robot, [twin.recording, other.recording], cutoff_hz=40, decimation=10)
    alone = identify(twin)
    assert len(both.to_dict()["recordings"]) == 2
    assert np.median(both["idim-ls"].standard_deviations / alone["idim-ls"].standard_deviations) < 0.9
    held_back = identify(twin, validation=other.recording)
    assert held_back["idim-ls"].to_dict()["cross_validation_relative_error_percent"] is not None


def test_progress_is_told(twin):
    stages = []
    identify(twin, progress=stages.append)
    assert stages[0] == "reading and filtering the recordings" and "checking the recordings" in stages

    def stop(stage):
        raise RuntimeError("stop")

    with pytest.raises(RuntimeError, match="^stop$"):
        identify(twin, progress=stop)


def test_tqdm_shows_progress_where_it_is_installed(twin, capsys):
    pytest.importorskip("tqdm")
    identify(twin, progress=True)
    assert "checking the recordings" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "error", "text"),
    [
        ({"methods": ["idim-xy"]}, th.SettingsError, "unknown variant `idim-xy`"),
        ({"methods": ["didim"]}, th.SettingsError, r"\[controller\] is missing"),
        ({"decimation": 0}, th.SettingsError, "decimation"),
        ({"cutoff_hz": 600.0}, th.SettingsError, "Nyquist"),
        ({"cutoff_hz": None}, th.SettingsError, "decimation is given without cutoff_hz: give both, or neither"),
        ({"decimation": None}, th.SettingsError, "cutoff_hz is given without decimation: give both, or neither"),
        ({"parameters": {"extent": 1}}, th.SettingsError, "unknown field `extent`"),
        ({"parameters": {"show": object()}}, TypeError, "settings hold numbers"),
        ({"controller": th.PD()}, th.SettingsError, "give either bandwidth_hz"),
    ],
)
def test_settings_that_cannot_be_used_are_refused(twin, options, error, text):
    with pytest.raises(error, match=text) as refused:
        identify(twin, **options)
    if error is not TypeError:
        assert isinstance(refused.value, (th.ThetahatError, ValueError))


def test_a_recording_of_another_robot_is_refused(twin):
    one = twin.recording.position[:, :1]
    log = th.Recording(sample_rate_hz=1000, position=one, torque=one, name="log")
    with pytest.raises(th.SettingsError, match="recording log, position: number of channels is 1, expected 2"):
        th.identify(twin.robot, log, cutoff_hz=40, decimation=10)
