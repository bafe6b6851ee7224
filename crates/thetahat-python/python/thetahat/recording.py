"""Recordings: arrays of positions, torques and other signals."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence

from numpy.typing import ArrayLike

from . import _thetahat
from ._arrays import Array, read_only, samples, vector
from .errors import RecordingError
from .robot import Robot


class Recording:
    """Positions and torques of the joints, sampled at times or at a rate.

    Arrays of float64 are not copied: a recording has read-only views of them. Do not change them while
    it is in use. NumPy arrays, pandas frames and everything that :func:`numpy.asarray` accepts can be used; one index is one joint.

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

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(1000) / 1000
    >>> q = np.column_stack([np.sin(t), np.cos(t)])
    >>> log = Recording(time=t, position=q, torque=0.1 * q)
    >>> log
    <thetahat.Recording 1000 samples, 2 joints: position, torque, time>
    >>> np.shares_memory(log.position, q)
    True
    """

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
    ) -> None:
        if time is None and sample_rate_hz is None:
            raise RecordingError("a recording needs its time or its sample_rate_hz")
        self.position: Array = read_only(samples("position", position))
        count, joints = self.position.shape
        self.torque = _like("torque", torque, joints, count)
        self.reference = _like("reference", reference, joints, count)
        self.velocity = _like("velocity", velocity, joints, count)
        self.added_signal = _like("added_signal", added_signal, joints, count)
        others = channels or {}
        self.channels = {key: _long("channels." + key, samples("channels." + key, others[key]), count) for key in others}
        self.time: Array | None = None
        if time is not None:
            stamps = vector("time", time)
            # Time stamps of a resampled file are those of the file.
            self.time = read_only(stamps) if sample_rate_hz is not None else _long("time", stamps, count)
        self.sample_rate_hz = None if sample_rate_hz is None else float(sample_rate_hz)
        self.torque_hold_s = float(torque_hold_s)
        self.name = name
        self.weight = float(weight)
        self.window_s = window_s
        self.payload = payload
        self.gaps = [(int(start), int(end)) for start, end in gaps]
        self.geared = geared

    def __len__(self) -> int:
        return int(self.position.shape[0])

    def __repr__(self) -> str:
        optional = ("torque", "reference", "velocity", "added_signal", "time")
        held = ", ".join(["position", *(key for key in optional if getattr(self, key) is not None), *self.channels])
        name = f" {self.name}" if self.name else ""
        return f"<thetahat.Recording{name} {len(self)} samples, {self.position.shape[1]} joints: {held}>"


def _like(name: str, values: ArrayLike | None, joints: int, count: int) -> Array | None:
    if values is None:
        return None
    array = samples(name, values)
    if array.shape[1] != joints:
        raise RecordingError(f"{name} has {array.shape[1]} columns and position has {joints}: one for each joint")
    return _long(name, array, count)


def _long(name: str, array: Array, count: int) -> Array:
    if array.shape[0] != count:
        raise RecordingError(f"{name} has {array.shape[0]} samples and position has {count}")
    return read_only(array)


def _names(names: Sequence[str]) -> list[str]:
    """Names as a list; a text is one name."""
    return [names] if isinstance(names, str) else list(names)


def read_all(
    *files: str | os.PathLike[str],
    robot: Robot,
    position: Sequence[str] = (),
    torque: Sequence[str] = (),
    joints: Sequence[str] = (),
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
    paths = [os.path.abspath(os.fspath(file)) for file in files]
    folder = os.path.commonpath([os.path.dirname(path) for path in paths])
    columns = {
        "position": _names(position),
        "torque": _names(torque),
        "joints": _names(joints),
        "time": time,
        "sample_rate_hz": sample_rate_hz,
        "position_unit": position_unit,
        "torque_unit": torque_unit,
    }
    relative = [os.path.relpath(path, folder) for path in paths]
    return [Recording(**found) for found in _thetahat.read_recordings(robot._native, relative, folder, columns)]


def read(
    *files: str | os.PathLike[str],
    robot: Robot,
    position: Sequence[str] = (),
    torque: Sequence[str] = (),
    joints: Sequence[str] = (),
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
