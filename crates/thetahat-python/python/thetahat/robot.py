"""Robots: descriptions, parameters and dynamics."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Mapping, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _thetahat
from ._arguments import described, is_path
from ._arrays import Array, samples, states, vector
from .errors import RobotError

_Path = str | os.PathLike[str]
_Columns = Literal["standard", "base"] | Sequence[str]


_INERTIAL = re.compile(r"(xx|xy|xz|yy|yz|zz|mx|my|mz|m|ia|iam)\d+")
"""Names of the parameters of bodies and rotors."""


class BaseParameter(NamedTuple):
    """An independent combination of standard parameters."""

    name: str
    """The kept parameter's name, with a final ``r`` if others are regrouped into it."""
    expression: str
    """The formula, such as ``zz1 + ia1 + yy2``."""
    unit: str
    """SI unit."""


class Robot:
    """A robot: a tree of revolute and prismatic joints with its transmission, friction model and a-priori parameters.

    Make one with :meth:`from_urdf`, :meth:`from_mjcf`, :meth:`from_toml`, :meth:`from_dh` or :meth:`from_text`. ``n`` is its number of
    coordinates, the columns of all arrays; ``p`` its number of standard parameters.
    """

    def __init__(self, native: _thetahat.Robot) -> None:
        self._native = native

    @classmethod
    def from_file(cls, path: _Path, *, locked: Mapping[str, float] | None = None) -> Robot:
        """Read a robot description of any format that thetahat reads.

        Parameters
        ----------
        path : path
            The file.
        locked : mapping, optional
            Joints that do not move, by name, with their coordinate (rad or m).

        Raises
        ------
        RobotError
            With file, line and remedy.
        """
        if not is_path(path):
            raise TypeError(f"path must be the path of a robot description, and is {described(path)}")
        text = os.fspath(path)
        if "\n" in text or text.lstrip().startswith("<"):
            raise RobotError("path is the text of a description, not the path of a file: use Robot.from_text")
        return cls(_thetahat.Robot.read(text, dict(locked or {})))

    @classmethod
    def from_urdf(cls, path: _Path, *, locked: Mapping[str, float] | None = None) -> Robot:
        """Read a URDF (xacro expanded). Parameters are those of :meth:`from_file`."""
        return cls.from_file(path, locked=locked)

    @classmethod
    def from_mjcf(cls, path: _Path, *, locked: Mapping[str, float] | None = None) -> Robot:
        """Read a MuJoCo model (MJCF): joints, inertias, armature, damping and friction loss. Parameters are those of
        :meth:`from_file`."""
        return cls.from_file(path, locked=locked)

    @classmethod
    def from_toml(cls, path: _Path, *, locked: Mapping[str, float] | None = None) -> Robot:
        """Read a TOML description: Denavit-Hartenberg, or on top of a URDF. Parameters are those of :meth:`from_file`."""
        return cls.from_file(path, locked=locked)

    @classmethod
    def from_text(cls, text: str, *, name: str = "robot", locked: Mapping[str, float] | None = None) -> Robot:
        """Make a robot from the text of a URDF or TOML description; `name` is the name of the file in messages.

        Examples
        --------
        >>> robot = Robot.from_text("name = 'pendulum'\\n[[joint]]\\nname = 'pivot'\\nkind = 'revolute'")
        >>> robot.base_parameters[0].expression
        'zz1 + ia1'
        """
        return cls(_thetahat.Robot.parse(text, name, dict(locked or {})))

    @classmethod
    def from_dh(
        cls,
        *,
        alpha: Sequence[float],
        a: Sequence[float],
        theta: Sequence[float],
        d: Sequence[float],
        kind: str | Sequence[str] = "revolute",
        convention: Literal["modified", "standard"] = "modified",
        names: Sequence[str] | None = None,
        parameters: Mapping[str, float] | None = None,
        transmission: ArrayLike | None = None,
        gravity: Sequence[float] = (0.0, 0.0, -9.81),
        friction: Literal["symmetric", "asymmetric"] = "symmetric",
        name: str = "robot",
    ) -> Robot:
        """Make a serial robot from its Denavit-Hartenberg table.

        Parameters
        ----------
        alpha, theta : sequence
            Angles, rad, one for each joint; a revolute joint's coordinate adds to `theta`.
        a, d : sequence
            Lengths, m; a prismatic joint's coordinate adds to `d`.
        kind : {"revolute", "prismatic"} or sequence
            For all joints, or one for each.
        convention : {"modified", "standard"}
            Khalil's (Craig's) frames, or those of most data sheets.
        names : sequence, optional
            Names of the joints; ``joint_1`` and so on without them.
        parameters : mapping, optional
            A-priori values of standard parameters by name, SI.
        transmission : array_like (n, n), optional
            ``N`` in ``q = N^-1 q_motor``: gear ratios on its diagonal.
        gravity : sequence
            Acceleration of gravity in the base frame, m/s^2.
        friction : {"symmetric", "asymmetric"}
            Coefficients for both signs of the velocity, or for each.
        name : str
            Name of the robot.

        Examples
        --------
        >>> arm = Robot.from_dh(alpha=[0, 0], a=[0, 0.4], theta=[0, 0], d=[0, 0], parameters={"m2": 3.0})
        >>> arm.n, arm.joints
        (2, ['joint_1', 'joint_2'])
        """
        count = len(alpha)
        kinds = [kind] * count if isinstance(kind, str) else list(kind)
        labels = [f"joint_{i + 1}" for i in range(count)] if names is None else list(names)
        for key, column in {"a": a, "theta": theta, "d": d, "kind": kinds, "names": labels}.items():
            if len(column) != count:
                raise ValueError(f"{key} has {len(column)} entries and alpha has {count}: one for each joint")
        lines = [
            f"name = {json.dumps(name)}",
            f'convention = "{convention}"',
            f'friction = "{friction}"',
            f"gravity = {[float(g) for g in gravity]}",
        ]
        for i in range(count):
            numbers = {"alpha_deg": math.degrees(alpha[i]), "a_m": a[i], "theta_deg": math.degrees(theta[i]), "d_m": d[i]}
            lines += ["[[joint]]", f"name = {json.dumps(labels[i])}", f"kind = {json.dumps(kinds[i])}"]
            lines += [f"{key} = {float(value)!r}" for key, value in numbers.items()]
        if transmission is not None:
            matrix = np.asarray(transmission, dtype=np.float64).tolist()
            lines += ["[transmission]", f"matrix = {matrix}"]
        lines += ["[parameters]", *(f"{json.dumps(key)} = {float(value)!r}" for key, value in (parameters or {}).items())]
        return cls.from_text("\n".join(lines), name=name)

    @property
    def n(self) -> int:
        """Number of coordinates: joints that move and do not follow another."""
        return self._native.coordinates

    @property
    def name(self) -> str:
        """Its name."""
        return str(self.summary()["name"])

    @property
    def joints(self) -> list[str]:
        """Names of the joints of the coordinates, in the order of the columns of arrays."""
        return [joint["name"] for joint in self.summary()["joints"] if joint.get("coordinate") is not None]

    @property
    def parameter_names(self) -> list[str]:
        """Names of the standard parameters in order, such as ``xx1`` to ``m1``, ``ia1``, ``fv1``, ``fc1``, ``off1``."""
        return self._native.parameter_names

    @property
    def parameter_units(self) -> list[str]:
        """SI units of the standard parameters."""
        return self._native.parameter_units

    @property
    def a_priori(self) -> Array:
        """A-priori values of the standard parameters, shape (p,), zero where none is known."""
        return self._native.a_priori

    @property
    def base_parameters(self) -> list[BaseParameter]:
        """The independent combinations of standard parameters that torques can show."""
        _, names, expressions, units = self._native.base_parameters([], {})
        return [BaseParameter(*parameter) for parameter in zip(names, expressions, units, strict=True)]

    def summary(self) -> dict[str, Any]:
        """What ``thetahat model --json`` prints."""
        summary: dict[str, Any] = json.loads(self._native.summary())
        return summary

    def base_values(self, theta: ArrayLike | None = None) -> dict[str, float]:
        """The base parameters that standard parameters have, by name.

        Parameters
        ----------
        theta : array_like (p,), optional
            Standard parameters; by default the a-priori ones.
        """
        values = self._native.base_of(self._theta(theta))
        return {parameter.name: float(value) for parameter, value in zip(self.base_parameters, values, strict=True)}

    def regressor(
        self,
        q: ArrayLike,
        dq: ArrayLike,
        ddq: ArrayLike,
        *,
        parameters: _Columns = "standard",
        sign_velocity_scale: float | tuple[float, float] | None = None,
        out: Array | None = None,
    ) -> Array:
        """The matrix ``phi`` with ``tau = phi(q, dq, ddq) theta``.

        Parameters
        ----------
        q, dq, ddq : array_like (n,) or (samples, n)
            Positions, velocities and accelerations, in rad or m and their derivatives. Arrays in any order are read where
            they lie.
        parameters : {"standard", "base"} or sequence of str
            The columns: all standard parameters, those that the base parameters keep (so that ``tau = phi theta_base``), or
            standard parameters by name.
        sign_velocity_scale : float or pair of float, optional
            ``sign(v)`` becomes ``tanh(v / scale)`` in Coulomb friction; of a pair the first is that of joints that turn, rad/s,
            and the second that of joints that slide, m/s.
        out : ndarray (samples, n, p), optional
            Where to write it, in C order and float64: the memory of large arrays takes longer to get than to fill.

        Returns
        -------
        ndarray (n, p) or (samples, n, p)

        Examples
        --------
        >>> import numpy as np
        >>> robot = Robot.from_text("name = 'pendulum'\\n[[joint]]\\nname = 'pivot'\\nkind = 'revolute'")
        >>> robot.regressor([0.1], [0.2], [0.3], parameters=["ia1", "fv1", "fc1"])
        array([[0.3, 0.2, 1. ]])
        """
        self._refuse_channels()
        single, motion = states(self.n, q=q, dq=dq, ddq=ddq)
        columns = self.columns(parameters)
        shape = (motion[0].shape[0], self.n, len(columns))
        phi = np.empty(shape) if out is None else out
        if phi.shape != shape or phi.dtype != np.float64 or not phi.flags.c_contiguous or not phi.flags.writeable:
            raise ValueError(f"out must be a writable float64 array of shape {shape} in C order")
        self._native.regressor(motion, columns, sign_velocity_scale, phi)
        return phi[0] if single else phi

    def inverse_dynamics(
        self,
        q: ArrayLike,
        dq: ArrayLike,
        ddq: ArrayLike,
        *,
        theta: ArrayLike | None = None,
        sign_velocity_scale: float | tuple[float, float] | None = None,
    ) -> Array:
        """The torques of a motion, with friction, motor inertias and offsets.

        Parameters
        ----------
        q, dq, ddq : array_like (n,) or (samples, n)
            The motion.
        theta : array_like (p,), optional
            Standard parameters; by default the a-priori ones.
        sign_velocity_scale : float or pair of float, optional
            As for :meth:`regressor`.

        Returns
        -------
        ndarray, as `q`
            Torques, N m or N.
        """
        self._refuse_channels()
        single, motion = states(self.n, q=q, dq=dq, ddq=ddq)
        tau = np.empty(motion[0].shape)
        self._native.inverse_dynamics(motion, self._theta(theta), sign_velocity_scale, tau)
        return tau[0] if single else tau

    def forward_dynamics(
        self,
        q: ArrayLike,
        dq: ArrayLike,
        tau: ArrayLike,
        *,
        theta: ArrayLike | None = None,
        sign_velocity_scale: float | tuple[float, float] | None = None,
    ) -> Array:
        """The accelerations for given torques; arguments and shapes as for :meth:`inverse_dynamics`.

        Raises
        ------
        SimulationError
            If the parameters have no positive definite mass matrix.
        """
        self._refuse_channels()
        single, inputs = states(self.n, q=q, dq=dq, tau=tau)
        ddq = np.empty(inputs[0].shape)
        self._native.forward_dynamics(inputs, self._theta(theta), sign_velocity_scale, ddq)
        return ddq[0] if single else ddq

    def mass_matrix(self, q: ArrayLike, *, theta: ArrayLike | None = None) -> Array:
        """The mass matrix, shape (n, n) or (samples, n, n), motor inertias included."""
        single, (q_,) = states(self.n, q=q)
        masses = np.empty((q_.shape[0], self.n, self.n))
        self._native.mass_matrix(q_, self._theta(theta), masses)
        return masses[0] if single else masses

    def rnea(self, q: ArrayLike, dq: ArrayLike, ddq: ArrayLike, *, theta: ArrayLike | None = None) -> Array:
        """The torques of a motion by bodies and rotors alone: ``M(q) ddq + C(q, dq) dq + g(q)``, without friction, offsets and
        torque terms. The mass matrix includes the inertias of the motors.

        Parameters
        ----------
        q, dq, ddq : array_like (n,) or (samples, n)
            Positions (rad or m), velocities and accelerations.
        theta : array_like (p,), optional
            Standard parameters; by default the a-priori ones.

        Returns
        -------
        ndarray, as `q`
            Torques, N m or N.

        Examples
        --------
        >>> from thetahat import testing
        >>> arm, state = testing.arm(), [0.1, 0.2]
        >>> bool(np.allclose(arm.rnea(state, [0, 0], [1, 0]) - arm.gravity(state), arm.mass_matrix(state)[:, 0]))
        True
        """
        single, motion = states(self.n, q=q, dq=dq, ddq=ddq)
        tau = np.empty(motion[0].shape)
        self._native.inverse_dynamics(motion, self._without_friction(theta), None, tau)
        return tau[0] if single else tau

    def gravity(self, q: ArrayLike, *, theta: ArrayLike | None = None) -> Array:
        """The torques that hold the bodies at rest, ``g(q)``, N m or N; shapes as for :meth:`rnea`."""
        rest = np.zeros(np.shape(q))
        return self.rnea(q, rest, rest, theta=theta)

    def coriolis(self, q: ArrayLike, dq: ArrayLike, *, theta: ArrayLike | None = None) -> Array:
        """The Coriolis and centrifugal torques, ``C(q, dq) dq``, N m or N; shapes as for :meth:`rnea`."""
        return self.rnea(q, dq, np.zeros(np.shape(q)), theta=theta) - self.gravity(q, theta=theta)

    def _without_friction(self, theta: ArrayLike | None) -> Array:
        """The parameters of bodies and rotors; those of friction, offsets and terms are zero."""
        keeps = [_INERTIAL.fullmatch(name) is not None for name in self.parameter_names]
        return np.where(keeps, self._theta(theta), 0.0)

    def joint_torques(self, drive_signals: ArrayLike) -> Array:
        """Joint torques (samples, n), N m or N, from the motors' drive signals: ``N^T (gain * u)``."""
        return self._native.joint_torques(samples("drive_signals", drive_signals, self.n))

    def joint_positions(self, motor_positions: ArrayLike) -> Array:
        """Joint positions (samples, n), rad or m, from the motors' positions: ``N^-1 q_motor + offset``."""
        return self._native.joint_positions(samples("motor_positions", motor_positions, self.n))

    def columns(self, parameters: _Columns) -> list[int]:
        """Indices of the standard parameters in `parameters`, as for :meth:`regressor`."""
        if isinstance(parameters, str):
            if parameters == "standard":
                return list(range(len(self.parameter_names)))
            if parameters == "base":
                return self._native.base_parameters([], {})[0]
            raise ValueError(f'parameters is "{parameters}"; expected "standard", "base" or a list of names')
        place = {name: index for index, name in enumerate(self.parameter_names)}
        unknown = [name for name in parameters if name not in place]
        if unknown:
            raise RobotError(f"the robot has no standard parameter {', '.join(unknown)}; its parameters are {' '.join(place)}")
        return [place[name] for name in parameters]

    def _theta(self, theta: ArrayLike | None) -> Array:
        return self.a_priori if theta is None else vector("theta", theta, len(self.parameter_names))

    def _refuse_channels(self) -> None:
        if self._native.channels:
            raise RobotError(
                f"torque terms of the robot need recorded channels ({', '.join(self._native.channels)}): "
                "identify from recordings with `channels`"
            )

    def __reduce__(self) -> tuple[type[Robot], tuple[_thetahat.Robot]]:
        return Robot, (self._native,)

    def __repr__(self) -> str:
        return f"<thetahat.Robot {self.name}: {self.n} joints, {len(self.parameter_names)} standard parameters>"
