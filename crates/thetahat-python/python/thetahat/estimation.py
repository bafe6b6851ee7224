"""The regression and its estimators as building blocks for your own method.

>>> import numpy as np
>>> import thetahat as th
>>> twin = th.testing.twin(seconds=10, seed=1)
>>> log, rate = twin.recording, 1000
>>> motion = th.band_pass(log.position, rate, 40)
>>> X = th.observation_matrix(twin.robot, *motion, decimation=10)
>>> y = th.measurement_vector(log.torque, decimation=10)
>>> theta, *_ = np.linalg.lstsq(X, y, rcond=None)  # your own estimator
>>> fit = th.estimate("idim-ls", X, y, joints=twin.robot.n)
>>> bool(np.allclose(theta, fit.theta))
True
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from . import _thetahat
from ._arrays import Array, samples, states, vector
from ._thetahat import Fit
from .robot import Robot, _Columns

__all__ = ["Fit", "estimate", "measurement_vector", "observation_matrix"]


def observation_matrix(
    robot: Robot,
    position: ArrayLike,
    velocity: ArrayLike,
    acceleration: ArrayLike,
    *,
    decimation: int,
    parameters: _Columns = "base",
    sign_velocity_scale: float | tuple[float, float] | None = None,
) -> Array:
    """The matrix ``X`` with ``y = X theta``: the regressor after the parallel filter and the decimation.

    Parameters
    ----------
    robot : Robot
        The robot.
    position, velocity, acceleration : array_like (samples, n)
        The motion, as from :func:`thetahat.band_pass`.
    decimation : int
        One in this many samples is kept.
    parameters, sign_velocity_scale
        As for :meth:`thetahat.Robot.regressor`.

    Returns
    -------
    ndarray (n * rows, columns)
        Rows ordered by joint, then by time; in Fortran order.
    """
    robot._refuse_channels()
    _, motion = states(robot.n, position=position, velocity=velocity, acceleration=acceleration)
    columns = robot.columns(parameters)
    return _thetahat.observation_matrix(robot._native, motion, decimation, columns, sign_velocity_scale)


def measurement_vector(torque: ArrayLike, *, decimation: int) -> Array:
    """The vector ``y``, shape (n * rows,): torques (samples, n) in the rows of :func:`observation_matrix`."""
    return _thetahat.measurement_vector(samples("torque", torque), decimation)


def estimate(
    method: str,
    X: ArrayLike,
    y: ArrayLike,
    Z: ArrayLike | None = None,
    *,
    joints: int = 1,
    weights: ArrayLike | None = None,
) -> Fit:
    """Estimate parameters from the rows of a regression.

    Parameters
    ----------
    method : {"idim-ls", "idim-wls", "idim-iv", "didim"}
        The estimator; the last two need `Z`, and do not iterate here.
    X : array_like (rows, columns)
        The observation matrix.
    y : array_like (rows,)
        The measurements.
    Z : array_like (rows, columns), optional
        Instruments: the observation matrix of a simulated motion.
    joints : int
        Number of joints of the rows, which are ordered by joint.
    weights : array_like (rows,), optional
        The weight of each row.

    Returns
    -------
    Fit
        ``theta``, ``covariance``, ``standard_deviation`` (classical), ``standard_deviation_robust``, ``interval_95``,
        ``prediction``, ``relative_error_percent``, ``condition_number``.

    Raises
    ------
    EstimationError
        If the rows do not separate the parameters.
    """
    matrix = samples("X", X)
    rows = matrix.shape[0]
    if joints < 1 or rows % joints:
        raise ValueError(f"{rows} rows cannot be divided among {joints} joints")
    instruments = None if Z is None else samples("Z", Z)
    if instruments is not None and instruments.shape != matrix.shape:
        raise ValueError(f"Z has shape {instruments.shape}, and X has {matrix.shape}")
    of_rows = None if weights is None else vector("weights", weights, rows)
    return _thetahat.estimate(method, matrix, vector("y", y, rows), instruments, joints, of_rows)
