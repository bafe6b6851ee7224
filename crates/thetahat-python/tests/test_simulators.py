"""Terms of the dynamics, and results in the models of MuJoCo and Pinocchio."""

import numpy as np
import pytest

import thetahat as th

RNG = np.random.default_rng(4)
Q, DQ, DDQ = RNG.normal(size=(3, 20, 2))

MJCF = """<mujoco><compiler angle="radian"/><option gravity="0 0 -9.81"/><worldbody>
<body name="upper" {pose}><joint name="shoulder" axis="0 0 1"/>
<inertial pos="0.1 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>
<body name="lower" pos="0.4 0 0"><joint name="elbow" axis="0 0 1"/>
<inertial pos="0.1 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>
<body name="tool" pos="0.2 0 0"><inertial pos="0 0 0" mass="1" diaginertia="0.1 0.1 0.1"/></body>
</body></body></worldbody></mujoco>"""


def test_the_terms_add_up():
    arm = th.testing.arm()
    masses = arm.mass_matrix(Q)
    expected = np.einsum("kij,kj->ki", masses, DDQ) + arm.coriolis(Q, DQ) + arm.gravity(Q)
    np.testing.assert_allclose(arm.rnea(Q, DQ, DDQ), expected, atol=1e-12)
    assert arm.gravity(Q[0]).shape == (2,) and arm.coriolis(Q[0], DQ[0]).shape == (2,)


def test_friction_and_offsets_are_no_part_of_them():
    arm = th.testing.arm()
    theta = arm.a_priori
    for name in ("off1", "fv2", "fc2"):
        theta[arm.parameter_names.index(name)] = 7.0
    for term in (lambda **o: arm.rnea(Q, DQ, DDQ, **o), lambda **o: arm.gravity(Q, **o), lambda **o: arm.coriolis(Q, DQ, **o)):
        np.testing.assert_array_equal(term(theta=theta), term())
    rotor = theta.copy()
    rotor[arm.parameter_names.index("ia1")] += 1.0
    difference = arm.rnea(Q, DQ, DDQ, theta=rotor) - arm.rnea(Q, DQ, DDQ)
    np.testing.assert_allclose(difference, np.column_stack([DDQ[:, 0], np.zeros(20)]), atol=1e-12)


def test_a_description_is_read_whatever_its_format(tmp_path):
    path = tmp_path / "arm.toml"
    path.write_text(th.testing.arm()._native.text())
    for read in (th.Robot.from_file, th.Robot.from_toml, th.Robot.from_mjcf):
        assert read(path).joints == ["shoulder", "elbow"]


def same_torques(torques, robot, theta):
    np.testing.assert_allclose(torques, robot.rnea(Q, DQ, DDQ, theta=theta), rtol=1e-7, atol=1e-9)


def test_a_result_is_written_into_a_model_of_mujoco(result):
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    # The base turns the axes of the first joint from z to -y, as the robot's does.
    model = mujoco.MjModel.from_xml_string(MJCF.format(pose='euler="1.5707963267948966 0 0"'))
    remarks = result.to_mujoco(model)
    assert remarks[0].startswith("the model")
    for name, values in (("fv", model.dof_damping), ("fc", model.dof_frictionloss), ("ia", model.dof_armature)):
        found = np.reshape(values, (2, -1))[:, 0]
        np.testing.assert_allclose(found, [result.model[f"{name}1"], result.model[f"{name}2"]], rtol=1e-9)
    assert model.body_mass[model.body("tool").id] == 0
    data, torques = mujoco.MjData(model), []
    np.reshape(model.dof_damping, (2, -1))[:, 0], np.reshape(model.dof_frictionloss, (2, -1))[:, 0] = 0, 0
    for q, dq, ddq in zip(Q, DQ, DDQ, strict=True):
        data.qpos, data.qvel, data.qacc = q, dq, ddq
        mujoco.mj_inverse(model, data)
        torques.append(data.qfrc_inverse.copy())
    same_torques(np.array(torques), result.robot, result.standard_parameters())


def test_another_model_of_mujoco_is_refused(result):
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    model = mujoco.MjModel.from_xml_string(MJCF.format(pose=""))
    with pytest.raises(th.ResultsError, match="axis of joint shoulder differs"):
        result.to_mujoco(model)
    with pytest.raises(th.ResultsError, match="the MuJoCo model has no joint shoulder"):
        result.to_mujoco(mujoco.MjModel.from_xml_string("<mujoco/>"))


URDF = """<robot name="arm"><link name="base"/>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="80" velocity="4"/></joint>
<link name="upper"><inertial><origin xyz="0 0 -0.2"/><mass value="3"/>
<inertia ixx="0.04" ixy="0" ixz="0" iyy="0.04" iyz="0" izz="0.01"/></inertial></link>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.4"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="40" velocity="4"/><dynamics damping="0.5" friction="0.2"/></joint>
<link name="lower"><inertial><origin xyz="0 0 -0.15"/><mass value="2"/>
<inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.005"/></inertial></link></robot>"""


def test_a_result_is_a_model_of_pinocchio():
    pinocchio = pytest.importorskip("pinocchio", reason="Pinocchio is not installed")
    twin = th.testing.twin(th.Robot.from_text(URDF, name="arm.urdf"), seconds=10, seed=2)
    result = th.identify(twin.robot, twin.recording, cutoff_hz=40, decimation=10)
    model = result.to_pinocchio(untrusted=True)
    assert model.nv == 2
    data = model.createData()
    torques = [pinocchio.rnea(model, data, q, dq, ddq) for q, dq, ddq in zip(Q, DQ, DDQ, strict=True)]
    same_torques(np.array(torques), twin.robot, result.standard_parameters())
