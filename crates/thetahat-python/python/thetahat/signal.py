"""Filters, derivatives and decimation without delay: from recorded positions to the observation matrix."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _thetahat
from ._arrays import Array, float64, samples

_Kind = Literal["nine-point", "central"]


class Motion(NamedTuple):
    """A motion, each array of shape (samples, n)."""

    position: Array
    """rad or m."""
    velocity: Array
    """rad/s or m/s."""
    acceleration: Array
    """rad/s^2 or m/s^2."""


def band_pass(
    position: ArrayLike, sample_rate_hz: float, cutoff_hz: float, *, order: int = 4, derivative: _Kind = "nine-point"
) -> Motion:
    """Filter positions by a Butterworth low-pass, forward and backward, and differentiate them twice.

    Parameters
    ----------
    position : array_like (samples, n)
        Positions, rad or m.
    sample_rate_hz, cutoff_hz : float
        Samples per second and the filter's cut-off.
    order : int
        Order of the filter.
    derivative : {"nine-point", "central"}
        The differentiation formula.

    Raises
    ------
    SignalError
        For a cut-off beyond half the sample rate, or a recording shorter than the filter's ends.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(400) / 100
    >>> motion = band_pass(0.5 * t**2, 100, 10)
    >>> bool(abs(motion.acceleration[200, 0] - 1) < 1e-6)
    True
    """
    return Motion(*_thetahat.band_pass(samples("position", position), sample_rate_hz, cutoff_hz, order, derivative))


def zero_phase(values: ArrayLike, sample_rate_hz: float, cutoff_hz: float, *, order: int = 4) -> Array:
    """Filter by a Butterworth low-pass, forward and backward with MATLAB's padding; the shape is that of `values`.

    Raises
    ------
    SignalError
        As for :func:`band_pass`.
    """
    shape = np.shape(values)
    return _thetahat.zero_phase(samples("values", values), sample_rate_hz, cutoff_hz, order).reshape(shape)


def derivative(values: ArrayLike, sample_rate_hz: float, *, kind: _Kind = "nine-point") -> Array:
    """The time derivative of each column, in its unit per second; the shape is that of `values`, of two samples or more.

    Examples
    --------
    >>> derivative([0.0, 0.5, 1.0, 1.5], 10.0, kind="central")
    array([5., 5., 5., 5.])
    """
    array = float64("values", values)
    if array.shape[0] < 2:
        raise ValueError("a derivative needs two samples")
    return _thetahat.derivative(samples("values", array), sample_rate_hz, kind).reshape(array.shape)


def decimate(values: ArrayLike, factor: int) -> Array:
    """The parallel filter and every `factor`-th sample, shape (ceil(samples / factor), ...); the last sample is kept.

    Torques and every column of an observation matrix are processed alike, so that ``y = X theta`` still holds.

    Raises
    ------
    SignalError
        For a factor of zero, or a recording shorter than the filter's ends.
    """
    array = float64("values", values)
    decimated = _thetahat.decimate(samples("values", array), factor)
    return decimated[:, 0] if array.ndim == 1 else decimated
