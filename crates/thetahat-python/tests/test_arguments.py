"""Arguments are checked where they come in: messages name the argument and what was meant."""

import numpy as np
import pytest

import thetahat as th

Q = np.zeros((50, 2))


def test_unknown_keywords_get_a_suggestion(twin):
    with pytest.raises(TypeError, match=r"Recording\(\) has no argument effort; did you mean torque\?"):
        th.Recording(sample_rate_hz=10, position=Q, effort=Q)
    with pytest.raises(TypeError, match="did you mean methods"):
        th.identify(twin.robot, twin.recording, method=["idim-ls"])
    with pytest.raises(TypeError, match="did you mean decimation"):
        th.identify(twin.robot, twin.recording, decimaton=3)
    with pytest.raises(TypeError, match="its arguments are robot, recordings"):
        th.identify(twin.robot, twin.recording, xyz=3)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"methods": 3}, "methods must be names"),
        ({"controller": 3}, "controller must be"),
        ({"cutoff_hz": "12", "decimation": 3}, "cutoff_hz must be a number, and is str '12'"),
        ({"parameters": ["fv1"]}, "parameters must be a mapping"),
        ({"cases": {"name": "x"}}, "cases must be a list of mappings"),
        ({"progress": 3}, "progress must be True, False or a function"),
        ({"estimators": [3]}, "estimators must be a mapping"),
        ({"validation": 3}, "validation must be a thetahat.Recording"),
    ],
)
def test_wrong_types_are_named(twin, options, message):
    with pytest.raises(TypeError, match=message):
        th.identify(twin.robot, twin.recording, **options)


def test_wrong_robots_and_recordings_are_named(twin):
    with pytest.raises(TypeError, match="robot must be a thetahat.Robot or the path of its description, and is int 42"):
        th.identify(42, twin.recording)
    with pytest.raises(TypeError, match="recordings must be a thetahat.Recording"):
        th.identify(twin.robot, 7)
    with pytest.raises(TypeError, match=r"make one from arrays by thetahat.Recording\(time="):
        th.identify(twin.robot, Q)
    with pytest.raises(TypeError, match=r"recordings\[1\] must be"):
        th.identify(twin.robot, [twin.recording, 7])
    with pytest.raises(ValueError, match="use Robot.from_text"):
        th.Robot.from_urdf("<robot/>")
    with pytest.raises(TypeError, match="path must be"):
        th.Robot.from_urdf(3)


def test_a_wrong_number_of_joints_is_an_error_with_both_counts(twin):
    one = th.Recording(sample_rate_hz=100, position=Q[:, :1], torque=Q[:, :1])
    for call in (th.identify, th.choose_filter):
        with pytest.raises(ValueError, match=r"number of channels is 1, expected 2, .* \(shoulder, elbow\)"):
            call(twin.robot, one)
    with pytest.raises(ValueError, match="number of channels is 1, expected 2"):
        th.identify(twin.robot, twin.recording, validation=one)
    with pytest.raises(ValueError, match="decimation must be a whole number"):
        th.identify(twin.robot, twin.recording, cutoff_hz=40, decimation=2.5)


def test_files_are_given_by_name(twin, tmp_path):
    (tmp_path / "arm.toml").write_text(twin.robot._native.text())
    log = twin.recording
    table = np.column_stack([np.arange(len(log)) / 1000, log.position, log.torque])
    head = "time_s,position_1,position_2,torque_1,torque_2"
    np.savetxt(tmp_path / "log.csv", table, delimiter=",", header=head, comments="", fmt="%.17g")
    stages = []
    options = {"cutoff_hz": 40, "decimation": 10}
    result = th.identify(tmp_path / "arm.toml", str(tmp_path / "log.csv"), progress=stages.append, **options)
    arrays = th.identify(twin.robot, log, **options)
    np.testing.assert_array_equal(result["idim-ls"].estimates, arrays["idim-ls"].estimates)
    assert stages[0] == "reading the files"


def test_the_filter_is_chosen_once_for_the_same_content(twin, monkeypatch):
    from thetahat import _filter_choice

    calls = []

    def choose(robot, recordings, settings):
        calls.append(settings)
        return 40.0, 10, ["a reason"]

    monkeypatch.setattr(_filter_choice._thetahat, "choose_filter", choose)
    log, stages = twin.recording[:9000], []
    assert th.choose_filter(twin.robot, log).cutoff_hz == 40
    copy = th.Recording(sample_rate_hz=1000, name=log.name, position=log.position.copy(), torque=log.torque, reference=log.reference)
    th.identify(twin.robot, copy, methods=["idim-wls"], progress=stages.append)
    assert len(calls) == 1 and stages[0] == "choosing the filter"
    th.choose_filter(twin.robot, log, parameters={"exclude": ["off1"]})
    th.choose_filter(twin.robot, log[:8000])
    assert len(calls) == 3
