"""The commands of ``thetahat`` as functions of robots, recordings and results.

Where a robot or result is expected, the path of its file can be given. Texts that commands print are returned; the consoles of
Python and notebooks show their lines.
"""

from __future__ import annotations

import csv
import os
import re
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from . import _thetahat
from ._arguments import described, is_path, require, suggesting
from ._arrays import Array
from ._command import locked_of, options, robot_file, run, toml
from ._inputs import Recordings, RobotLike, robot_of
from ._text import Text
from .errors import CommandError, ReductionError
from .identification import identify
from .recording import Recording
from .results import Result
from .robot import Robot

_Path = str | os.PathLike[str]
_Model = Literal[
    "idm", "idm-derivatives", "mass-matrix", "ddm", "regressor", "gravity", "coriolis", "forward-kinematics", "jacobian"
]


class Finding(NamedTuple):
    """Something that a check found in a recording."""

    recording: str
    """Name of the recording."""
    code: str
    """What it is, such as ``"late-torque"`` (:doc:`reference/checks`)."""
    severity: str
    """``"note"``, ``"warning"`` or ``"error"``."""
    joint: str | None
    """Name of the joint, if it belongs to one."""
    message: str
    """The finding with its numbers."""
    remedy: str
    """What to do."""

    def __str__(self) -> str:
        return f"{self.severity} in {self.recording or 'the recording'}: {self.message}; {self.remedy}"


def check(robot: RobotLike, recordings: Recordings, **settings: Any) -> list[Finding]:
    """Check recordings for problems of motion, time, torque and robot.

    Parameters
    ----------
    robot, recordings
        As for :func:`thetahat.identify`.
    **settings
        Those of :func:`thetahat.identify`, such as the controller; without a filter one is chosen.

    Returns
    -------
    list of Finding
        The findings, recording by recording; empty if no problems were found.

    Examples
    --------
    >>> from thetahat import testing
    >>> twin = testing.twin(seconds=10)
    >>> {finding.severity for finding in check(twin.robot, twin.recording, cutoff_hz=40, decimation=10)}
    {'note'}
    """
    found = identify(robot, recordings, **settings).findings
    return [_finding(str(group["recording"]), data) for group in found for data in group["findings"]]


def _finding(recording: str, data: Mapping[str, Any]) -> Finding:
    return Finding(recording, data["code"], data["severity"], data["joint_name"], data["message"], data["remedy"])


@suggesting
def inspect(*files: _Path, robot: RobotLike | None = None) -> Text:
    """The columns of recordings with their ranges and units, and with a robot the experiment proposed for them."""
    if not files:
        raise CommandError("no file is given")
    with tempfile.TemporaryDirectory() as folder:
        return Text(run("inspect", *files, *options(robot=None if robot is None else _file(robot, Path(folder)))).text)


@suggesting
def init(robot: _Path, *recordings: _Path, out: _Path = "experiment.toml", force: bool = False) -> Text:
    """Write the experiment file proposed for a robot and recordings, which :func:`thetahat.run` runs."""
    named = [option for path in recordings for option in ("--recording", os.fspath(path))]
    return Text(run("init", "--robot", robot, *named, *options(out=out, force=force)).text)


class Designed(NamedTuple):
    """A motion to record, with the intervals that it will give."""

    time: Array
    """Shape (samples,), s."""
    position: Array
    """Shape (samples, n), rad or m."""
    velocity: Array
    """rad/s or m/s."""
    acceleration: Array
    """rad/s^2 or m/s^2."""
    predicted: dict[str, float]
    """Half widths of the 95 % intervals by name of the base parameter, SI."""
    text: Text
    """The tables of the command, with the limits and how far they are used."""


@suggesting
def design(
    design: _Path | Mapping[str, Any],
    *,
    robot: RobotLike | None = None,
    out: _Path | None = None,
    threads: int | None = None,
    force: bool = False,
) -> Designed:
    """Design the motion to record: optimal for the base parameters, within the limits of the joints.

    Parameters
    ----------
    design : path or mapping
        A design file, or its content, such as ``{"duration_s": 8, "sample_rate_hz": 500}``.
    robot : Robot or path
        The robot of a mapping.
    out : path, optional
        Folder for the files of the command: the trajectory, its experiment, a page.
    threads : int, optional
        Threads; the result does not depend on them.
    force : bool
        Whether to replace files that thetahat did not write.
    """
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        file = design if is_path(design) else _design_file(design, robot, folder)
        target = folder / "out" if out is None else Path(out)
        text = run("design", file, *options(out=target, threads=threads, force=force)).text
        time, position, velocity, acceleration = _trajectory(target / "trajectory.csv")
        predicted = {row["predicted"]: float(row["half_width_95"]) for row in _rows(target / "predicted.csv")}
    shown = Text(text if out is not None else text.partition("\nwritten:")[0])
    return Designed(time[:, 0], position, velocity, acceleration, predicted, shown)


def _design_file(design: Any, robot: RobotLike | None, folder: Path) -> Path:
    require("design", design, Mapping, "the path of a design file, or a mapping with its keys")
    known = robot_of(design.get("robot") if robot is None else robot)
    table = {"title": known.name, **design, "robot": robot_file(known, folder).name}
    if locked_of(known):
        table["locked"] = locked_of(known)
    path = folder / "design.toml"
    path.write_text(toml(table))
    return path


def _rows(path: Path) -> list[dict[str, str]]:
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def _trajectory(path: Path) -> list[Array]:
    """Time, positions, velocities and accelerations, each with a column for each joint."""
    table = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
    joints = (table.shape[1] - 1) // 3
    return [table[:, :1], *(table[:, 1 + k * joints : 1 + (k + 1) * joints] for k in range(3))]


@suggesting
def generate(
    model_of: RobotLike | Result,
    model: _Model = "idm",
    to: Literal["c", "rust", "python", "matlab", "latex"] = "c",
    *,
    parameters: Literal["symbolic", "values"] | None = None,
    base: bool = False,
    drives: Literal["all", "inertia", "none"] | None = None,
    method: str | None = None,
    name: str | None = None,
    out: _Path | None = None,
    untrusted: bool = False,
    force: bool = False,
) -> Text:
    """Generate code of a robot's model, with the values of a result.

    Parameters
    ----------
    model_of : Robot, Result or path
        The robot, or the result whose estimates are in the code; or a description or ``results.json``.
    model : str
        ``"idm"`` is the inverse, ``"ddm"`` the direct dynamic model.
    to : {"c", "rust", "python", "matlab", "latex"}
        The language.
    parameters : {"symbolic", "values"}, optional
        Whether parameters are an input or values in the code; by default values for results.
    base : bool
        Whether the parameters are the base parameters.
    drives : {"all", "inertia", "none"}, optional
        The torques of the drives that are included.
    method : str, optional
        The method of the estimates; by default the model.
    name : str, optional
        Prefix of the names in the code.
    out : path, optional
        A file for the code.
    untrusted, force : bool
        Whether results whose verdict is ``"do-not-use"`` are used, and files of others replaced.

    Returns
    -------
    Text
        The code.

    Examples
    --------
    >>> from thetahat import testing
    >>> "def arm_gravity(q" in generate(testing.arm(), "gravity", "python", name="arm")
    True
    """
    chosen = options(model=model, to=to, parameters=parameters, base=base, drives=drives, method=method, name=name)
    with tempfile.TemporaryDirectory() as folder:
        path = _file(model_of, Path(folder))
        locks = [f"{joint}={value!r}" for joint, value in locked_of(model_of).items()] if isinstance(model_of, Robot) else []
        output = run("generate", path, *chosen, *options(lock=locks or None, untrusted=untrusted))
    _require_trust(output.code, untrusted)
    if out is not None:
        _write(Path(out), output.text, force)
    return Text(output.text)


@suggesting
def sample(
    result: Result | _Path,
    count: int,
    to: Literal["urdf", "mjcf", "sdf", "json", "pace", "isaac", "bam"] = "urdf",
    *,
    seed: int = 1,
    method: str | None = None,
    into: _Path | None = None,
    out: _Path | None = None,
    untrusted: bool = False,
    force: bool = False,
) -> list[str]:
    """Random robots from the distribution of the estimates, each physically consistent, for domain randomisation.

    Parameters
    ----------
    result : Result or path
        The result, or a ``results.json``.
    count : int
        Number of robots.
    to : {"urdf", "mjcf", "sdf", "json", "pace", "isaac", "bam"}
        The format.
    seed : int
        Seed of the random numbers; the same seed gives the same robots.
    method : str, optional
        The method of the estimates; by default the model.
    into : path, optional
        Your own MJCF file, which gets the inertias, armatures and friction; all else is kept.
    out : path, optional
        Folder for the files.
    untrusted, force : bool
        As for :func:`generate`.

    Returns
    -------
    list of str
        The descriptions.
    """
    chosen = options(to=to, count=count, seed=seed, method=method, into=into, untrusted=untrusted)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) / "samples" if out is None else Path(out)
        output = run("sample", _file(result, Path(temporary)), *chosen, *options(out=folder, force=force))
        _require_trust(output.code, untrusted)
        written = sorted(path for path in folder.iterdir() if path.stem.isdigit())
        return [path.read_text(encoding="utf-8") for path in written[:count]]


@suggesting
def compare(
    *results: Result | _Path, method: str | None = None, case: str = "nominal", out: _Path | None = None, force: bool = False
) -> Text:
    """Compare results with the first: settings that differ, parameters in standard deviations of the difference, errors.

    Parameters
    ----------
    *results : Result or path
        Two or more.
    method, case : str
        The run that is compared; by default the model.
    out : path, optional
        HTML file for the comparison.
    """
    if len(results) < 2:
        raise ValueError(f"compare needs two results or more, and has {len(results)}")
    with tempfile.TemporaryDirectory() as folder:
        files = [_file(result, Path(folder) / str(k)) for k, result in enumerate(results)]
        return Text(run("compare", *files, *options(method=method, case=case, out=out, force=force)).text)


@suggesting
def export(
    result: Result | _Path,
    path: _Path,
    to: str | None = None,
    *,
    method: str | None = None,
    into: _Path | None = None,
    untrusted: bool = False,
    force: bool = False,
) -> list[str]:
    """Write the identified robot as :meth:`thetahat.Result.export` does; also of a ``results.json``.

    Parameters
    ----------
    result : Result or path
        The result, or a ``results.json``.
    path, to, method, untrusted, force
        As for :meth:`thetahat.Result.export`.
    into : path, optional
        Your own MJCF file, which gets the inertias, armatures and friction; all else is kept.

    Returns
    -------
    list of str
        Remarks.
    """
    if into is None:
        return _result(result).export(path, to, method=method, untrusted=untrusted, force=force)
    chosen = options(to=to or "mjcf", method=method, into=into, out=path, untrusted=untrusted, force=force)
    with tempfile.TemporaryDirectory() as folder:
        output = run("export", _file(result, Path(folder)), *chosen)
    _require_trust(output.code, untrusted)
    return output.text.splitlines()


@suggesting
def reduce(
    experiment: _Path,
    out: _Path,
    *,
    data: _Path | None = None,
    robot: _Path | None = None,
    instruments_from: _Path | None = None,
    rows_only: bool = False,
    threads: int | None = None,
    force: bool = False,
) -> Path:
    """Reduce the recordings of an experiment, of any length, to a small file that :func:`solve` reads.

    Parameters
    ----------
    experiment : path
        The experiment file.
    out : path
        The file to write; it is returned.
    data, robot : path, optional
        As for :func:`thetahat.run`.
    instruments_from : path, optional
        A ``results.json`` whose estimates simulate the instruments of IDIM-IV.
    rows_only : bool
        Keep rows alone: :func:`solve` then gives neither a model nor IDIM-IV without instruments.
    threads, force
        As for :func:`design`.
    """
    chosen = options(
        data=data, robot=robot, instruments_from=instruments_from, rows_only=rows_only, threads=threads, force=force
    )
    run("reduce", experiment, *options(out=out), *chosen)
    return Path(out)


def solve(*reductions: _Path) -> Result:
    """Identify from the files of :func:`reduce`, alone or merged: by IDIM-LS, and by IDIM-IV if they have instruments."""
    if not reductions:
        raise ReductionError("no reduction is given")
    contents = [(os.fspath(path), _bytes(path)) for path in reductions]
    name, content = contents[0] if len(contents) == 1 else ("merged", _thetahat.merge(contents))
    native, robot = _thetahat.solve(name, content)
    return Result(native, Robot(robot))


@suggesting
def simulate_experiment(experiment: _Path, *, out: _Path | None = None, force: bool = False) -> Recording:
    """Record the simulated robot of an experiment file (``[twin]``), as the command ``simulate`` does.

    Parameters
    ----------
    experiment : path
        The experiment file.
    out : path, optional
        A CSV file for the recording.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "recording.csv" if out is None else Path(out)
        run("simulate", experiment, *options(out=file, force=force))
        table = np.loadtxt(file, delimiter=",", skiprows=1, ndmin=2)
    joints = (table.shape[1] - 1) // 2
    return Recording(time=table[:, 0], position=table[:, 1 : 1 + joints], torque=table[:, 1 + joints : 1 + 2 * joints])


@suggesting
def sensitivity(experiment: _Path, *, data: _Path | None = None, out: _Path | None = None, force: bool = False) -> Text:
    """How far estimates of IDIM-IV and DIDIM move with errors of the simulator's gears, gains, delay and friction."""
    return Text(run("sensitivity", experiment, *options(data=data, out=out, force=force)).text)


def _file(value: RobotLike | Result, folder: Path) -> Path:
    """The file of a robot or a result."""
    if is_path(value):
        return Path(value)
    folder.mkdir(exist_ok=True)
    if isinstance(value, Robot):
        return robot_file(value, folder)
    if isinstance(value, Result):
        path = folder / "results.json"
        path.write_text(value.to_json(), encoding="utf-8")
        return path
    raise TypeError(f"expected a thetahat.Robot, a thetahat.Result or a path, not {described(value)}")


def _result(value: Result | _Path) -> Result:
    require("result", value, (Result, str, os.PathLike), "a thetahat.Result or the path of a results.json")
    return value if isinstance(value, Result) else Result.read(value)


def _require_trust(code: int, untrusted: bool) -> None:
    if code and not untrusted:
        raise CommandError("the verdict of the results is do-not-use; see its reasons, or use them all the same with untrusted=True")


def _bytes(path: _Path) -> bytes:
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise ReductionError(f"{os.fspath(path)}: cannot be read: {error}") from error


# The comment with which generated code begins, in MATLAB after the line of the function.
_GENERATED = re.compile(r"(function [^\n]*\n)?\W*Generated by thetahat \d")


def _write(path: Path, text: str, force: bool) -> None:
    """Write generated code; a file that thetahat did not generate is replaced only with `force`."""
    if path.exists() and not force and not _GENERATED.match(path.read_text(encoding="utf-8", errors="replace")):
        raise CommandError(f"{path} exists and is not code that thetahat generated; give another place, or replace it with force=True")
    path.write_text(text, encoding="utf-8")


__all__ = [
    "Designed",
    "Finding",
    "check",
    "compare",
    "design",
    "export",
    "generate",
    "init",
    "inspect",
    "reduce",
    "sample",
    "sensitivity",
    "simulate_experiment",
    "solve",
]
