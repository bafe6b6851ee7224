"""The choice of the filter, made once for the same robot, recordings and settings."""

from __future__ import annotations

import json
import threading
from collections import OrderedDict
from typing import Any, NamedTuple

from . import _thetahat
from .recording import Recording
from .robot import Robot


class Filter(NamedTuple):
    """A cut-off of the position filter with a decimation, and the reason for the choice."""

    cutoff_hz: float
    """Cut-off of the Butterworth filter of the positions, Hz."""
    decimation: int
    """One in this many samples is kept, after the parallel filter."""
    reasons: tuple[str, ...] = ()
    """The reasons for the choice, line by line."""


_KEPT = 32
_known: OrderedDict[str, Filter] = OrderedDict()
_lock = threading.Lock()


def chosen(robot: Robot, recordings: list[Recording], settings: dict[str, Any]) -> Filter:
    """The filter for recordings; the choice of the last few recordings is remembered by the digest of their content."""
    key = _key(robot, recordings, settings)
    with _lock:
        if key in _known:
            _known.move_to_end(key)
            return _known[key]
    # The choice ignores the filter of the settings, which must exist.
    signal = {**settings["signal"], "cutoff_hz": 1.0, "decimation": 1}
    cutoff_hz, decimation, reasons = _thetahat.choose_filter(robot._native, recordings, {**settings, "signal": signal})
    found = Filter(cutoff_hz, decimation, tuple(reasons))
    with _lock:
        _known[key] = found
        while len(_known) > _KEPT:
            _known.popitem(last=False)
    return found


def _key(robot: Robot, recordings: list[Recording], settings: dict[str, Any]) -> str:
    """Everything that the choice depends on: it is made for IDIM-LS, whatever the methods and cases are."""
    relevant = {key: _given(value) for key, value in settings.items() if key != "case"}
    relevant.get("estimation", {}).pop("methods", None)
    relevant = {key: value for key, value in relevant.items() if value}
    digests = [recording._digest() for recording in recordings]
    return json.dumps([repr(robot._native.__reduce__()[1]), digests, relevant], sort_keys=True, default=repr)


def _given(value: Any) -> Any:
    """A table without the keys that are not given."""
    return {key: one for key, one in value.items() if one is not None} if isinstance(value, dict) else value
