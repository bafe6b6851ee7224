"""Statistics of one parameter over the sessions of a fleet: differences between robots, change over time, scatter.

| letter | word | shape |
| --- | --- | --- |
| ``x, s`` | estimates and their standard deviations | (sessions,) |
| ``w`` | weights, ``1 / s^2`` | (sessions,) |
| ``t`` | times | (sessions,) |
| ``c`` | dispersion: ratio of the scatter to the stated variances, at least 1 | |
| ``nu`` | degrees of freedom of ``c`` | |

Each robot has its own line ``x = a + b (t - mean t)``. The scatter about the lines gives ``c``; where it is above 1, variances are
multiplied by it and tests use F and t with ``nu`` degrees of freedom instead of chi-squared and normal.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import _thetahat
from .._arrays import Array

# Degrees of freedom from which t equals the normal distribution in every printed digit.
_NORMAL = 1e9


class Line(NamedTuple):
    """A robot's estimates of a parameter over time; variances are those of the covariances, not yet dispersed."""

    mean: float
    mean_variance: float
    slope: float
    slope_variance: float
    squares: float
    freedom: int

    @property
    def has_slope(self) -> bool:
        """Whether its sessions have different times."""
        return math.isfinite(self.slope_variance)


class Dispersion(NamedTuple):
    """The scatter of estimates about the robots' lines over their covariances."""

    factor: float
    """Sum of squares by degrees of freedom; NaN without any."""
    freedom: int
    p_value: float
    """The p-value of the chi-squared test that the covariances explain the scatter."""

    @property
    def scale(self) -> float:
        """The factor on variances."""
        return self.factor if self.factor > 1.0 else 1.0

    @property
    def reference_freedom(self) -> float:
        """Degrees of freedom of t and F."""
        return float(self.freedom) if self.factor > 1.0 else _NORMAL


class Test(NamedTuple):
    """A Wald test."""

    statistic: float
    """Chi-squared with the stated variances, otherwise F times the degrees of freedom."""
    freedom: int
    p_value: float
    """NaN without a degree of freedom."""


class Estimate(NamedTuple):
    """A number with its interval."""

    value: float
    low: float
    high: float
    p_value: float
    """That it is zero."""


def line_of(t: Array, x: Array, s: Array) -> Line:
    """Weighted least squares of a robot's sessions; without different times the mean alone."""
    w = s**-2.0
    mean, middle = float(np.sum(w * x) / np.sum(w)), np.sum(w * t) / np.sum(w)
    spread = float(np.sum(w * (t - middle) ** 2))
    moves = np.ptp(t) > 0.0
    slope = float(np.sum(w * (t - middle) * (x - mean)) / spread) if moves else 0.0
    squares = float(np.sum(w * (x - mean - slope * (t - middle)) ** 2))
    freedom = len(x) - (2 if moves else 1)
    variance = 1.0 / spread if moves else math.inf
    return Line(mean, float(1.0 / np.sum(w)), slope, variance, squares if freedom else 0.0, freedom)


def dispersion_of(lines: list[Line]) -> Dispersion:
    """The scatter about all lines."""
    freedom, squares = sum(line.freedom for line in lines), sum(line.squares for line in lines)
    if not freedom:
        return Dispersion(math.nan, 0, math.nan)
    return Dispersion(squares / freedom, freedom, _thetahat.chi_squared_probability(squares, freedom))


def between_robots(lines: list[Line], dispersion: Dispersion) -> Test:
    """Tests whether the robots' means are equal."""
    means, variances = _means(lines, dispersion)
    return _test((means - _weighted(means, variances)) ** 2 / variances, len(lines) - 1, dispersion)


def over_time(lines: list[Line], dispersion: Dispersion) -> Test:
    """Tests whether all robots' slopes are zero."""
    slopes, variances = _slopes(lines, dispersion)
    return _test(slopes**2 / variances, len(slopes), dispersion)


def fleet_mean(lines: list[Line], dispersion: Dispersion) -> Estimate:
    """The mean of all robots, each with the weight of its sessions."""
    means, variances = _means(lines, dispersion)
    return _estimate(_weighted(means, variances), float(1.0 / np.sum(1.0 / variances)), dispersion)


def common_slope(lines: list[Line], dispersion: Dispersion) -> Estimate:
    """The slope that all robots have in common."""
    slopes, variances = _slopes(lines, dispersion)
    if not len(slopes):
        return Estimate(math.nan, math.nan, math.nan, math.nan)
    return _estimate(_weighted(slopes, variances), float(1.0 / np.sum(1.0 / variances)), dispersion)


def slope(line: Line, dispersion: Dispersion) -> Estimate:
    """A robot's slope, with its 95 % interval."""
    return _estimate(line.slope, dispersion.scale * line.slope_variance, dispersion)


def from_the_median(lines: list[Line], dispersion: Dispersion) -> list[Estimate]:
    """The distance of each robot's mean from the median of all, which is robust to a few different robots.

    The variance of the median is taken as that of normal means, and its covariance with the robot's own mean as zero: tests reject less
    than they could, mostly in fleets of few robots.
    """
    means, variances = _means(lines, dispersion)
    median, variance = float(np.median(means)), 0.5 * math.pi * float(np.mean(variances)) / len(lines)
    pairs = zip(means.tolist(), variances.tolist(), strict=True)
    return [_estimate(mean - median, own + variance, dispersion) for mean, own in pairs]


def holm(p_values: list[float]) -> list[float]:
    """P-values for a family of tests: with none below the level, no true hypothesis is refused in 1 - level of all families.

    S. Holm, "A simple sequentially rejective multiple test procedure", Scandinavian Journal of Statistics 6, 1979. NaN is no test.

    Examples
    --------
    >>> holm([0.01, 0.04, float("nan")])
    [0.02, 0.04, nan]
    """
    adjusted = list(p_values)
    order = sorted((k for k, p in enumerate(p_values) if not math.isnan(p)), key=lambda k: p_values[k])
    largest = 0.0
    for rank, k in enumerate(order):
        largest = max(largest, min(1.0, (len(order) - rank) * p_values[k]))
        adjusted[k] = largest
    return adjusted


def _means(lines: list[Line], dispersion: Dispersion) -> tuple[Array, Array]:
    variances = dispersion.scale * np.array([line.mean_variance for line in lines])
    return np.array([line.mean for line in lines]), variances


def _slopes(lines: list[Line], dispersion: Dispersion) -> tuple[Array, Array]:
    moving = [line for line in lines if line.has_slope]
    variances = dispersion.scale * np.array([line.slope_variance for line in moving])
    return np.array([line.slope for line in moving]), variances


def _weighted(values: Array, variances: Array) -> float:
    return float(np.sum(values / variances) / np.sum(1.0 / variances))


def _test(squares: NDArray[np.float64], freedom: int, dispersion: Dispersion) -> Test:
    statistic = float(np.sum(squares))
    if freedom < 1:
        return Test(statistic, 0, math.nan)
    if dispersion.factor > 1.0:
        p_value = _thetahat.f_probability(statistic / freedom, freedom, dispersion.freedom)
    else:
        p_value = _thetahat.chi_squared_probability(statistic, freedom)
    return Test(statistic, freedom, p_value)


def _estimate(value: float, variance: float, dispersion: Dispersion) -> Estimate:
    half = _thetahat.t_quantile(0.975, dispersion.reference_freedom) * math.sqrt(variance)
    p_value = _test(np.array([value**2 / variance]), 1, dispersion).p_value
    return Estimate(value, value - half, value + half, p_value)
