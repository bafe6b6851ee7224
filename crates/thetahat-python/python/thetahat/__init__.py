"""Identification of the dynamic parameters of robots from recorded motion and torques.

From a robot description and arrays to estimates with intervals:

>>> import thetahat as th
>>> twin = th.testing.twin(seconds=10, seed=1)  # a simulated arm: robot, recording, true parameters
>>> result = th.identify(
...     twin.robot, twin.recording, methods=["idim-ls", "idim-iv"],
...     controller=twin.controller, cutoff_hz=40, decimation=10,
... )
>>> result.verdict
'good'
>>> run = result["idim-iv"]
>>> bool(abs(run["fv1"].estimate - twin.truth["fv1"]) < 0.1)
True

Arrays have a row for each sample and a column for each joint, in rad, rad/s, rad/s^2 and N m (m, m/s, m/s^2 and N for
prismatic joints). Errors are exceptions of :mod:`thetahat.errors`.
"""

from typing import TYPE_CHECKING

from . import errors, pinocchio, testing
from ._estimators import Regression
from ._filter_choice import Filter
from ._thetahat import VERSION as __version__
from .commands import (
    Designed,
    Finding,
    check,
    compare,
    design,
    export,
    generate,
    init,
    inspect,
    reduce,
    sample,
    sensitivity,
    simulate_experiment,
    solve,
)
from .controllers import PD, Cascaded, Controller
from .errors import (
    CampaignError,
    CommandError,
    EngineError,
    EstimationError,
    ExperimentError,
    PrecisionWarning,
    RecordingError,
    ReductionError,
    ReportError,
    ResultsError,
    RobotError,
    SettingsError,
    SignalError,
    SimulationError,
    ThetahatError,
)
from .estimation import Fit, estimate, measurement_vector, observation_matrix
from .identification import choose_filter, identify, run
from .recording import Recording, read, read_all
from .results import Advice, Model, ModelParameter, Parameter, Result, Run
from .robot import BaseParameter, Robot
from .signal import Motion, band_pass, decimate, derivative, zero_phase
from .simulation import Simulated, simulate

if TYPE_CHECKING:
    from . import distributed
else:

    def __getattr__(name):
        """Import the package `distributed` on first use."""
        if name == "distributed":
            import importlib

            return importlib.import_module("thetahat.distributed")
        raise AttributeError(f"module 'thetahat' has no attribute {name!r}")


__all__ = [
    "PD",
    "Advice",
    "BaseParameter",
    "CampaignError",
    "Cascaded",
    "CommandError",
    "Controller",
    "Designed",
    "EngineError",
    "EstimationError",
    "ExperimentError",
    "Filter",
    "Finding",
    "Fit",
    "Model",
    "ModelParameter",
    "Motion",
    "Parameter",
    "PrecisionWarning",
    "Recording",
    "RecordingError",
    "ReductionError",
    "Regression",
    "ReportError",
    "Result",
    "ResultsError",
    "Robot",
    "RobotError",
    "Run",
    "SettingsError",
    "SignalError",
    "Simulated",
    "SimulationError",
    "ThetahatError",
    "__version__",
    "band_pass",
    "check",
    "choose_filter",
    "compare",
    "decimate",
    "derivative",
    "design",
    "distributed",
    "errors",
    "estimate",
    "export",
    "generate",
    "identify",
    "init",
    "inspect",
    "measurement_vector",
    "observation_matrix",
    "pinocchio",
    "read",
    "read_all",
    "reduce",
    "run",
    "sample",
    "sensitivity",
    "simulate",
    "simulate_experiment",
    "solve",
    "testing",
    "zero_phase",
]
