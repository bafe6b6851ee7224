"""The user's own estimators, as the compiled part calls them."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import Array, vector
from ._thetahat import Fit


class Regression(NamedTuple):
    """The rows ``y = X theta + e`` for your own estimator."""

    X: Array
    """Observation matrix, shape (rows, parameters); each row is multiplied by the weight of its recording."""
    y: Array
    """Torques, shape (rows,), N m or N, with the same weights."""
    Z: Array | None
    """Instruments with the rows of `X`, if ``"idim-iv"`` is one of the methods and has converged: the observation matrix of
    its last simulation."""
    joint: NDArray[np.intp]
    """The joint of each row, from zero: rows are ordered by joint, then by time."""
    recording: NDArray[np.intp]
    """The recording of each row, from zero."""
    share: Array
    """The share of each row that remains after samples near rest are left out. A variance of the residual divides by
    ``sum(share**2) - parameters``."""
    names: tuple[str, ...]
    """Names of the parameters, in the order of the columns."""
    units: tuple[str, ...]
    """Their units."""


@runtime_checkable
class Fitted(Protocol):
    """A linear model of scikit-learn: ``fit(X, y)`` stores its parameters in ``coef_``."""

    def fit(self, X: Array, y: Array, /) -> Any:
        """Estimate from rows."""


Estimator = Callable[[Regression], Any] | Fitted
"""A function of a :class:`Regression` that returns ``theta``, ``(theta, covariance)`` or a :class:`thetahat.Fit`, or a linear model
of scikit-learn."""

_Called = Callable[[tuple[Any, ...]], tuple[Array, Array | None]]


def callers(estimators: Mapping[str, Estimator]) -> list[tuple[str, _Called]]:
    """Functions of the compiled part's arrays by name, which return parameters and their covariance."""
    return [(name, _caller(name, estimator)) for name, estimator in estimators.items()]


def _caller(name: str, estimator: Estimator) -> _Called:
    if isinstance(estimator, type) or not (callable(estimator) or isinstance(estimator, Fitted)):
        raise TypeError(
            f"the estimator {name} must be a function of the regression, or an object with fit(X, y) and coef_, and is {estimator!r}"
        )

    def call(rows: tuple[Any, ...]) -> tuple[Array, Array | None]:
        X, y, Z, joint, recording, share, names, units = rows
        of_rows = np.asarray(joint, dtype=np.intp), np.asarray(recording, dtype=np.intp)
        regression = Regression(X, y, Z, *of_rows, share, tuple(names), tuple(units))
        if isinstance(estimator, Fitted):
            return _coefficients(estimator, regression), None
        return _returned(estimator(regression))

    return call


def _coefficients(estimator: Fitted, regression: Regression) -> Array:
    """The coefficients of a copy of the model, so that calls are independent."""
    model = copy.deepcopy(estimator)
    model.fit(regression.X, regression.y)
    if not hasattr(model, "coef_"):
        raise TypeError(f"{type(model).__name__} has no coef_ after fit(X, y): give a linear model, or a function of the regression")
    if np.any(np.asarray(getattr(model, "intercept_", 0.0)) != 0.0):
        raise ValueError(f"{type(model).__name__} has an intercept, which is physically impossible: create it with fit_intercept=False")
    return vector("coef_", model.coef_)


def _returned(found: Any) -> tuple[Array, Array | None]:
    if isinstance(found, Fit):
        return found.theta, found.covariance
    if isinstance(found, tuple) and len(found) == 2 and (found[1] is None or np.ndim(found[1]) == 2):
        theta, covariance = found
        return _vector(theta), None if covariance is None else np.array(covariance, dtype=np.float64)
    return _vector(found), None


def _vector(theta: ArrayLike) -> Array:
    try:
        return vector("what it returned", theta)
    except (TypeError, ValueError) as error:
        raise TypeError(f"{error}: return theta with one number for each parameter, or (theta, covariance)") from error
