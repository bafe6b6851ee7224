"""The commands as functions."""

import numpy as np
import pytest

import thetahat as th

DESIGN = {
    "duration_s": 3,
    "sample_rate_hz": 200,
    "motion": {"harmonics": 3, "starts": 1},
    "limits": {"position": [[-100, 100], [-100, 100]], "velocity": [200, 200], "acceleration": [600, 600], "torque": [200, 100]},
    "noise": {"torque": [0.2, 0.1], "position": 0.0005},
    "signal": {"cutoff_hz": 30, "decimation": 5},
}


def test_checks_give_findings(twin):
    findings = th.check(twin.robot, twin.recording, cutoff_hz=40, decimation=10)
    assert [finding.code for finding in findings] == ["not-excited"]
    assert findings[0].recording == "twin" and str(findings[0]).startswith("note in twin: ")


def test_samples_are_descriptions(result, tmp_path):
    robots = th.sample(result, 3, seed=5)
    assert len(set(robots)) == 3 and robots == th.sample(result, 3, seed=5)
    assert th.Robot.from_text(robots[0], name="sample.urdf").n == 2
    th.sample(result, 2, "mjcf", out=tmp_path / "robots")
    assert len(list((tmp_path / "robots").iterdir())) == 2


def test_code_is_generated(result, tmp_path):
    code = th.generate(result, "gravity", "python", name="arm")
    names = {}
    exec(code, names)
    state = np.array([0.3, -0.4])
    expected = result.robot.gravity(state, theta=result.standard_parameters())
    np.testing.assert_allclose(names["arm_gravity"](state), expected, atol=1e-9)
    path = tmp_path / "arm.h"
    assert th.generate(th.testing.arm(), to="c", out=path) == path.read_text()
    th.generate(th.testing.arm(), to="c", out=path)
    path.write_text("mine")
    with pytest.raises(th.CommandError, match="force=True"):
        th.generate(th.testing.arm(), to="c", out=path)
    with pytest.raises(th.CommandError, match="invalid value 'fortran'"):
        th.generate(th.testing.arm(), to="fortran")


def test_results_are_compared(result, tmp_path):
    result.write(tmp_path)
    text = th.compare(result, tmp_path / "results.json", method="idim-ls")
    assert "0 of 13 parameters differ" in text
    with pytest.raises(ValueError, match="two results or more, and has 1"):
        th.compare(result)


def test_results_are_exported(result, tmp_path):
    remarks = th.export(result, tmp_path / "arm.urdf")
    assert remarks[0].startswith("the model") and (tmp_path / "arm.urdf").exists()


def test_motions_are_designed():
    designed = th.design(DESIGN, robot=th.testing.arm())
    assert designed.position.shape == designed.acceleration.shape == (len(designed.time), 2)
    assert designed.predicted["fv1"] > 0 and "Limits" in designed.text
    step = designed.time[1] - designed.time[0]
    np.testing.assert_allclose(np.gradient(designed.position, step, axis=0)[5:-5], designed.velocity[5:-5], atol=0.05)
    with pytest.raises(TypeError, match="design must be the path"):
        th.design(3)
    with pytest.raises(th.CommandError, match=r"(?s)^design\.toml: .*noise"):
        th.design({"duration_s": 3}, robot=th.testing.arm())


def test_experiments_are_simulated_reduced_and_solved(checkout, tmp_path):
    for name in ("arm.urdf", "twin.toml"):
        (tmp_path / name).write_bytes((checkout / "examples/arm" / name).read_bytes())
    log = th.simulate_experiment(tmp_path / "twin.toml", out=tmp_path / "log.csv")
    assert log.position.shape[1] == 3 and "torque_1" in th.inspect(tmp_path / "log.csv")
    th.init(tmp_path / "arm.urdf", tmp_path / "log.csv", out=tmp_path / "experiment.toml")
    reduced = th.reduce(tmp_path / "experiment.toml", tmp_path / "log.reduction")
    solved = th.solve(reduced)
    assert solved.model is not None and solved["idim-wls"].relative_error_percent < 2
    rows = th.solve(th.reduce(tmp_path / "experiment.toml", tmp_path / "rows.reduction", rows_only=True))
    assert rows.model is not None and rows["idim-ls"].relative_error_percent < 2
    with pytest.raises(th.ReductionError, match="cannot be read"):
        th.solve(tmp_path / "absent")


def test_errors_are_those_of_the_command(tmp_path, capfd):
    with pytest.raises(th.CommandError, match=r"absent\.toml: cannot be read"):
        th.reduce(tmp_path / "absent.toml", tmp_path / "out")
    with pytest.raises(th.CommandError, match="no file is given"):
        th.inspect()
    assert capfd.readouterr() == ("", "")
