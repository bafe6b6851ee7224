"""Frames of pandas: their columns as arrays, and recordings as frames."""

from __future__ import annotations

import os
import re
import tempfile
import zipfile
from collections.abc import Hashable
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas

from ._arguments import described
from ._arrays import Array, float64
from .errors import RecordingError

if TYPE_CHECKING:
    from .recording import Recording
    from .robot import Robot

_FILE = "dataframe.npz"
_TIME_WORDS = re.compile(r"(^|_)(time|t|stamp|timestamp|date|datetime|clock)(_|$)")
_ISO = re.compile(r"\d{4}-\d{2}-\d{2}")
_WORDS = {
    "pos": "position",
    "vel": "velocity",
    "spd": "velocity",
    "trq": "torque",
    "tq": "torque",
    "eff": "effort",
    "ref": "reference",
    "cur": "current",
}
"""Short words of columns, which the reader knows in full."""


def recording_of(frame: Any, robot: Robot, columns: dict[str, Any], name: str) -> Recording:
    """The recording in a frame, whose columns the reader of files recognises."""
    arrays = arrays_of(frame)
    named = [*columns["position"], *columns["torque"], *([columns["time"]] if columns["time"] else [])]
    absent = [column for column in named if column not in arrays]
    if absent:
        raise RecordingError(f"the frame has no numeric column {absent[0]}; it has {' '.join(arrays)}")
    found = _recognised(arrays, robot, columns)
    if len(found) != 1:
        raise RecordingError(f"the frame contains {len(found)} recordings; give the columns of one")
    found[0].name = name
    return found[0]


def _recognised(arrays: dict[str, Array], robot: Robot, columns: dict[str, Any]) -> list[Recording]:
    """The recordings of the columns; if their names are not recognised, of names in full words."""
    try:
        return _read(arrays, robot, columns)
    except RecordingError:
        full = _in_full_words(arrays)
        if columns["position"] or columns["torque"] or columns["time"] or list(full) == list(arrays):
            raise
        try:
            return _read(full, robot, columns)
        except RecordingError:
            pass
        # The error with the names of the caller.
        raise


def _read(arrays: dict[str, Array], robot: Robot, columns: dict[str, Any]) -> list[Recording]:
    from .recording import read_files

    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, _FILE)
        _write(path, arrays)
        try:
            return read_files(robot, [path], columns)
        except RecordingError as error:
            raise RecordingError(str(error).replace(path, "the frame").replace(_FILE, "the frame")) from None


def frame_of(recording: Recording) -> pandas.DataFrame:
    """The samples of a recording as a frame."""
    labels = recording.joints or [str(k + 1) for k in range(recording.position.shape[1])]
    columns: dict[str, Array] = {"time_s": recording.times()}
    for signal in ("position", "velocity", "torque", "reference", "added_signal"):
        array = getattr(recording, signal)
        if array is not None:
            columns |= {_label(label, signal): array[:, k] for k, label in enumerate(labels)}
    for key, array in recording.channels.items():
        single = array.shape[1] == 1
        columns |= {key if single else f"{key}_{k + 1}": array[:, k] for k in range(array.shape[1])}
    return pandas.DataFrame(columns)


def _label(joint: str, signal: str) -> str:
    return f"{signal}_{joint}" if joint.isdigit() else f"{joint}_{signal}"


def arrays_of(frame: Any) -> dict[str, Array]:
    """The numeric columns of a frame as float64; times in seconds."""
    if not isinstance(frame, pandas.DataFrame):
        if not hasattr(frame, "to_pandas"):
            raise TypeError(f"frame must be a pandas.DataFrame, and is {described(frame)}")
        frame = frame.to_pandas()
    if not len(frame):
        raise RecordingError("the frame has no rows")
    frame = _with_stamp(frame)
    arrays: dict[str, Array] = {}
    for column in _with_index(frame).items():
        key, values = _column(*column)
        if values is None:
            continue
        if key in arrays:
            raise RecordingError(f"the frame has several columns {key}")
        arrays[key] = values
    _require_times(arrays)
    return _by_names(arrays, _joint_names(frame))


def _require_times(arrays: dict[str, Array]) -> None:
    """Refuse rows without a time."""
    for name, array in arrays.items():
        is_time = array.ndim == 1 and _TIME_WORDS.search(_plain(name)) is not None
        missing = np.nonzero(np.isnan(array))[0]
        if is_time and len(missing):
            raise RecordingError(f"{name} has no value in row {missing[0]}; leave out such rows: frame.dropna()")


def _joint_names(frame: pandas.DataFrame) -> list[str]:
    """The names in a column that has all names in each row, as in joint states of ROS; empty if there is none."""
    for column, values in frame.items():
        first = values.iloc[0]
        if isinstance(first, (list, tuple, np.ndarray)) and len(first) and all(isinstance(name, str) for name in first):
            if any(list(row) != list(first) for row in values):
                raise RecordingError(f"the names in column {_name(column)} change from row to row; sort the arrays of each row by them")
            return list(first)
    return []


def _by_names(arrays: dict[str, Array], names: list[str]) -> dict[str, Array]:
    """The columns, those of arrays split by the names of their entries."""
    if not names:
        return arrays
    split: dict[str, Array] = {}
    for key, array in arrays.items():
        is_of_joints = array.ndim == 2 and array.shape[1] == len(names)
        split |= {f"{name}_{key}": array[:, k] for k, name in enumerate(names)} if is_of_joints else {key: array}
    return split


def _with_stamp(frame: pandas.DataFrame) -> pandas.DataFrame:
    """The frame, with the seconds and nanoseconds of a ROS header as one time."""
    parts = {re.sub(r"^.*stamp_(sec|nanosec|secs|nsecs)$", r"\1", _plain(_name(column))): column for column in frame.columns}
    for whole, rest in (("sec", "nanosec"), ("secs", "nsecs")):
        if whole in parts and rest in parts:
            seconds = frame[parts[whole]] - frame[parts[whole]].iloc[0] + 1e-9 * frame[parts[rest]]
            return frame.drop(columns=[parts[whole], parts[rest]]).assign(time_s=seconds)
    return frame


def _with_index(frame: pandas.DataFrame) -> pandas.DataFrame:
    """The frame, with its index as a column if that is a time and no column is."""
    names = [_name(column) for column in frame.columns]
    index = frame.index
    # Numbers of rows are no time.
    is_time = isinstance(index, (pandas.DatetimeIndex, pandas.TimedeltaIndex)) or (
        pandas.api.types.is_float_dtype(index.dtype) if index.name is None else bool(_TIME_WORDS.search(str(index.name).lower()))
    )
    if not is_time or any(_TIME_WORDS.search(_plain(name)) for name in names):
        return frame
    return frame.reset_index(names=str(index.name or "time"))


def _name(column: Hashable) -> str:
    """The name of a column; names with several levels are joined."""
    return "_".join(str(level) for level in column if str(level)) if isinstance(column, tuple) else str(column)


def _plain(name: str) -> str:
    """A name in lower case with underscores between its words."""
    return re.sub(r"[^\w\[\]]+", "_", re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name)).lower()


def _column(column: Hashable, values: Any) -> tuple[str, Array | None]:
    """The name of a column and its numbers, or None if it has none."""
    name, kind = _name(column), _kind(values)
    if kind == "text" and _TIME_WORDS.search(_plain(name)):
        values, kind = _dates(values), "date"
    if kind == "date":
        return _seconds_name(name), _seconds(values - values.iloc[0])
    if kind == "duration":
        return _seconds_name(name), _seconds(values)
    if kind == "number":
        is_plain = isinstance(values.dtype, np.dtype)
        return name, float64(name, values.to_numpy()) if is_plain else values.to_numpy(dtype=np.float64, na_value=np.nan)
    return name, _stacked(name, values) if kind == "object" else None


def _kind(values: Any) -> str:
    types = pandas.api.types
    dtype = values.dtype
    if types.is_datetime64_any_dtype(dtype) or str(dtype).startswith(("timestamp[", "date")):
        return "date"
    if types.is_timedelta64_dtype(dtype) or str(dtype).startswith("duration["):
        return "duration"
    if types.is_numeric_dtype(dtype) and not types.is_bool_dtype(dtype):
        return "number"
    first = values.iloc[0]
    if isinstance(first, str):
        return "text"
    return "object" if not types.is_bool_dtype(dtype) else "other"


def _dates(values: Any) -> Any:
    try:
        # Texts of a date leave out a fraction of zero: their formats differ.
        return pandas.to_datetime(values.astype(object), format="ISO8601" if _ISO.match(values.iloc[0]) else None)
    except (ValueError, TypeError) as error:
        raise RecordingError(f"the column {values.name} is text, and not a date: {str(error).splitlines()[0]}") from error


def _seconds(values: Any) -> Array:
    return np.asarray(pandas.to_timedelta(values).dt.total_seconds(), dtype=np.float64)


def _seconds_name(name: str) -> str:
    return name if re.search(r"_s(ec)?$", name) else f"{re.sub(r'_(ms|us|ns)$', '', name)}_s"


def _stacked(name: str, values: Any) -> Array | None:
    """A column of numbers or of arrays of the same length; None for other objects."""
    rows = [np.nan if row is None or row is pandas.NA else row for row in values]
    try:
        return np.array([np.asarray(row, dtype=np.float64) for row in rows])
    except ValueError as error:
        lengths = sorted({np.size(row) for row in rows})
        if len(lengths) > 1 and not isinstance(rows[0], (dict, set)):
            raise RecordingError(f"the arrays in column {name} have different lengths, {lengths[0]} to {lengths[-1]}") from error
        return None
    except TypeError:
        return None


def _in_full_words(arrays: dict[str, Array]) -> dict[str, Array]:
    """The columns with names that the reader knows, such as ``wrist_position_rad`` for ``Wrist.Pos (rad)``."""
    names = [_full(name) for name in arrays]
    return dict(zip(names if len(set(names)) == len(names) else arrays, arrays.values(), strict=True))


def _full(name: str) -> str:
    return "_".join(_WORDS.get(part, part) for part in _plain(name).split("_") if part)


def _write(path: str, arrays: dict[str, Array]) -> None:
    """A NumPy archive; unlike `numpy.savez` with any names."""
    with zipfile.ZipFile(path, "w") as archive:
        for name, array in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
                np.lib.format.write_array(file, np.ascontiguousarray(array), allow_pickle=False)
