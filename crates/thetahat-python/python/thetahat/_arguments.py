"""Arguments checked where they come in: their names with a suggestion, their types with the name of the argument."""

from __future__ import annotations

import difflib
import functools
import inspect
import numbers
import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any, ParamSpec, TypeGuard, TypeVar

_P = ParamSpec("_P")
_R = TypeVar("_R")

_SYNONYMS: dict[str, tuple[str, ...]] = {
    "position": ("q", "pos", "angle", "angles", "joint_positions", "qpos"),
    "velocity": ("dq", "qd", "vel", "speed", "joint_velocities", "qvel"),
    "torque": ("effort", "efforts", "tau", "trq", "force", "forces", "moment", "joint_torques", "current"),
    "time": ("t", "stamp", "stamps", "timestamp", "timestamps", "times"),
    "sample_rate_hz": ("fs", "rate", "rate_hz", "sample_rate", "sampling_rate", "frequency", "dt", "hz"),
    "reference": ("ref", "desired", "target", "setpoint", "command", "commanded"),
    "window_s": ("window", "span"),
    "cutoff_hz": ("cutoff", "cut_off", "fc", "bandwidth", "lowpass"),
    "decimation": ("decimate", "downsample", "decimation_factor"),
    "methods": ("method", "algorithm", "solver"),
    "estimators": ("estimator",),
    "recordings": ("recording", "log", "data", "measurements"),
    "threads": ("n_jobs", "workers", "jobs"),
    "progress": ("verbose", "callback"),
    "payloads": ("payload", "load", "loads"),
    "theta": ("parameters", "params"),
}
"""Words of other programs for an argument."""


def suggestion(name: str, known: Iterable[str]) -> str | None:
    """The known name that was probably meant."""
    names = list(known)
    for meant, others in _SYNONYMS.items():
        if meant in names and name.lower() in others:
            return meant
    close = difflib.get_close_matches(name.lower(), names, n=1, cutoff=0.6)
    return close[0] if close else None


def suggesting(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Refuse an unknown keyword with the name that was probably meant."""
    known = [name for name in inspect.signature(function).parameters if name not in ("self", "cls")]
    title = function.__qualname__.removesuffix(".__init__")

    @functools.wraps(function)
    def called(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        for name in kwargs:
            if name not in known:
                raise TypeError(_unknown(title, name, known))
        return function(*args, **kwargs)

    return called


def _unknown(title: str, name: str, known: list[str]) -> str:
    meant = suggestion(name, known)
    hint = f"did you mean {meant}?" if meant else f"its arguments are {', '.join(known)}"
    return f"{title}() has no argument {name}; {hint}"


def described(value: object) -> str:
    """The type of a value, and a short value itself."""
    text = repr(value)
    return f"{type(value).__name__} {text}" if len(text) <= 40 else type(value).__name__


def require(name: str, value: object, kinds: type | tuple[type, ...], expected: str) -> None:
    """Raise a TypeError with the argument's name if the value has another type."""
    if not isinstance(value, kinds):
        raise TypeError(f"{name} must be {expected}, and is {described(value)}")


def is_path(value: object) -> TypeGuard[str | os.PathLike[str]]:
    """Whether a value names a file."""
    return isinstance(value, (str, os.PathLike))


def table(name: str, value: Mapping[str, Any] | None) -> dict[str, Any]:
    """A table of settings, empty for None."""
    require(name, value, (Mapping, type(None)), "a mapping with the keys of an experiment file")
    return dict(value or {})


def tables(name: str, values: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """A list of tables of settings."""
    if isinstance(values, (str, Mapping)) or not isinstance(values, Iterable):
        raise TypeError(f"{name} must be a list of mappings, and is {described(values)}")
    return [table(f"{name}[{k}]", value) for k, value in enumerate(values)]


def number(name: str, value: float | None) -> float | None:
    """A real number, or None."""
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise TypeError(f"{name} must be a number, and is {described(value)}")
    return float(value)


def whole(name: str, value: int | None) -> int | None:
    """A whole number, or None."""
    as_float = number(name, value)
    if as_float is None:
        return None
    if not as_float.is_integer():
        raise ValueError(f"{name} must be a whole number, and is {value}")
    return int(as_float)
