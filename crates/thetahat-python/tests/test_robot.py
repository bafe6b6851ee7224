"""Robots: descriptions, and dynamics by their identities."""

import math
import pickle

import hypothesis
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import thetahat as th

ARM = th.testing.arm()


def motion(samples, seed=0):
    return np.random.default_rng(seed).normal(size=(3, samples, ARM.n))


def test_the_regressor_times_the_parameters_is_inverse_dynamics():
    q, dq, ddq = motion(1000)
    phi = ARM.regressor(q, dq, ddq)
    assert phi.shape == (1000, 2, len(ARM.parameter_names))
    tau = ARM.inverse_dynamics(q, dq, ddq)
    np.testing.assert_allclose(phi @ ARM.a_priori, tau, rtol=1e-12, atol=1e-12)
    base = ARM.regressor(q, dq, ddq, parameters="base")
    np.testing.assert_allclose(base @ list(ARM.base_values().values()), tau, rtol=1e-10, atol=1e-10)
    some = ARM.regressor(q, dq, ddq, parameters=["fc2", "ia1"])
    np.testing.assert_array_equal(some[..., 0], phi[..., ARM.parameter_names.index("fc2")])


def test_the_regressor_is_written_where_it_is_wanted():
    q, dq, ddq = motion(300)
    out = np.full((300, 2, 3), np.nan)
    phi = ARM.regressor(q, dq, ddq, parameters=["zz1", "fc2", "m2"], out=out)
    assert phi is out
    np.testing.assert_array_equal(phi, ARM.regressor(q, dq, ddq, parameters=["zz1", "fc2", "m2"]))
    fixed = out.copy()
    fixed.flags.writeable = False
    for bad in [out[:-1], out.astype(np.float32), np.asfortranarray(out), fixed]:
        with pytest.raises(ValueError, match="out must be a writable float64 array"):
            ARM.regressor(q, dq, ddq, parameters=["zz1", "fc2", "m2"], out=bad)


def test_forward_dynamics_undoes_inverse_dynamics():
    q, dq, ddq = motion(1000, seed=1)
    theta = ARM.a_priori
    tau = ARM.inverse_dynamics(q, dq, ddq, theta=theta, sign_velocity_scale=0.01)
    back = ARM.forward_dynamics(q, dq, tau, theta=theta, sign_velocity_scale=0.01)
    np.testing.assert_allclose(back, ddq, rtol=1e-9, atol=1e-9)


def test_the_mass_matrix_is_the_slope_of_the_torques():
    q, dq, ddq = motion(20, seed=2)
    masses = ARM.mass_matrix(q)
    steps = [ARM.inverse_dynamics(q, dq, ddq + e) - ARM.inverse_dynamics(q, dq, ddq) for e in np.eye(2)]
    np.testing.assert_allclose(masses, np.stack(steps, axis=-1), rtol=1e-10, atol=1e-10)


def test_a_robot_without_inertia_has_no_accelerations():
    with pytest.raises(th.SimulationError, match="at sample 0: the mass matrix is not positive definite"):
        ARM.forward_dynamics(np.zeros((3, 2)), np.zeros((3, 2)), np.ones((3, 2)), theta=0 * ARM.a_priori)


# Samples on both sides of what is worked on at a time.
lengths = st.sampled_from([0, 1, 2, 3, 63, 64, 65, 255, 256, 257, 8191, 8192, 8193])


@given(lengths, st.sampled_from(["C", "F", "sliced", "reversed", "wide"]))
@hypothesis.settings(deadline=None, max_examples=60)
def test_every_order_of_an_array_gives_the_same_bits(samples, order):
    q, dq, ddq = motion(samples)
    expected = ARM.regressor(q, dq, ddq), ARM.inverse_dynamics(q, dq, ddq)

    def laid(array):
        if order == "sliced":
            return np.repeat(array, 3, axis=0)[::3]
        if order == "reversed":
            return array[::-1].copy()[::-1]
        if order == "wide":
            return np.hstack([array, array])[:, : ARM.n]
        return np.asarray(array, order=order)

    arrays = [laid(array) for array in (q, dq, ddq)]
    np.testing.assert_array_equal(ARM.regressor(*arrays), expected[0])
    np.testing.assert_array_equal(ARM.inverse_dynamics(*arrays), expected[1])


@given(hnp.array_shapes(min_dims=0, max_dims=3, max_side=4))
@hypothesis.settings(deadline=None)
def test_shapes_are_one_state_or_many(shape):
    array = np.zeros(shape)
    if shape == (2,) or (len(shape) == 2 and shape[1] == 2):
        assert ARM.inverse_dynamics(array, array, array).shape == shape
        assert ARM.mass_matrix(array).shape == (*shape, 2)
    else:
        with pytest.raises(ValueError, match=r"q must have shape \(2,\) or \(samples, 2\)"):
            ARM.inverse_dynamics(array, array, array)


@given(st.sampled_from(["float64", "float32", "float16", "int64", "uint8", "bool", "complex128", "object", "U3"]))
def test_kinds_of_numbers_are_taken_converted_or_refused(kind):
    array = np.ones((4, 2), dtype=kind)
    if kind in ("float32", "float16"):
        with pytest.warns(th.PrecisionWarning):
            ARM.mass_matrix(array)
    elif kind in ("float64", "int64", "uint8"):
        np.testing.assert_array_equal(ARM.mass_matrix(array), ARM.mass_matrix(np.ones((4, 2))))
    else:
        with pytest.raises(TypeError, match="q must hold real numbers"):
            ARM.mass_matrix(array)


def test_arrays_of_other_lengths_are_refused():
    q, dq, ddq = motion(10)
    with pytest.raises(ValueError, match=r"dq has shape \(9, 2\), and q has \(10, 2\)"):
        ARM.regressor(q, dq[:9], ddq)
    with pytest.raises(ValueError, match="theta must have shape"):
        ARM.inverse_dynamics(q, dq, ddq, theta=[1.0])
    with pytest.raises(th.RobotError, match="no standard parameter zz9"):
        ARM.regressor(q, dq, ddq, parameters=["zz9"])


def test_a_table_of_denavit_and_hartenberg_is_the_same_robot():
    parameters = {n: v for n, v in zip(ARM.parameter_names, ARM.a_priori, strict=True) if v}
    robot = th.Robot.from_dh(
        alpha=[math.pi / 2, 0], a=[0, 0.4], theta=[0, 0], d=[0, 0], transmission=np.diag([50, 50]), parameters=parameters
    )
    q, dq, ddq = motion(10)
    np.testing.assert_array_equal(robot.inverse_dynamics(q, dq, ddq), ARM.inverse_dynamics(q, dq, ddq))
    with pytest.raises(ValueError, match="a has 1 entries and alpha has 2"):
        th.Robot.from_dh(alpha=[0, 0], a=[0], theta=[0, 0], d=[0, 0])


def test_files_are_read_and_robots_pickled(checkout):
    tx40 = th.Robot.from_toml(checkout / "robots/tx40.toml")
    assert (tx40.n, len(tx40.base_parameters)) == (6, 61)
    urdf = th.Robot.from_urdf(checkout / "robots/seven_axes.urdf")
    name = urdf.joints[-1]
    locked = th.Robot.from_urdf(checkout / "robots/seven_axes.urdf", locked={name: 0.5})
    assert locked.n == urdf.n - 1 and name not in locked.joints
    for robot in (tx40, urdf, locked):
        copy = pickle.loads(pickle.dumps(robot))
        q = np.random.default_rng(5).normal(size=(4, robot.n))
        np.testing.assert_array_equal(copy.regressor(q, q, q), robot.regressor(q, q, q))
        assert copy.joints == robot.joints


def test_what_is_wrong_with_a_description_is_said(tmp_path):
    with pytest.raises(th.RobotError, match=r"absent\.urdf: the robot description cannot be read"):
        th.Robot.from_urdf(tmp_path / "absent.urdf")
    (tmp_path / "arm.toml").write_text("name = 'x'\n[[joint]]\nname = 'a'\nkind = 'round'")
    with pytest.raises(th.RobotError, match=r"arm\.toml: TOML parse error at line 4"):
        th.Robot.from_toml(tmp_path / "arm.toml")


def test_joints_that_slide_have_a_velocity_scale_of_their_own():
    q, dq, ddq = motion(200)
    of_pair = ARM.inverse_dynamics(q, dq, ddq, sign_velocity_scale=(0.01, 5.0))
    np.testing.assert_array_equal(of_pair, ARM.inverse_dynamics(q, dq, ddq, sign_velocity_scale=0.01))


@pytest.mark.parametrize("scale", [0.0, -1.0, math.nan, math.inf, (0.01, 0.0)])
def test_a_velocity_scale_that_is_none_is_refused(scale):
    q, dq, ddq = motion(200)
    calls = [
        lambda: ARM.regressor(q, dq, ddq, sign_velocity_scale=scale),
        lambda: ARM.inverse_dynamics(q, dq, ddq, sign_velocity_scale=scale),
        lambda: ARM.forward_dynamics(q, dq, ddq, sign_velocity_scale=scale),
        lambda: th.observation_matrix(ARM, q, dq, ddq, decimation=2, sign_velocity_scale=scale),
    ]
    for call in calls:
        with pytest.raises(ValueError, match="it is a velocity above zero, or None"):
            call()
