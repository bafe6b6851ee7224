"""Recordings: arrays of positions, torques and other signals."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _thetahat
from ._arguments import described, is_path, require, suggesting
from ._arrays import Array, frozen, samples, vector
from .errors import RecordingError
from .robot import Robot

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

_Names = str | Sequence[str]
_SIGNALS = ("position", "velocity", "torque", "reference", "added_signal")


class Recording:
    """Positions and torques of the joints, sampled at times or at a rate.

    Arrays are copied, and those of the recording are read-only: later changes of yours do not change it. Arrays that are
    already read-only are not copied. NumPy arrays, pandas frames and everything that :func:`numpy.asarray` accepts can be used;
    one index is one joint. :meth:`from_dataframe` finds the columns of a whole frame by their names.

    ``recording[1000:3000]`` is a part of it, without a copy.

    Parameters
    ----------
    position : array_like (samples, n)
        Positions of the joints, rad or m.
    torque : array_like (samples, n), optional
        Torques of the joints, N m or N. Without them only ``"cloe"`` estimates.
    time : array_like (samples,), optional
        Times, s. Steps may vary by up to half of the usual step; longer steps are gaps. Without `sample_rate_hz` they
        are resampled to equal steps.
    sample_rate_hz : float, optional
        Samples per second of arrays at equal steps.
    reference : array_like (samples, n), optional
        The reference of the controller, rad or m.
    velocity : array_like (samples, n), optional
        Velocities, which the checks compare with the positions.
    added_signal : array_like (samples, n), optional
        A signal that was added to the drive signals after the controller; the torques include it.
    channels : mapping, optional
        Other channels by name, for torque terms: (samples,) or (samples, n).
    torque_hold_s : float
        Hold time of the recorded torques, s, for example of a sampled controller.
    name : str
        Its name in tables and messages.
    weight : float
        Weight of its rows relative to those of other recordings.
    window_s : tuple
        Start and end of the part that is used, s.
    payload : str, optional
        The payload of the robot, by its name in the settings.
    gaps : sequence of (start, end)
        Ranges of samples that were not recorded, for arrays at equal steps.
    geared : bool
        Whether positions or torques were converted by the transmission.
    joints : sequence of str
        Names of the joints, for tables and figures.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(1000) / 1000
    >>> q = np.column_stack([np.sin(t), np.cos(t)])
    >>> log = Recording(time=t, position=q, torque=0.1 * q)
    >>> log
    <thetahat.Recording 1000 samples, 2 joints: position, torque, time>
    >>> len(log[100:300])
    200
    """

    @suggesting
    def __init__(
        self,
        *,
        position: ArrayLike,
        torque: ArrayLike | None = None,
        time: ArrayLike | None = None,
        sample_rate_hz: float | None = None,
        reference: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        added_signal: ArrayLike | None = None,
        channels: Mapping[str, ArrayLike] | None = None,
        torque_hold_s: float = 0.0,
        name: str = "",
        weight: float = 1.0,
        window_s: tuple[float | None, float | None] = (None, None),
        payload: str | None = None,
        gaps: Sequence[tuple[int, int]] = (),
        geared: bool = False,
        joints: Sequence[str] = (),
    ) -> None:
        if time is None and sample_rate_hz is None:
            raise RecordingError("a recording needs its time or its sample_rate_hz")
        self.position: Array = frozen(samples("position", position))
        shape = self.position.shape
        self.torque = _like("torque", torque, shape)
        self.reference = _like("reference", reference, shape)
        self.velocity = _like("velocity", velocity, shape)
        self.added_signal = _like("added_signal", added_signal, shape)
        others = channels or {}
        self.channels = {key: _long("channels." + key, samples("channels." + key, others[key]), shape[0]) for key in others}
        self.time: Array | None = None
        if time is not None:
            stamps = vector("time", time)
            # Time stamps of a resampled file are those of the file.
            self.time = frozen(stamps) if sample_rate_hz is not None else _long("time", stamps, shape[0])
        self.sample_rate_hz = None if sample_rate_hz is None else float(sample_rate_hz)
        self.torque_hold_s = float(torque_hold_s)
        self.name = name
        self.weight = float(weight)
        self.window_s = window_s
        self.payload = payload
        self.gaps = [(int(start), int(end)) for start, end in gaps]
        self.geared = geared
        self.joints = _joints(joints, shape[1])

    @classmethod
    def from_dataframe(
        cls,
        frame: pandas.DataFrame,
        *,
        robot: Robot,
        position: _Names = (),
        torque: _Names = (),
        joints: _Names = (),
        time: str | None = None,
        sample_rate_hz: float | None = None,
        position_unit: str | None = None,
        torque_unit: str | None = None,
        name: str = "",
    ) -> Recording:
        """Make a recording from a frame, whose columns are recognised by their names as by :func:`read`.

        Names are those of joints with a word for the signal, in any order, such as ``shoulder_position`` and
        ``effort_shoulder``; or one column for each signal with an array in each row. Times are seconds, or dates and
        durations of pandas; an index of dates or durations is a time. Nullable and Arrow types are read as float64, others
        than numbers are left out.

        Parameters
        ----------
        frame : pandas.DataFrame
            A row for each sample. Frames with a method ``to_pandas`` (polars, pyarrow) are converted.
        robot : Robot
            The robot, whose order the joints get.
        position, torque, joints, time, sample_rate_hz, position_unit, torque_unit
            What the names do not show, as for :func:`read_all`.
        name : str
            Name of the recording.

        Raises
        ------
        RecordingError
            If columns cannot be recognised; the message lists them.
        """
        from ._frames import recording_of

        columns = _columns(position, torque, joints, time, sample_rate_hz, position_unit, torque_unit)
        return recording_of(frame, robot, columns, name)

    def to_pandas(self) -> pandas.DataFrame:
        """The samples as a frame: ``time_s``, then columns such as ``shoulder_position``, in SI units. Needs pandas
        (``pip install thetahat[pandas]``). :meth:`from_dataframe` reads it back."""
        from ._frames import frame_of

        return frame_of(self)

    def plot(self) -> Figure:
        """Positions, velocities and torques over time. Needs matplotlib (``pip install thetahat[plot]``)."""
        from ._figures import recording_figure

        return recording_figure(self)

    def times(self) -> Array:
        """The time of each sample, shape (samples,), s; from zero if the recording has a rate."""
        if self.sample_rate_hz is not None:
            return np.arange(len(self)) / self.sample_rate_hz
        assert self.time is not None
        return self.time

    def __getitem__(self, part: slice) -> Recording:
        if not isinstance(part, slice):
            raise TypeError(f"a recording is indexed by a range of samples such as recording[1000:3000], not by {described(part)}")
        start, stop, step = part.indices(len(self))
        if step != 1:
            raise ValueError("samples are left out by the decimation, after a filter: give a range without a step")
        if stop <= start:
            raise ValueError(f"recording[{part.start}:{part.stop}] has no samples; the recording has {len(self)}")
        return Recording(**{**vars(self), **self._cut(start, stop)})

    def _cut(self, start: int, stop: int) -> dict[str, Any]:
        """The attributes of a part that differ from those of the whole."""
        rows = slice(start, stop)
        cut: dict[str, Any] = {key: None if getattr(self, key) is None else getattr(self, key)[rows] for key in _SIGNALS}
        cut["channels"] = {key: array[rows] for key, array in self.channels.items()}
        inside = [(max(first, start) - start, min(last, stop) - start) for first, last in self.gaps]
        cut["gaps"] = [(first, last) for first, last in inside if first < last]
        if self.sample_rate_hz is None:
            cut["time"] = None if self.time is None else self.time[rows]
        else:
            # Samples at a rate count time from their first one.
            offset = start / self.sample_rate_hz
            cut["time"] = None
            cut["window_s"] = tuple(None if end is None else end - offset for end in self.window_s)
        return cut

    def _digest(self) -> str:
        """A digest of everything that results depend on."""
        digest = hashlib.sha256()
        for key, value in sorted(vars(self).items()):
            if key == "joints":
                continue
            arrays = value if isinstance(value, dict) else {"": value}
            for name, array in arrays.items():
                is_array = isinstance(array, np.ndarray)
                content = np.ascontiguousarray(array).tobytes() if is_array else repr(array).encode()
                digest.update(f"{key} {name} {len(content)} {np.shape(array)}".encode() + content)
        return digest.hexdigest()

    def __len__(self) -> int:
        return int(self.position.shape[0])

    def __repr__(self) -> str:
        optional = ("torque", "reference", "velocity", "added_signal", "time")
        held = ", ".join(["position", *(key for key in optional if getattr(self, key) is not None), *self.channels])
        name = f" {self.name}" if self.name else ""
        return f"<thetahat.Recording{name} {len(self)} samples, {self.position.shape[1]} joints: {held}>"


def _like(name: str, values: ArrayLike | None, shape: tuple[int, ...]) -> Array | None:
    if values is None:
        return None
    array = samples(name, values)
    if array.shape[1] != shape[1]:
        raise RecordingError(f"{name} has {array.shape[1]} columns and position has {shape[1]}: one for each joint")
    return _long(name, array, shape[0])


def _long(name: str, array: Array, count: int) -> Array:
    if array.shape[0] != count:
        raise RecordingError(f"{name} has {array.shape[0]} samples and position has {count}")
    return frozen(array)


def _joints(names: Sequence[str], count: int) -> tuple[str, ...]:
    if names and len(names) != count:
        raise RecordingError(f"joints has {len(names)} names and position has {count} columns")
    return tuple(names)


def _names(names: _Names) -> list[str]:
    """Names as a list; a text is one name."""
    return [names] if isinstance(names, str) else list(names)


def _columns(
    position: _Names,
    torque: _Names,
    joints: _Names,
    time: str | None,
    sample_rate_hz: float | None,
    position_unit: str | None,
    torque_unit: str | None,
) -> dict[str, Any]:
    """What the names of columns do not show, with the keys of the reader."""
    return {
        "position": _names(position),
        "torque": _names(torque),
        "joints": _names(joints),
        "time": time,
        "sample_rate_hz": sample_rate_hz,
        "position_unit": position_unit,
        "torque_unit": torque_unit,
    }


def read_files(robot: Robot, paths: Sequence[str], columns: dict[str, Any]) -> list[Recording]:
    """The recordings in files; the arrays of the reader are not copied."""
    folder = os.path.commonpath([os.path.dirname(path) for path in paths])
    relative = [os.path.relpath(path, folder) for path in paths]
    found = _thetahat.read_recordings(robot._native, relative, folder, columns)
    for arguments in found:
        for array in [*arguments.values(), *arguments["channels"].values()]:
            if isinstance(array, np.ndarray):
                array.flags.writeable = False
    return [Recording(**arguments, joints=robot.joints) for arguments in found]


@suggesting
def read_all(
    *files: str | os.PathLike[str],
    robot: Robot,
    position: _Names = (),
    torque: _Names = (),
    joints: _Names = (),
    time: str | None = None,
    sample_rate_hz: float | None = None,
    position_unit: str | None = None,
    torque_unit: str | None = None,
) -> list[Recording]:
    """Read recordings from files: delimited text, NumPy, MATLAB, Parquet, ROS 2 bags.

    Columns are recognised by their names, as ``thetahat init`` does; pass what the names do not show. The arrays are those
    of the reader, without a copy, in SI, on the side of the joints and at equal steps.

    Parameters
    ----------
    *files : path
        One or several files of one or several recordings.
    robot : Robot
        The robot of the recording.
    position, torque : str or sequence of str
        Columns, one for each joint, or one of a matrix: NAME, FILE or FILE:NAME.
    joints : sequence of str
        The joints of the columns, in the robot's order.
    time : str, optional
        The time column.
    sample_rate_hz : float, optional
        Samples per second, if there is no time column.
    position_unit, torque_unit : str, optional
        Units, such as ``"deg"`` and ``"mN m"``.

    Raises
    ------
    RecordingError
        With file, place and remedy.
    """
    if not files:
        raise RecordingError("no file is given")
    require("robot", robot, Robot, "a thetahat.Robot")
    for file in files:
        if not is_path(file):
            raise TypeError(f"files must be paths, and one is {described(file)}")
    paths = [os.path.abspath(os.fspath(file)) for file in files]
    return read_files(robot, paths, _columns(position, torque, joints, time, sample_rate_hz, position_unit, torque_unit))


@suggesting
def read(
    *files: str | os.PathLike[str],
    robot: Robot,
    position: _Names = (),
    torque: _Names = (),
    joints: _Names = (),
    time: str | None = None,
    sample_rate_hz: float | None = None,
    position_unit: str | None = None,
    torque_unit: str | None = None,
) -> Recording:
    """Read one recording; parameters are those of :func:`read_all`.

    Raises
    ------
    RecordingError
        If the files contain several recordings, and as :func:`read_all`.
    """
    found = read_all(
        *files,
        robot=robot,
        position=position,
        torque=torque,
        joints=joints,
        time=time,
        sample_rate_hz=sample_rate_hz,
        position_unit=position_unit,
        torque_unit=torque_unit,
    )
    if len(found) != 1:
        raise RecordingError(f"the files contain {len(found)} recordings; read them with read_all")
    return found[0]
