"""Identification from recordings or an experiment file."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

from . import _thetahat
from ._arguments import described, number, require, suggesting, table, tables, whole
from ._estimators import Estimator, callers
from ._filter_choice import Filter, chosen
from ._inputs import Recordings, RobotLike, recordings_of, robot_of
from ._progress import Progress, reporting
from .controllers import Controller
from .errors import SettingsError
from .recording import Recording
from .results import Result
from .robot import Robot

_Table = Mapping[str, Any]


@suggesting
def identify(
    robot: RobotLike,
    recordings: Recordings,
    *,
    methods: str | Sequence[str] = ("idim-ls",),
    estimators: Mapping[str, Estimator] | None = None,
    controller: Controller | _Table | None = None,
    cutoff_hz: float | None = None,
    decimation: int | None = None,
    validation: Recordings = (),
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
    robot : Robot or path
        The robot, or the file of its description.
    recordings : Recording, path, DataFrame or a sequence of these
        The recordings; several form one regression. Columns of files and frames are recognised as by :func:`thetahat.read`.
    methods : str or sequence of str
        ``"idim-ls"``, ``"idim-wls"``, ``"idim-iv"``, ``"idim-piv"``, ``"didim"``, ``"clie"``, ``"cloe"``.
    estimators : mapping, optional
        Your own estimators by name, in addition to the methods: functions of a :class:`thetahat.Regression` that return ``theta``,
        ``(theta, covariance)`` or a :class:`thetahat.Fit`; or linear models of scikit-learn made with ``fit_intercept=False``.
        ``result["name"]`` is its result in the nominal case. It is called again for each part that the cross-validation
        leaves out. Intervals come from its own covariance; verdict, advice and exports do not use it.
    controller : Controller, optional
        The controller of the simulated loop, which all methods except the first two need; ``"idim-iv"`` guesses one without it.
    cutoff_hz, decimation : float and int, optional
        The position filter and the decimation. Give both or neither; then :func:`choose_filter` chooses them, which takes
        seconds. The choice is remembered for the same content.
    validation : as `recordings`
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
    threads = whole("threads", threads)
    if threads is not None and threads < 1:
        raise ValueError(f"threads is {threads}; at least one is needed")
    require("controller", controller, (Controller, Mapping, type(None)), "a controller such as thetahat.PD, or a mapping")
    if not isinstance(progress, bool) and not callable(progress):
        raise TypeError(f"progress must be True, False or a function of the stage, and is {described(progress)}")
    require("estimators", estimators, (Mapping, type(None)), 'a mapping such as {"name": function}')
    names, own = _methods(methods), callers(estimators or {})
    filtering = {"cutoff_hz": number("cutoff_hz", cutoff_hz), "decimation": whole("decimation", decimation)}
    settings: dict[str, Any] = {
        "signal": {**filtering, **table("signal", signal)},
        "parameters": table("parameters", parameters),
        "estimation": {"methods": names, **table("estimation", estimation)},
        "simulation": table("simulation", simulation),
        "controller": controller.settings() if isinstance(controller, Controller) else controller,
        "case": tables("cases", cases),
        "payload": tables("payloads", payloads),
    }
    with reporting(progress) as report_stage:
        known, fitted, held_back = _read(robot, recordings, validation, report_stage)
        _choose_missing(known, fitted, settings, report_stage)
        native = _thetahat.identify(
            known._native, (fitted, held_back), (settings, own), title or known.name, threads, report_stage
        )
    return Result(native, known)


def _methods(methods: str | Sequence[str]) -> list[str]:
    require("methods", methods, (str, Sequence), "names of methods")
    names = [methods] if isinstance(methods, str) else list(methods)
    if not all(isinstance(name, str) for name in names):
        raise TypeError('methods are names; give estimators of your own by name: estimators={"name": ...}')
    return names


def _read(
    robot: RobotLike, recordings: Recordings, validation: Recordings, report_stage: Progress | None
) -> tuple[Robot, list[Recording], list[Recording]]:
    """The robot and the recordings, read if they are files."""
    if report_stage is not None and not isinstance(recordings, Recording):
        report_stage("reading the files")
    known = robot_of(robot)
    return known, recordings_of(known, recordings), recordings_of(known, validation, "validation")


def _choose_missing(
    robot: Robot, recordings: list[Recording], settings: dict[str, Any], report_stage: Progress | None
) -> None:
    """Complete the settings by a filter if they have none. The smoother finds its own cut-off."""
    smooths = settings["signal"].get("position") == "smoother"
    if smooths and settings["signal"]["cutoff_hz"] is None:
        settings["signal"]["cutoff_hz"] = 0.0
    missing = [key for key in ("cutoff_hz", "decimation") if settings["signal"][key] is None]
    if len(missing) == 1 and not smooths:
        given = "decimation" if missing == ["cutoff_hz"] else "cutoff_hz"
        raise SettingsError(f"{given} is given without {missing[0]}: give both, or neither and both are chosen")
    if missing:
        if report_stage is not None:
            report_stage("choosing the filter")
        found = chosen(robot, recordings, settings)
        settings["signal"].update({key: getattr(found, key) for key in missing})


@suggesting
def choose_filter(robot: RobotLike, recordings: Recordings, *, parameters: _Table | None = None) -> Filter:
    """The filter with the smallest error of IDIM-LS estimates, on simulated twins of the longest recording.

    This is the proposal of ``thetahat init``: if no filter can be chosen, the default one with the reason.

    Parameters
    ----------
    robot, recordings
        As for :func:`identify`.
    parameters : mapping, optional
        Which parameters are estimated: the table of that name in an experiment file.
    """
    known = robot_of(robot)
    return chosen(known, recordings_of(known, recordings), {"parameters": table("parameters", parameters), "signal": {}})


@suggesting
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
