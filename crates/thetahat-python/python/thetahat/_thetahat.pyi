"""The compiled part: arrays of float64 with two indices, as the package checks them."""

from collections.abc import Callable, Sequence
from typing import Any

from ._arrays import Array
from .recording import Recording

VERSION: str

_Progress = Callable[[str], object] | None

def command(arguments: list[str]) -> int: ...

class Robot:
    coordinates: int
    parameter_names: list[str]
    parameter_units: list[str]
    channels: list[str]
    a_priori: Array
    @staticmethod
    def parse(text: str, path: str, locked: dict[str, float]) -> Robot: ...
    @staticmethod
    def read(path: str, locked: dict[str, float]) -> Robot: ...
    def text(self) -> str: ...
    def summary(self) -> str: ...
    def base_parameters(
        self, excluded: list[str], fixed: dict[str, float]
    ) -> tuple[list[int], list[str], list[str], list[str]]: ...
    def base_of(self, theta: Array) -> Array: ...
    def standard_of(self, estimates: dict[str, float], excluded: list[str], fixed: dict[str, float]) -> Array: ...
    def regressor(
        self, motion: list[Array], columns: list[int], sign_velocity_scale: float | None, phi: Array
    ) -> None: ...
    def inverse_dynamics(
        self, motion: list[Array], theta: Array, sign_velocity_scale: float | None, tau: Array
    ) -> None: ...
    def forward_dynamics(
        self, inputs: list[Array], theta: Array, sign_velocity_scale: float | None, ddq: Array
    ) -> None: ...
    def mass_matrix(self, q: Array, theta: Array, masses: Array) -> None: ...
    def joint_torques(self, drive: Array) -> Array: ...
    def joint_positions(self, motors: Array) -> Array: ...

class Results:
    excluded: list[str]
    fixed: dict[str, float]
    @staticmethod
    def read(path: str) -> tuple[Results, Robot | None]: ...
    def to_json(self) -> str: ...
    def text(self) -> str: ...
    def render(self, name: str) -> bytes: ...
    def write_file(self, name: str, path: str) -> None: ...
    def write(self, folder: str) -> list[str]: ...
    def export(self, path: str, format: str, method: str | None, force: bool) -> list[str]: ...
    def curves(self) -> tuple[Array, Array, Array]: ...
    def run_curves(self, run: int) -> tuple[Array, Array]: ...

class Fit:
    """An estimate with its statistics."""

    theta: Array
    """The parameters, shape (columns,)."""
    covariance: Array
    """Classical covariance, shape (columns, columns)."""
    standard_deviation: Array
    """Classical standard deviations, shape (columns,)."""
    standard_deviation_robust: Array
    """With errors that are correlated in time and differ between joints, shape (columns,)."""
    interval_95: Array
    """Intervals of 95 % with such errors, shape (columns, 2)."""
    prediction: Array
    """What the parameters predict of y, shape (rows,)."""
    relative_error_percent: float
    """``100 |y - y_hat| / |y|``."""
    condition_number: float
    """Of the matrix that is solved."""

def identify(
    robot: Robot,
    recordings: list[Recording],
    validation: list[Recording],
    settings: dict[str, Any],
    title: str,
    progress: _Progress,
) -> Results: ...
def run(path: str, data: str, robot: str | None, progress: _Progress) -> tuple[Results, Robot]: ...
def choose_filter(
    robot: Robot, recordings: list[Recording], settings: dict[str, Any]
) -> tuple[float, int, list[str]]: ...
def read_recordings(
    robot: Robot, files: list[str], folder: str, columns: dict[str, Any]
) -> list[dict[str, Any]]: ...
def band_pass(
    position: Array, sample_rate_hz: float, cutoff_hz: float, order: int, derivative: str
) -> tuple[Array, Array, Array]: ...
def zero_phase(array: Array, sample_rate_hz: float, cutoff_hz: float, order: int) -> Array: ...
def derivative(array: Array, sample_rate_hz: float, kind: str) -> Array: ...
def decimate(array: Array, factor: int) -> Array: ...
def observation_matrix(
    robot: Robot,
    motion: list[Array],
    decimation: int,
    columns: Sequence[int],
    sign_velocity_scale: float | None,
) -> Array: ...
def measurement_vector(torque: Array, decimation: int) -> Array: ...
def estimate(
    method: str, x: Array, y: Array, z: Array | None, joints: int, weights: Array | None
) -> Fit: ...
def simulate(
    robot: Robot,
    reference: Array,
    sample_rate_hz: float,
    theta: Array,
    settings: dict[str, Any],
) -> tuple[Array, Array, Array, Array]: ...
