"""Robots and recordings as callers give them: objects, paths or frames."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, TypeGuard, Union

import numpy as np

from ._arguments import described, is_path
from .errors import RecordingError, SettingsError
from .recording import Recording, read_all
from .robot import Robot

if TYPE_CHECKING:
    import pandas

Path = str | os.PathLike[str]
RobotLike = Robot | Path
"""A robot, or the path of its description."""
RecordingLike = Union[Recording, Path, "pandas.DataFrame"]
"""A recording, the path of one, or a frame of pandas."""
Recordings = RecordingLike | Sequence[RecordingLike]


def robot_of(robot: RobotLike) -> Robot:
    """The robot, read if it is a path."""
    if isinstance(robot, Robot):
        return robot
    if is_path(robot):
        return Robot.from_file(robot)
    raise TypeError(f"robot must be a thetahat.Robot or the path of its description, and is {described(robot)}")


def recordings_of(robot: Robot, recordings: Recordings, name: str = "recordings") -> list[Recording]:
    """The recordings, read if they are paths or frames; all have the robot's number of joints."""
    if is_recording_like(recordings):
        found = _read(robot, name, recordings)
    elif isinstance(recordings, Iterable) and not isinstance(recordings, (np.ndarray, dict)):
        found = [recording for k, one in enumerate(recordings) for recording in _read(robot, f"{name}[{k}]", one)]
    else:
        raise TypeError(_expected(name, recordings))
    for recording in found:
        _require_joints(robot, recording)
    return found


def is_recording_like(value: object) -> TypeGuard[RecordingLike]:
    """Whether the value is a recording, the path of one, or a frame."""
    return isinstance(value, Recording) or is_path(value) or _is_frame(value)


def one_recording(robot: Robot, recording: RecordingLike, name: str = "recording") -> Recording:
    """The recording; a file with several is refused."""
    found = recordings_of(robot, recording, name)
    if len(found) != 1:
        raise RecordingError(f"{name} has {len(found)} recordings; give one")
    return found[0]


def _read(robot: Robot, name: str, recording: Any) -> list[Recording]:
    if isinstance(recording, Recording):
        return [recording]
    if is_path(recording):
        return read_all(recording, robot=robot)
    if _is_frame(recording):
        return [Recording.from_dataframe(recording, robot=robot)]
    raise TypeError(_expected(name, recording))


def _is_frame(value: object) -> bool:
    return hasattr(value, "columns") and (hasattr(value, "iloc") or hasattr(value, "to_pandas"))


def _expected(name: str, value: object) -> str:
    arrays = ": make one from arrays by thetahat.Recording(time=..., position=..., torque=...)"
    hint = arrays if isinstance(value, (np.ndarray, dict)) else ""
    return f"{name} must be a thetahat.Recording, the path of one, a pandas.DataFrame or a list of these, and is {described(value)}{hint}"


def _require_joints(robot: Robot, recording: Recording) -> None:
    """Refuse a recording of another robot in the words of the library, before a filter is chosen."""
    joints = recording.position.shape[1]
    if joints != robot.n:
        name = f" {recording.name}" if recording.name else ""
        raise SettingsError(
            f"recording{name}, position: number of channels is {joints}, expected {robot.n}, one for each joint of the robot "
            f"({', '.join(robot.joints)}); joints that do not move are locked when the robot is read: locked={{...}}"
        )
