"""The closed loop of robot and controller, simulated."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _thetahat
from ._arrays import Array, samples
from .controllers import Controller
from .robot import Robot


class Simulated(NamedTuple):
    """A simulated motion; all arrays except the time have shape (samples, n)."""

    time: Array
    """Shape (samples,), s."""
    position: Array
    """rad or m."""
    velocity: Array
    """rad/s or m/s."""
    acceleration: Array
    """rad/s^2 or m/s^2, by the direct dynamic model."""
    torque: Array
    """Of the joints, N m or N."""


def simulate(
    robot: Robot,
    reference: ArrayLike,
    sample_rate_hz: float,
    *,
    controller: Controller | Mapping[str, Any],
    theta: ArrayLike | None = None,
    simulation: Mapping[str, Any] | None = None,
    bias: Mapping[str, Any] | None = None,
) -> Simulated:
    """Simulate a robot that follows a reference, from rest without tracking error.

    Parameters
    ----------
    robot : Robot
        The robot.
    reference : array_like (samples, n)
        The reference of the joints, rad or m.
    sample_rate_hz : float
        Samples per second of the reference and of the output.
    controller : Controller
        The controller, which acts on the motors.
    theta : array_like (p,), optional
        Standard parameters; by default the a-priori ones.
    simulation : mapping, optional
        The table of that name in an experiment file: ``solver`` and ``sign_velocity_scale``.
    bias : mapping, optional
        How the simulator differs from the true loop, such as ``{"gear_ratio": 0.9}``.

    Raises
    ------
    SimulationError
        For a loop that diverges.
    SettingsError
        For a controller or options that cannot be used.
    """
    robot._refuse_channels()
    followed = samples("reference", reference, robot.n)
    settings = {
        "controller": controller.settings() if isinstance(controller, Controller) else dict(controller),
        "simulation": dict(simulation or {}),
        "bias": dict(bias or {}),
    }
    motion = _thetahat.simulate(robot._native, followed, float(sample_rate_hz), robot._theta(theta), settings)
    return Simulated(np.arange(followed.shape[0]) / sample_rate_hz, *motion)
