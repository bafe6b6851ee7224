"""Arrays for the compiled part: float64, with a row for each sample."""

from __future__ import annotations

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
            stacklevel=4,
        )
    elif array.dtype.kind not in "iuf":
        raise TypeError(f"{name} must hold real numbers, and is {array.dtype}")
    return array.astype(np.float64)


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


def read_only(array: Array) -> Array:
    """A read-only view of the same memory."""
    view = array.view()
    view.flags.writeable = False
    return view
