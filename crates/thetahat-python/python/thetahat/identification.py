"""Identification from recordings or an experiment file."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from . import _thetahat
from ._estimators import Estimator, callers
from ._progress import Progress, reporting
from .controllers import Controller
from .errors import SettingsError
from .recording import Recording
from .results import Result
from .robot import Robot

_Table = Mapping[str, Any]
_Recordings = Recording | Sequence[Recording]


class Filter(NamedTuple):
    """A cut-off of the position filter with a decimation, and the reason for the choice."""

    cutoff_hz: float
    """Cut-off of the Butterworth filter of the positions, Hz."""
    decimation: int
    """One in this many samples is kept, after the parallel filter."""
    reasons: tuple[str, ...] = ()
    """The reasons for the choice, line by line."""


def identify(
    robot: Robot,
    recordings: _Recordings,
    *,
    methods: Sequence[str] = ("idim-ls",),
    estimators: Mapping[str, Estimator] | None = None,
    controller: Controller | _Table | None = None,
    cutoff_hz: float | None = None,
    decimation: int | None = None,
    validation: _Recordings = (),
    signal: _Table | None = None,
    parameters: _Table | None = None,
    estimation: _Table | None = None,
    simulation: _Table | None = None,
    cases: Sequence[_Table] = (),
    payloads: Sequence[_Table] = (),
    title: str | None = None,
    threads: int | None = None,
    progress: bool | Progress = False,
) -> Result:
    """Identify the dynamic parameters of a robot.

    Parameters
    ----------
    robot : Robot
        The robot.
    recordings : Recording or sequence of Recording
        The recordings; several form one regression.
    methods : str or sequence of str
        ``"idim-ls"``, ``"idim-wls"``, ``"idim-iv"``, ``"didim"``, ``"clie"``, ``"cloe"``.
    estimators : mapping, optional
        Your own estimators by name, in addition to the methods: functions of a :class:`thetahat.Regression` that return ``theta``,
        ``(theta, covariance)`` or a :class:`thetahat.Fit`; or linear models of scikit-learn made with ``fit_intercept=False``.
        ``result["name"]`` is its result in the nominal case. It is called again for each part that the cross-validation
        leaves out. Intervals come from its own covariance; verdict, advice and exports do not use it.
    controller : Controller, optional
        The controller of the simulated loop, which all methods except the first two need; ``"idim-iv"`` guesses one without it.
    cutoff_hz, decimation : float and int, optional
        The position filter and the decimation. Give both or neither; then :func:`choose_filter` chooses them, which takes seconds.
    validation : Recording or sequence of Recording
        Recordings held back for validation.
    signal, parameters, estimation, simulation : mapping, optional
        Further keys of the tables of these names in an experiment file, such as ``parameters={"physical": True}`` or
        ``estimation={"weighting": {"idim-iv": "per-joint"}}``.
    cases, payloads : sequence of mapping
        The ``[[case]]`` and ``[[payload]]`` tables of an experiment file.
    title : str, optional
        The title; by default the robot's name.
    threads : int, optional
        Threads for simulations; by default one for each processor. The results do not depend on their number.
    progress : bool or callable
        True shows the progress, by tqdm if it is installed; a callable receives each stage.

    Returns
    -------
    Result
        A method that does not converge is not an error: its run has that status.

    Raises
    ------
    SettingsError
        For settings or recordings that cannot be used; keys are those of an experiment file.
    RecordingError
        For time stamps that cannot be used.
    EstimationError
        For your own estimator that fails, with its name; ``__cause__`` is its exception.

    Examples
    --------
    >>> import numpy as np
    >>> import thetahat as th
    >>> twin = th.testing.twin(seconds=10, seed=1)
    >>> def ridge(regression):
    ...     X, y = regression.X, regression.y
    ...     return np.linalg.solve(X.T @ X + 1e-3 * np.eye(X.shape[1]), X.T @ y)
    >>> result = th.identify(twin.robot, twin.recording, estimators={"ridge": ridge}, cutoff_hz=40, decimation=10)
    >>> bool(abs(result["ridge"]["fv1"].estimate - twin.truth["fv1"]) < 0.1)
    True
    """
    if threads is not None and threads < 1:
        raise ValueError(f"threads is {threads}; at least one is needed")
    names = [methods] if isinstance(methods, str) else list(methods)
    if not all(isinstance(name, str) for name in names):
        raise TypeError('methods are names; give estimators of your own by name: estimators={"name": ...}')
    own = callers(estimators or {})
    table = {"methods": names, **(estimation or {})}
    settings: dict[str, Any] = {
        "parameters": dict(parameters or {}),
        "estimation": table,
        "simulation": dict(simulation or {}),
        "controller": controller.settings() if isinstance(controller, Controller) else controller,
        "case": [dict(case) for case in cases],
        "payload": [dict(payload) for payload in payloads],
    }
    all_recordings = _list(recordings)
    settings["signal"] = {"cutoff_hz": cutoff_hz, "decimation": decimation, **(signal or {})}
    missing = [key for key in ("cutoff_hz", "decimation") if settings["signal"][key] is None]
    if len(missing) == 1:
        given = "decimation" if missing == ["cutoff_hz"] else "cutoff_hz"
        raise SettingsError(f"{given} is given without {missing[0]}: give both, or neither and both are chosen")
    if missing:
        chosen = _chosen(robot, all_recordings, settings)
        settings["signal"].update(cutoff_hz=chosen.cutoff_hz, decimation=chosen.decimation)
    with reporting(progress) as report_stage:
        native = _thetahat.identify(
            robot._native, (all_recordings, _list(validation)), (settings, own), title or robot.name, threads, report_stage
        )
    return Result(native, robot)


def choose_filter(robot: Robot, recordings: _Recordings, *, parameters: _Table | None = None) -> Filter:
    """The filter with the smallest error of IDIM-LS estimates, on simulated twins of the longest recording.

    This is the proposal of ``thetahat init``: if no filter can be chosen, the default one with the reason.

    Parameters
    ----------
    robot, recordings
        As for :func:`identify`.
    parameters : mapping, optional
        Which parameters are estimated: the table of that name in an experiment file.
    """
    return _chosen(robot, _list(recordings), {"parameters": dict(parameters or {}), "signal": {}})


def _chosen(robot: Robot, recordings: list[Recording], settings: dict[str, Any]) -> Filter:
    # The choice ignores the filter of the settings, which must exist.
    signal = {**settings["signal"], "cutoff_hz": 1.0, "decimation": 1}
    cutoff_hz, decimation, reasons = _thetahat.choose_filter(robot._native, recordings, {**settings, "signal": signal})
    return Filter(cutoff_hz, decimation, tuple(reasons))


def run(
    experiment: str | os.PathLike[str],
    *,
    data: str | os.PathLike[str] | None = None,
    robot: str | os.PathLike[str] | None = None,
    progress: bool | Progress = False,
) -> Result:
    """Run an experiment file, as ``thetahat identify`` does: the results are the same to the last bit.

    Parameters
    ----------
    experiment : path
        The experiment file.
    data : path, optional
        The folder of the data; by default that of the experiment file.
    robot : path, optional
        A robot description instead of the one in the experiment.
    progress : bool or callable
        As for :func:`identify`.

    Raises
    ------
    ExperimentError, RobotError, RecordingError
        With file, place and remedy.
    """
    path = os.fspath(experiment)
    folder = os.path.dirname(path) if data is None else os.fspath(data)
    with reporting(progress) as report_stage:
        native, native_robot = _thetahat.run(path, folder, None if robot is None else os.fspath(robot), report_stage)
    return Result(native, Robot(native_robot))


def _list(recordings: _Recordings) -> list[Recording]:
    return [recordings] if isinstance(recordings, Recording) else list(recordings)
