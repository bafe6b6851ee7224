"""Results: the verdict, the advice, and the estimates of every method."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from html import escape
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _thetahat
from ._arrays import Array
from ._inference import freedom_of, level_of, p_value, symmetric, two_sided_quantile
from ._inputs import RecordingLike, is_recording_like, one_recording
from ._prediction import motion_of
from ._text import Text, result_summary, run_summary
from .errors import ResultsError
from .robot import Robot

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

_NOMINAL = "nominal"


class Parameter(NamedTuple):
    """One estimate; missing numbers are None."""

    name: str
    """Name of the base parameter."""
    estimate: float
    """SI."""
    standard_deviation: float | None
    """Classical, as papers print it."""
    standard_deviation_robust: float | None
    """Standard deviation with errors that are correlated in time and differ between joints."""
    interval_95: tuple[float, float] | None
    """The 95 % interval with such errors."""
    unit: str
    """SI unit."""
    expression: str
    """Regrouping formula."""
    true_value: float | None
    """Of a twin."""


class ModelParameter(NamedTuple):
    """A base parameter of the model."""

    name: str
    """Name of the base parameter."""
    value: float
    """SI."""
    a_priori: float
    """Value of the a-priori robot."""
    decided_percent: float
    """Percent of it that the recordings decided; below 90 it is not to be quoted by itself."""
    interval_95: tuple[float, float] | None
    """The 95 % interval of the recordings alone, widened by what the named causes may have moved."""
    unit: str
    """SI unit."""
    expression: str
    """Regrouping formula."""


class Model:
    """The physically consistent robot that predictions and exports use: ``model["m3"]`` is a standard parameter."""

    def __init__(self, data: dict[str, Any], robot: Robot | None = None, cutoff_hz: float | None = None) -> None:
        self._data = data
        self._robot, self._cutoff_hz = robot, cutoff_hz
        self._standard = {p["name"]: float(p["value"]) for p in data["standard"]}

    @property
    def parameters(self) -> list[ModelParameter]:
        """All base parameters."""
        keys = ("name", "value", "a_priori", "decided_percent", "interval_95", "unit", "expression")
        rows = [{**p, "interval_95": tuple(p["interval_95"]) if p["interval_95"] else None} for p in self._data["parameters"]]
        return [ModelParameter(*(row[key] for key in keys)) for row in rows]

    @property
    def standard(self) -> dict[str, float]:
        """All standard parameters by name, SI."""
        return dict(self._standard)

    @property
    def friction_transition(self) -> float:
        """Velocity v of ``tanh(dq / v)``, the sign of the Coulomb friction, rad/s or m/s."""
        return float(self._data["friction_transition"])

    @property
    def friction_transition_sliding(self) -> float | None:
        """The same of joints that slide, m/s, where others turn."""
        sliding = self._data.get("friction_transition_sliding")
        return None if sliding is None else float(sliding)

    @property
    def _sign_velocity_scale(self) -> float | tuple[float, float]:
        sliding = self.friction_transition_sliding
        return self.friction_transition if sliding is None else (self.friction_transition, sliding)

    @property
    def belief_weight(self) -> float:
        """Weight of the belief in the a-priori robot, in long-run variances of the residual."""
        return float(self._data["belief_weight"])

    @property
    def unseen_percent(self) -> float | None:
        """Error of its torques on motion that neither fit nor choice has seen, percent of all torques."""
        unseen = self._data["unseen"]
        return None if unseen is None else float(unseen["percent"])

    @property
    def uses(self) -> dict[str, str]:
        """The verdict on each use: ``predict-torques``, ``simulate``, ``quote-single-values``."""
        return {use["for_what"]: use["verdict"] for use in self._data["uses"]}

    @property
    def causes(self) -> list[dict[str, Any]]:
        """What the model or the recordings are wrong in, the strongest evidence first."""
        causes: list[dict[str, Any]] = self._data.get("causes", [])
        return causes

    @property
    def names(self) -> list[str]:
        """Names of the base parameters."""
        return [p["name"] for p in self._data["parameters"]]

    @property
    def covariance(self) -> Array:
        """Covariance of the base parameters, shape (parameters, parameters), SI; NaN if there is none."""
        return symmetric(self._data.get("covariance"), len(self.names))

    def predict(self, q: ArrayLike | RecordingLike, dq: ArrayLike | None = None, ddq: ArrayLike | None = None) -> Array:
        """The torques that the model predicts for a motion or a recording, as :meth:`Result.predict`."""
        robot = _known(self._robot)
        theta = np.array([self.standard[name] for name in robot.parameter_names])
        return _predicted(robot, theta, self._sign_velocity_scale, _motion(robot, self._cutoff_hz, q, dq, ddq))

    def __getitem__(self, name: str) -> float:
        return self._standard[name]

    def __repr__(self) -> str:
        return f"Model(belief_weight={self.belief_weight:g}, unseen_percent={self.unseen_percent}, uses={self.uses})"


class Advice(NamedTuple):
    """The recommended method of a case."""

    case: str
    """The case."""
    recommended: str | None
    """The recommended method; None if no method can be recommended."""
    distrust: tuple[str, ...]
    """Methods whose estimates cannot be trusted."""
    text: str
    """The reasons, with numbers."""

    def __str__(self) -> str:
        return self.text


class Run:
    """One case and method: estimates with their statistics. ``run["fv1"]`` is one parameter."""

    def __init__(self, data: dict[str, Any], curves: tuple[Array, Array, Array]) -> None:
        self._data = data
        self._curves = curves

    @property
    def case(self) -> str:
        """The case, such as ``"nominal"``."""
        return str(self._data["case"])

    @property
    def method(self) -> str:
        """The method, such as ``"idim-iv"``, or the name of your own estimator."""
        return str(self._data["method"])

    @property
    def is_own(self) -> bool:
        """Whether it comes from your own estimator: thetahat has not examined it, and its deviations come from that estimator."""
        return bool(self._data.get("is_own"))

    @property
    def status(self) -> str:
        """``"converged"``, ``"stalled"``, ``"iteration_limit"``, ``"diverged"`` or ``"not_identifiable"``."""
        return str(self._data["status"])

    @property
    def reason(self) -> str | None:
        """Why it did not converge."""
        reason: str | None = self._data["reason"]
        return reason

    @property
    def relative_error_percent(self) -> float | None:
        """``100 |y - y_hat| / |y|``."""
        error: float | None = self._data["relative_error_percent"]
        return error

    @property
    def cross_validation_relative_error_percent(self) -> float | None:
        """The same on data not used for the estimate: recordings held back, or parts left out in turn."""
        error: float | None = self._data["cross_validation_relative_error_percent"]
        return error

    @property
    def parameters(self) -> list[Parameter]:
        """The estimates in order."""
        return [_parameter(data) for data in self._data["parameters"]]

    @property
    def names(self) -> list[str]:
        """Names of the parameters."""
        return [data["name"] for data in self._data["parameters"]]

    @property
    def estimates(self) -> Array:
        """The estimates, shape (parameters,), SI."""
        return self._column("estimate")

    @property
    def standard_deviations(self) -> Array:
        """Their robust standard deviations, shape (parameters,); NaN if there is none. For your own estimator, those
        of its covariance."""
        return self._column("standard_deviation" if self.is_own else "standard_deviation_robust")

    @property
    def intervals_95(self) -> Array:
        """Their 95 % intervals, shape (parameters, 2); NaN if there is none."""
        ends = [data["interval_95"] or (np.nan, np.nan) for data in self._data["parameters"]]
        return np.array(ends, dtype=np.float64).reshape(-1, 2)

    @property
    def covariance(self) -> Array:
        """Covariance of the estimates, shape (parameters, parameters), in the order of :attr:`names`, SI; NaN if there is
        none. The roots of its diagonal are the :attr:`standard_deviations`."""
        return symmetric(self._data.get("covariance"), len(self))

    @property
    def degrees_of_freedom(self) -> float:
        """Degrees of freedom of the t distribution of intervals and tests: few, because errors are correlated in time.
        Infinite for your own estimator."""
        return freedom_of(self.intervals_95, self.standard_deviations)

    @property
    def t_values(self) -> Array:
        """Estimates divided by their standard deviations, shape (parameters,)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.estimates / self.standard_deviations

    @property
    def p_values(self) -> Array:
        """Probabilities of t values at least as far from zero, if the parameter were zero; shape (parameters,)."""
        freedom = self.degrees_of_freedom
        with np.errstate(divide="ignore", invalid="ignore"):
            values = self.estimates / self._deviations_of_intervals()
        return np.array([p_value(t, freedom) for t in values.tolist()])

    def _deviations_of_intervals(self) -> Array:
        """Deviations by which the 95 % intervals follow from one t distribution: each parameter has its own degrees of freedom."""
        half_widths = 0.5 * (self.intervals_95[:, 1] - self.intervals_95[:, 0])
        deviations = half_widths / two_sided_quantile(0.95, self.degrees_of_freedom)
        return np.where(np.isfinite(half_widths), deviations, self.standard_deviations)

    def conf_int(self, level: float = 0.95, *, alpha: float | None = None) -> Array:
        """Intervals that contain the true values with a probability.

        Parameters
        ----------
        level : float
            The probability, such as 0.95 or 0.99.
        alpha : float, optional
            Instead of it ``1 - level``, as in statsmodels.

        Returns
        -------
        ndarray (parameters, 2)
            Their ends, SI; those of the level 0.95 are :attr:`intervals_95`.
        """
        quantile = two_sided_quantile(level_of(level, alpha), self.degrees_of_freedom)
        half_width = quantile * self._deviations_of_intervals()
        return np.column_stack([self.estimates - half_width, self.estimates + half_width])

    @property
    def residuals(self) -> Array:
        """Measured minus predicted torques, shape (rows, n), N m or N."""
        if self.predicted.shape != self.measured.shape:
            raise ResultsError(f"{self.method} has no curves in the case {self.case}: {self.reason or self.status}")
        return self.measured - self.predicted

    def summary(self, level: float = 0.95) -> Text:
        """A table of the estimates with standard deviations, t, p and intervals."""
        return run_summary(self, level_of(level, None))

    @property
    def time(self) -> Array:
        """Times of the decimated rows of a joint, shape (rows,), s; empty for results that were read from a file."""
        return self._curves[0]

    @property
    def measured(self) -> Array:
        """Decimated torques, shape (rows, n), N m or N."""
        return self._curves[1]

    @property
    def predicted(self) -> Array:
        """The predicted torques, shape (rows, n)."""
        return self._curves[2]

    def to_dict(self) -> dict[str, Any]:
        """The content of ``results.json`` for the run."""
        return dict(self._data)

    def to_pandas(self) -> pandas.DataFrame:
        """The estimates as a table with a row for each parameter. Needs pandas (``pip install thetahat[pandas]``)."""
        import pandas

        table = pandas.DataFrame.from_records(
            [parameter._asdict() for parameter in self.parameters], columns=list(Parameter._fields)
        )
        table["interval_95_low"], table["interval_95_high"] = self.intervals_95.T
        return table.drop(columns="interval_95").set_index("name")

    def __getitem__(self, name: str) -> Parameter:
        for data in self._data["parameters"]:
            if data["name"] == name:
                return _parameter(data)
        raise KeyError(f"{self.method} estimates no {name}; it estimates {' '.join(self.names)}")

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def __iter__(self) -> Iterator[Parameter]:
        return iter(self.parameters)

    def __len__(self) -> int:
        return len(self._data["parameters"])

    def __repr__(self) -> str:
        error = self.relative_error_percent
        fit = "no estimate" if error is None else f"{len(self)} parameters, relative error {error:.2f} %"
        whose = " (your own)" if self.is_own else ""
        return f"<thetahat.Run {self.case} {self.method}{whose}: {self.status}, {fit}>"

    def _repr_html_(self) -> str:
        return f"<p>{escape(repr(self)[1:-1])}</p>" + _table([self])

    def _column(self, key: str) -> Array:
        values = [data[key] for data in self._data["parameters"]]
        return np.array([np.nan if value is None else value for value in values], dtype=np.float64)


class Result:
    """The results of an identification. ``result["idim-iv"]`` is the nominal run of a method, ``result["idim-iv", case]`` that of another case,
    ``result["name"]`` that of your own estimator.

    Results can be pickled; reports of the copy are the same to the byte.
    """

    def __init__(self, native: _thetahat.Results, robot: Robot | None) -> None:
        self._native = native
        self._known_robot = robot
        self._data: dict[str, Any] = json.loads(native.to_json())
        self._runs: list[dict[str, Any]] = [*self._data["runs"], *map(_own_run, self._data.get("user_runs", []))]
        time, measured, _ = native.curves()
        self._curves = time[:, 0] if time.shape[1] else np.empty(0), measured

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Result:
        """The results of a ``results.json``, without curves.

        Results from arrays have no robot and cannot predict: pickle them instead.

        Raises
        ------
        ResultsError
            For a file that is not a ``results.json``.
        """
        native, robot = _thetahat.Results.read(os.fspath(path))
        return cls(native, None if robot is None else Robot(robot))

    @property
    def robot(self) -> Robot | None:
        """The robot, if it is known."""
        return self._known_robot

    @property
    def verdict(self) -> str:
        """``"good"``, ``"care"`` or ``"do-not-use"``; ``"not-judged"`` for files without a verdict."""
        return str(self._data["verdict"] or "not-judged")

    @property
    def reasons(self) -> list[str]:
        """Why the verdict is not good, the most serious reason first."""
        return [reason["text"] for reason in self._data["verdict_reasons"]]

    @property
    def remedies(self) -> list[dict[str, Any]]:
        """Changes of the experiment file that remove causes of findings, each with ``code``, ``label``, ``found`` and ``changes``."""
        remedies: list[dict[str, Any]] = self._data.get("remedies", [])
        return remedies

    def apply(self, *codes: str, out: str | os.PathLike[str]) -> str:
        """Write the experiment with the remedies of these codes as a new file, for :func:`run`, as ``thetahat identify --apply`` does.

        Parameters
        ----------
        *codes : str
            Codes of :attr:`remedies`.
        out : path
            The new experiment file, in the folder of the old one; an existing file is kept.

        Returns
        -------
        str
            The path of the new file.

        Raises
        ------
        ResultsError
            For results of arrays, which have no experiment file.
        ExperimentError
            For a code that no remedy has, with those that there are.
        FileExistsError
            Where a file is there.
        """
        if not self._data.get("experiment_description"):
            raise ResultsError("these results are of arrays and have no experiment file; do what the findings say")
        path = os.fspath(out)
        text = self._native.with_remedies(path, list(codes))
        with open(path, "x", encoding="utf-8", newline="") as file:
            file.write(text)
        return path

    @property
    def advice(self) -> list[Advice]:
        """The recommended method of each case, and why."""
        return [
            Advice(advice["case"], advice["recommended"], tuple(advice["distrust"]), advice["text"])
            for advice in self._data["advice"]
        ]

    @property
    def findings(self) -> list[dict[str, Any]]:
        """The findings of the checks, by recording."""
        findings: list[dict[str, Any]] = self._data["findings"]
        return findings

    @property
    def runs(self) -> list[Run]:
        """Every case and method, then your own estimators."""
        return [self._run(number) for number in range(len(self._runs))]

    @property
    def model(self) -> Model | None:
        """The model that :meth:`predict` and :meth:`export` use; None if there is none, as without torques."""
        model = self._data.get("model")
        return None if model is None else Model(model, self._known_robot, self._cutoff_hz)

    @property
    def best(self) -> Run:
        """The recommended nominal run; for reductions, which have no advice, that of IDIM-IV or otherwise IDIM-LS.

        Raises
        ------
        ResultsError
            If no method can be recommended.
        """
        recommended = self._recommended_run()
        if recommended is None:
            raise ResultsError("no method is recommended; see `reasons` and `advice`")
        return recommended

    def to_dict(self) -> dict[str, Any]:
        """The content of ``results.json``."""
        return dict(self._data)

    def to_json(self) -> str:
        """The text of ``results.json``."""
        return self._native.to_json()

    def to_csv(self) -> str:
        """The text of ``parameters.csv``."""
        return self._native.render("parameters.csv").decode()

    def text(self) -> str:
        """The tables that ``thetahat identify --full`` prints."""
        return self._native.text()

    def report(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write the report atomically: one HTML file that opens offline.

        Parameters
        ----------
        path : str or path
            The file; a file that thetahat wrote is replaced.
        force : bool
            Whether to replace a file that thetahat did not write.

        Raises
        ------
        ReportError
            If it cannot be written, or the file exists and was not written by thetahat.
        """
        self._native.write_file("report.html", os.fspath(path), force)

    def write(self, folder: str | os.PathLike[str], *, force: bool = False) -> list[str]:
        """Write ``results.json``, ``parameters.csv`` and ``report.html`` into a folder; returns their paths.

        Files of these names that thetahat did not write are replaced only with `force`, as for :meth:`report`.
        """
        return [os.fspath(path) for path in self._native.write(os.fspath(folder), force)]

    def export(
        self,
        path: str | os.PathLike[str],
        to: str | None = None,
        *,
        method: str | None = None,
        untrusted: bool = False,
        force: bool = False,
    ) -> list[str]:
        """Write the identified robot as a file that simulators and controllers read, with physically consistent inertias.

        Parameters
        ----------
        path : str or path
            The file; a file that thetahat wrote is replaced.
        to : {"urdf", "mjcf", "sdf", "json", "pace", "isaac", "bam"}, optional
            The format; by default that of the file's extension, where ``.xml`` is MJCF.
        method : str, optional
            The method of the estimates; by default the model.
        untrusted : bool
            Whether results whose verdict is ``"do-not-use"`` are exported.
        force : bool
            Whether to replace a file that thetahat did not write.

        Returns
        -------
        list of str
            Remarks: how the parameters were chosen, what changed, and what the format cannot represent.

        Raises
        ------
        ResultsError
            For results that must not be used, without an estimate, or without a physically consistent robot.
        ReportError
            If the file cannot be written, or exists and was not written by thetahat.

        Examples
        --------
        >>> import os, tempfile, thetahat as th
        >>> twin = th.testing.twin(seconds=10)
        >>> result = th.identify(twin.robot, twin.recording, cutoff_hz=40, decimation=10)
        >>> remarks = result.export(os.path.join(tempfile.mkdtemp(), "arm_identified.urdf"))
        >>> remarks[0].startswith("the model")
        True
        """
        file = os.fspath(path)
        extension = os.path.splitext(file)[1].lstrip(".")
        return self._native.export(file, to or {"xml": "mjcf"}.get(extension, extension), method, untrusted, force)

    def predict(
        self,
        q: ArrayLike | RecordingLike,
        dq: ArrayLike | None = None,
        ddq: ArrayLike | None = None,
        *,
        run: Run | None = None,
    ) -> Array:
        """The torques that the estimates predict for a motion or a recording.

        Parameters
        ----------
        q : array_like (n,) or (samples, n), or Recording, path or DataFrame
            Positions, rad or m; or a recording, whose positions are differentiated
            after a filter that leaves out their noise.
        dq, ddq : array_like, as `q`
            Velocities and accelerations of a motion that is no recording.
        run : Run, optional
            The run of the estimates; by default the :attr:`model`, whose friction changes its sign smoothly.

        Returns
        -------
        ndarray, as `q`
            Torques, N m or N; of a recording (samples, n). The filter disturbs the ends.
        """
        robot = self._robot()
        model = self.model if run is None else None
        scale = None if model is None else model._sign_velocity_scale
        motion = _motion(robot, self._cutoff_hz, q, dq, ddq)
        return _predicted(robot, self.standard_parameters(run=run), scale, motion)

    def summary(self, *, run: Run | None = None, level: float = 0.95) -> Text:
        """Verdict, reasons, and a table of estimates with standard deviations, t, p and intervals.

        Parameters
        ----------
        run : Run, optional
            The run that is shown; by default the recommended one, or all if none is recommended.
        level : float
            Probability of the intervals.
        """
        shown = self._recommended_run() if run is None else run
        return result_summary(self, self.runs if shown is None else [shown], level_of(level, None))

    def to_mujoco(self, model: Any, *, untrusted: bool = False) -> list[str]:
        """Write the identified inertias, armatures, damping and friction losses into a compiled MuJoCo model.

        Joints are found by their names; their axes must agree with those of the identified robot at the zero position. Bodies
        that are fixed to a link become massless: the link's inertia includes them.

        Parameters
        ----------
        model : mujoco.MjModel
            The model, which is changed.
        untrusted : bool
            Whether results whose verdict is ``"do-not-use"`` are written.

        Returns
        -------
        list of str
            Remarks, such as what MuJoCo cannot represent.
        """
        from ._simulators import into_mujoco

        return into_mujoco(self, model, untrusted)

    def to_pinocchio(self, *, untrusted: bool = False) -> Any:
        """The identified robot as a ``pinocchio.Model``, with armature, damping and friction. Needs Pinocchio
        (``pip install pin``); continuous joints have two coordinates there.

        Parameters
        ----------
        untrusted : bool
            Whether results whose verdict is ``"do-not-use"`` are used.
        """
        from ._simulators import pinocchio_model

        return pinocchio_model(self, untrusted)

    def standard_parameters(self, *, run: Run | None = None) -> Array:
        """Standard parameters: those of the model, or with the torques of a run's estimates, where regrouped ones are zero and
        fixed ones at their values.

        Returns
        -------
        ndarray (p,)
        """
        robot, model = self._robot(), self.model if run is None else None
        if model is not None:
            return np.array([model.standard[name] for name in robot.parameter_names])
        run = self.best if run is None else run
        estimates = dict(zip(run.names, run.estimates.tolist(), strict=True))
        if not estimates:
            raise ResultsError(f"{run.method} has no estimate in the case {run.case}: {run.reason or run.status}")
        known = set(robot._native.base_parameters(self._native.excluded, self._native.fixed)[1])
        foreign = [name for name in estimates if name not in known]
        if foreign:
            raise ResultsError(f"the case {run.case} has another friction model than the robot: it has no {foreign[0]}")
        return robot._native.standard_of(estimates, self._native.excluded, self._native.fixed)

    def plot_torques(self, *, run: Run | None = None) -> Figure:
        """Measured and predicted torques over time, joint by joint. Needs matplotlib (``pip install thetahat[plot]``)."""
        from ._figures import rows_of_axes

        run = self.best if run is None else run
        if not len(run.time):
            raise ResultsError("results that were read from a file have no curves; identify again")
        if not len(run.predicted):
            raise ResultsError(f"{run.method} has no estimate in the case {run.case}: {run.reason or run.status}")
        joints = run.measured.shape[1]
        figure, axes = rows_of_axes(joints)
        for joint, axis in enumerate(axes):
            axis.plot(run.time, run.measured[:, joint], label="measured", linewidth=1.0)
            axis.plot(run.time, run.predicted[:, joint], label=run.method, linewidth=1.0)
            described = self._data["robot_joints"][joint]
            axis.set_ylabel(f"{described['name']} [{'N m' if described['kind'] == 'revolute' else 'N'}]")
        axes[0].legend(loc="upper right")
        return figure

    def __getitem__(self, key: str | tuple[str, str]) -> Run:
        method, case = (key, _NOMINAL) if isinstance(key, str) else key
        for number, data in enumerate(self._runs):
            if (data["method"], data["case"]) == (method, case):
                return self._run(number)
        known = ", ".join(f"({data['method']!r}, {data['case']!r})" for data in self._runs)
        raise KeyError(f"there is no run of {method} in the case {case}; runs are {known}")

    def __contains__(self, key: object) -> bool:
        wanted = key if isinstance(key, tuple) else (key, _NOMINAL)
        return wanted in [(data["method"], data["case"]) for data in self._runs]

    def __iter__(self) -> Iterator[Run]:
        return iter(self.runs)

    def __len__(self) -> int:
        return len(self._runs)

    def __reduce__(self) -> tuple[type[Result], tuple[_thetahat.Results, Robot | None]]:
        return Result, (self._native, self._known_robot)

    def __repr__(self) -> str:
        return f"<thetahat.Result {self._data['title']}: verdict {self.verdict}, {len(self)} runs>"

    def __str__(self) -> str:
        return self.text()

    def _repr_html_(self) -> str:
        head = f"<h4>{escape(self._data['title'])}: {escape(self.verdict)}</h4>"
        reasons = "".join(f"<li>{escape(reason)}</li>" for reason in self.reasons)
        advice = "".join(f"<p><b>{escape(advice.case)}</b>: {escape(advice.text)}</p>" for advice in self.advice)
        nominal = [run for run in self.runs if run.case == _NOMINAL]
        return head + (f"<ul>{reasons}</ul>" if reasons else "") + advice + _table(nominal)

    def _recommended_run(self) -> Run | None:
        number = self._native.recommended_run()
        return None if number is None else self._run(number)

    def _run(self, number: int) -> Run:
        time, measured = self._curves
        predicted, _ = self._native.run_curves(number)
        return Run(self._runs[number], (time, measured, predicted))

    def _robot(self) -> Robot:
        return _known(self._known_robot)

    @property
    def _cutoff_hz(self) -> float | None:
        """Cut-off of the position filter."""
        cutoff: float | None = (self._data.get("bandwidth") or {}).get("position_cutoff_hz")
        return cutoff


def _known(robot: Robot | None) -> Robot:
    if robot is None:
        raise ResultsError("results of arrays that were read from results.json have no robot: pickle the result instead")
    return robot


def _motion(
    robot: Robot, cutoff_hz: float | None, q: ArrayLike | RecordingLike, dq: ArrayLike | None, ddq: ArrayLike | None
) -> tuple[ArrayLike, ArrayLike, ArrayLike]:
    """A motion as it is given, or of a recording."""
    if dq is not None and ddq is not None:
        return q, dq, ddq  # type: ignore[return-value]
    if not is_recording_like(q):
        raise TypeError("predict needs a recording, or q, dq and ddq: positions alone have no velocities and accelerations")
    if cutoff_hz is None:
        raise ResultsError("the results have no cut-off of the position filter: give q, dq and ddq")
    return tuple(motion_of(one_recording(robot, q), cutoff_hz))  # type: ignore[return-value]


def _predicted(
    robot: Robot,
    theta: Array,
    scale: float | tuple[float, float] | None,
    motion: tuple[ArrayLike, ArrayLike, ArrayLike],
) -> Array:
    return robot.inverse_dynamics(*motion, theta=theta, sign_velocity_scale=scale)


def _own_run(data: dict[str, Any]) -> dict[str, Any]:
    """The result of the user's own estimator, with the keys of a run."""
    ended = {"case": _NOMINAL, "method": data["name"], "is_own": True, "status": "converged", "reason": None}
    return {**ended, **data}


def _parameter(data: dict[str, Any]) -> Parameter:
    interval = data["interval_95"]
    return Parameter(
        name=data["name"],
        estimate=data["estimate"],
        standard_deviation=data["standard_deviation"],
        standard_deviation_robust=data["standard_deviation_robust"],
        interval_95=None if interval is None else (interval[0], interval[1]),
        unit=data["unit"],
        expression=data["expression"],
        true_value=data["true_value"],
    )


def _table(runs: list[Run]) -> str:
    """The estimates of runs side by side, with the half widths of their 95 % intervals."""
    names = list(dict.fromkeys(name for run in runs for name in run.names))
    units = {parameter.name: parameter.unit for run in runs for parameter in run}
    head = "".join(f"<th>{escape(run.method)}{' (your own)' if run.is_own else ''}</th>" for run in runs)
    rows = ""
    for name in names:
        cells = "".join(f"<td>{_cell(run[name]) if name in run.names else ''}</td>" for run in runs)
        rows += f"<tr><th>{escape(name)}</th><td>{escape(units[name])}</td>{cells}</tr>"
    return f"<table><thead><tr><th>parameter</th><th>unit</th>{head}</tr></thead><tbody>{rows}</tbody></table>"


def _cell(parameter: Parameter) -> str:
    if parameter.interval_95 is None:
        return f"{parameter.estimate:.4g}"
    low, high = parameter.interval_95
    return f"{parameter.estimate:.4g} &plusmn; {0.5 * (high - low):.2g}"
