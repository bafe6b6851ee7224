"""Twins: simulated robots with known parameters, for tests of your own methods and pipelines."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ._arrays import Array
from .controllers import PD
from .recording import Recording
from .robot import Robot
from .simulation import Simulated, simulate

_ARM = """
name = "two-joint twin"
[[joint]]
name = "shoulder"
kind = "revolute"
alpha_deg = 90
[[joint]]
name = "elbow"
kind = "revolute"
a_m = 0.4
[transmission]
matrix = [[50, 0], [0, 50]]
[parameters]
m1 = 4
mx1 = 0.8
yy1 = 0.24
zz1 = 0.24
xx1 = 0.02
ia1 = 0.3
fv1 = 2
fc1 = 0.8
m2 = 2
mx2 = 0.3
yy2 = 0.07
zz2 = 0.07
xx2 = 0.01
ia2 = 0.1
fv2 = 1
fc2 = 0.4
"""


class Twin(NamedTuple):
    """A simulated robot with its recording."""

    robot: Robot
    """The robot; its a-priori parameters are the true ones."""
    recording: Recording
    """The measured positions and torques, and the reference without noise."""
    truth: dict[str, float]
    """The true base parameters by name, SI."""
    motion: Simulated
    """The motion and torques without noise."""
    controller: PD
    """The controller of the motion."""


def arm() -> Robot:
    """A planar arm with two joints in a vertical plane; every parameter that matters has an a-priori value."""
    return Robot.from_text(_ARM, name="the twin")


def reference(n: int, seconds: float, sample_rate_hz: float) -> Array:
    """A smooth exciting motion from rest, shape (samples, n), rad: cosines of three frequencies for each joint."""
    time = np.arange(round(seconds * sample_rate_hz)) / sample_rate_hz
    motion = np.zeros((len(time), n))
    for joint in range(n):
        for number, amplitude in enumerate((0.6, 0.25, 0.08)):
            pulsation = (1.1 + 1.7 * number) * (1.0 + 0.37 * joint)
            motion[:, joint] += amplitude * (1.0 - np.cos(pulsation * time))
    return motion


def twin(
    robot: Robot | None = None,
    *,
    seconds: float = 20.0,
    sample_rate_hz: float = 1000.0,
    bandwidth_hz: float = 10.0,
    encoder_counts_per_turn: float = 2.0**20,
    torque_noise: float = 0.1,
    seed: int = 0,
) -> Twin:
    """Simulate a robot under PD control and record it with noise.

    Parameters
    ----------
    robot : Robot, optional
        The robot with its true parameters as a-priori ones; by default :func:`arm`.
    seconds, sample_rate_hz : float
        Length and rate of the recording.
    bandwidth_hz : float
        Of the controller, with feed-forward of the reference's velocity and acceleration.
    encoder_counts_per_turn : float
        Resolution of the joint positions.
    torque_noise : float
        Standard deviation of the white noise on torques, N m.
    seed : int
        Seed of the noise; the same seed gives the same recording.

    Examples
    --------
    >>> twin().recording
    <thetahat.Recording twin 20000 samples, 2 joints: position, torque, reference>
    """
    robot = arm() if robot is None else robot
    followed = reference(robot.n, seconds, sample_rate_hz)
    controller = PD(bandwidth_hz=bandwidth_hz, velocity_feed_forward=1.0, acceleration_feed_forward=1.0)
    motion = simulate(robot, followed, sample_rate_hz, controller=controller)
    step = 2.0 * math.pi / encoder_counts_per_turn
    noise = np.random.default_rng(seed).normal(0.0, torque_noise, motion.torque.shape)
    recording = Recording(
        name="twin",
        sample_rate_hz=sample_rate_hz,
        position=step * np.round(motion.position / step),
        torque=motion.torque + noise,
        reference=followed,
    )
    return Twin(robot, recording, robot.base_values(), motion, controller)
