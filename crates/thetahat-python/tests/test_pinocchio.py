"""The order of parameters against Pinocchio's, and its regressor against ours."""

import math

import numpy as np
import pytest

import thetahat as th

pin = pytest.importorskip("pinocchio")


def test_regressors_and_parameters_agree(checkout, tmp_path):
    # We take 1.5708 as a right angle, Pinocchio as it stands.
    text = (checkout / "robots/seven_axes.urdf").read_text().replace("1.5708", repr(math.pi / 2))
    path = tmp_path / "seven_axes.urdf"
    path.write_text(text)
    robot, model = th.Robot.from_urdf(path), pin.buildModelFromUrdf(str(path))
    data = model.createData()
    assert list(model.names)[1:] == robot.joints
    rng = np.random.default_rng(0)
    columns = th.pinocchio.columns(robot)
    theirs = np.array([inertia.toDynamicParameters() for inertia in model.inertias[1:]])
    np.testing.assert_allclose(th.pinocchio.to_pinocchio(robot, robot.a_priori), theirs, rtol=1e-12, atol=1e-12)
    theta = th.pinocchio.from_pinocchio(robot, theirs)
    for _ in range(20):
        q, dq, ddq = rng.normal(size=(3, robot.n))
        expected = pin.computeJointTorqueRegressor(model, data, q, dq, ddq)
        np.testing.assert_allclose(robot.regressor(q, dq, ddq)[:, columns], expected, rtol=1e-9, atol=1e-9)
        torque = pin.rnea(model, data, q, dq, ddq)
        np.testing.assert_allclose(robot.inverse_dynamics(q, dq, ddq, theta=theta), torque, rtol=1e-9, atol=1e-9)
