"""For users of Pinocchio: our order of inertial parameters against theirs.

Pinocchio orders the parameters of a body as ``m, mx, my, mz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz``, ours are ``xx, xy, xz, yy, yz, zz,
mx, my, mz, m``. Both refer to the origin and the axes of the joint's frame: of a URDF ours are those of the URDF's link frame,
and so are Pinocchio's. Our table continues with ``ia, fv, fc, off`` of each joint.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import Array, float64
from .robot import Robot

OURS = ("xx", "xy", "xz", "yy", "yz", "zz", "mx", "my", "mz", "m")
"""Our order of a link's inertial parameters."""

THEIRS = ("m", "mx", "my", "mz", "xx", "xy", "yy", "xz", "yz", "zz")
"""Pinocchio's, in the names of ours."""


def columns(robot: Robot) -> list[int]:
    """Indices of our standard parameters in Pinocchio's order, body by body, shape (10 * links,).

    ``robot.regressor(q, dq, ddq)[:, columns(robot)]`` is ``pin.computeJointTorqueRegressor(model, data, q, dq, ddq)``.

    Examples
    --------
    >>> from thetahat import testing
    >>> robot = testing.arm()
    >>> [robot.parameter_names[k] for k in columns(robot)[:5]]
    ['m1', 'mx1', 'my1', 'mz1', 'xx1']
    """
    names = robot.parameter_names
    links = sum(name.startswith("zz") for name in names)
    return [names.index(f"{quantity}{link + 1}") for link in range(links) for quantity in THEIRS]


def to_pinocchio(robot: Robot, theta: ArrayLike) -> Array:
    """Dynamic parameters in Pinocchio's order, shape (links, 10), from our standard parameters, shape (p,).

    Row ``k`` is for ``pin.Inertia.FromDynamicParameters`` of joint ``k + 1``.
    """
    return float64("theta", theta)[columns(robot)].reshape(-1, len(THEIRS))


def from_pinocchio(robot: Robot, dynamic_parameters: ArrayLike) -> Array:
    """Our standard parameters, shape (p,), from Pinocchio's, shape (links, 10); those of joints and motors are zero."""
    theta = np.zeros(len(robot.parameter_names))
    theta[columns(robot)] = float64("dynamic_parameters", dynamic_parameters).reshape(-1)
    return theta
