"""Arrays for the compiled part: float64, with a row for each sample."""

from __future__ import annotations

import os
import sys
import warnings
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import PrecisionWarning

Array = NDArray[np.float64]


def float64(name: str, values: ArrayLike) -> Array:
    """The values as float64, copied only if they have another type.

    Integers are exact. Floats of lower precision are converted with a :class:`PrecisionWarning`, anything else is refused.
    """
    array: NDArray[Any] = np.asarray(values)
    if array.dtype == np.float64:
        return array
    if array.dtype.kind == "f" and array.dtype.itemsize < 8:
        warnings.warn(
            f"{name} is {array.dtype} and was converted to float64: positions with this precision give coarse velocities; "
            "log in float64, or convert the array yourself if the precision suffices",
            PrecisionWarning,
            stacklevel=_caller_level(),
        )
    elif array.dtype.kind not in "iuf":
        raise TypeError(f"{name} must hold real numbers, and is {array.dtype}")
    return array.astype(np.float64)


def _caller_level() -> int:
    """The `stacklevel` of the first caller outside the package, for a warning of the function that calls this."""
    package, level, frame = os.path.dirname(__file__), 1, sys._getframe(1)
    while frame.f_back is not None and os.path.dirname(frame.f_code.co_filename) == package:
        frame, level = frame.f_back, level + 1
    return level


def samples(name: str, values: ArrayLike, columns: int | None = None) -> Array:
    """An array with a row for each sample and a column for each channel; one index is one channel."""
    array = float64(name, values)
    if array.ndim == 1:
        array = array[:, np.newaxis]
    if array.ndim != 2 or array.shape[1] == 0:
        raise ValueError(f"{name} must have a row for each sample and a column for each joint, and has shape {array.shape}")
    if columns is not None and array.shape[1] != columns:
        raise ValueError(f"{name} must have {columns} columns, one for each joint of the robot, and has {array.shape[1]}")
    return array


def states(n: int, **arrays: ArrayLike) -> tuple[bool, list[Array]]:
    """Arrays of one state (n) or of several (samples, n), all with the same number; also whether they are one state."""
    converted = {name: float64(name, values) for name, values in arrays.items()}
    first = next(iter(converted))
    shape = converted[first].shape
    if shape not in ((n,), (shape[0] if shape else -1, n)):
        raise ValueError(f"{first} must have shape ({n},) or (samples, {n}), and has {shape}")
    for name, array in converted.items():
        if array.shape != shape:
            raise ValueError(f"{name} has shape {array.shape}, and {first} has {shape}")
    single = len(shape) == 1
    return single, [array[np.newaxis, :] if single else array for array in converted.values()]


def vector(name: str, values: ArrayLike, length: int | None = None) -> Array:
    """An array with one index."""
    array = float64(name, values)
    if array.ndim != 1 or (length is not None and array.shape[0] != length):
        expected = "one index" if length is None else f"shape ({length},)"
        raise ValueError(f"{name} must have {expected}, and has shape {array.shape}")
    return array


def frozen(array: Array) -> Array:
    """A read-only array that no other code can change: a copy, except of arrays that are already read-only."""
    own = array if _is_frozen(array) else array.copy(order="K")
    own.flags.writeable = False
    return own


def _is_frozen(array: object) -> bool:
    """Whether neither the array nor one that it is a view of can be written to."""
    while isinstance(array, np.ndarray):
        if array.flags.writeable:
            return False
        array = array.base
    return True
