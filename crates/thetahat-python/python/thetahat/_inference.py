"""Covariance, intervals and tests of estimates from the numbers of a run."""

from __future__ import annotations

import math

import numpy as np

from . import _thetahat
from ._arrays import Array

_NORMAL_97_5 = 1.959963984540054
"""Quantile of the normal distribution for 95 % intervals."""
_LARGEST_FREEDOM = 1e9


def symmetric(lower: list[float] | None, count: int) -> Array:
    """The matrix (count, count) of its lower triangle, row by row; NaN if there is none."""
    matrix = np.full((count, count), np.nan)
    if lower is not None and len(lower) == count * (count + 1) // 2:
        rows, columns = np.tril_indices(count)
        matrix[rows, columns] = matrix[columns, rows] = lower
    return matrix


def freedom_of(intervals_95: Array, deviations: Array) -> float:
    """Degrees of freedom of the t distribution that 95 % intervals were computed with; infinite for the normal distribution."""
    half_widths = 0.5 * (intervals_95[:, 1] - intervals_95[:, 0])
    known = np.isfinite(half_widths) & (deviations > 0)
    if not known.any():
        return math.nan
    ratio = float(np.median(half_widths[known] / deviations[known]))
    return math.inf if ratio < _NORMAL_97_5 + 1e-6 else _freedom_of_quantile(ratio)


def _freedom_of_quantile(quantile_97_5: float) -> float:
    """The degrees of freedom whose 97.5 % quantile this is, by bisection of their logarithm."""
    low, high = math.log(0.5), math.log(_LARGEST_FREEDOM)
    for _ in range(100):
        middle = 0.5 * (low + high)
        if _thetahat.t_quantile(0.975, math.exp(middle)) > quantile_97_5:
            low = middle
        else:
            high = middle
    freedom = math.exp(low)
    return float(round(freedom)) if abs(freedom - round(freedom)) < 1e-4 * freedom else freedom


def two_sided_quantile(level: float, freedom: float) -> float:
    """Half width of an interval in standard deviations."""
    return _thetahat.t_quantile(0.5 * (1.0 + level), min(freedom, _LARGEST_FREEDOM))


def p_value(t: float, freedom: float) -> float:
    """Probability of a value of t at least as far from zero."""
    if math.isnan(t) or math.isnan(freedom):
        return math.nan
    if math.isinf(freedom):
        return math.erfc(abs(t) / math.sqrt(2.0))
    return _thetahat.f_probability(t * t, 1.0, freedom)


def level_of(level: float, alpha: float | None) -> float:
    """The level of an interval from the level or from ``alpha = 1 - level``."""
    if alpha is not None:
        level = 1.0 - alpha
    if not 0.0 < level < 1.0:
        raise ValueError(f"level is {level}; it is a probability, such as 0.95")
    if level < 0.5:
        raise ValueError(f"level is {level:g}, which gives {100 * level:g} % intervals; for {100 * (1 - level):g} % give alpha={level:g}")
    return level
