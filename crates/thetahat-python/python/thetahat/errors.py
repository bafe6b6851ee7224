"""What thetahat raises: one class for each thing that can be wrong, with the texts of the library and remedies in the words of the package."""


class ThetahatError(Exception):
    """The base class of all errors of thetahat."""


class RobotError(ThetahatError, ValueError):
    """A robot description that cannot be used; the message names file, line and remedy."""


class RecordingError(ThetahatError, ValueError):
    """A recording that cannot be used."""


class SettingsError(ThetahatError, ValueError):
    """Settings that cannot be used, or that do not fit robot and recordings; keys are those of an experiment file."""


class ExperimentError(ThetahatError, ValueError):
    """An experiment file that cannot be read or run."""


class SignalError(ThetahatError, ValueError):
    """A filter or decimation that the samples do not allow."""


class EstimationError(ThetahatError, ValueError):
    """A regression that gives no estimate."""


class SimulationError(ThetahatError, RuntimeError):
    """A simulated loop that diverges, or has no accelerations."""


class ResultsError(ThetahatError, ValueError):
    """A ``results.json`` that cannot be read, or results without the requested data."""


class ReportError(ThetahatError, OSError):
    """A report that cannot be written."""


class CampaignError(ThetahatError, ValueError):
    """A campaign that cannot be read, run or stored."""


class ReductionError(ThetahatError, ValueError):
    """Recordings that cannot be reduced, or reductions that cannot be merged."""


class CommandError(ThetahatError, ValueError):
    """A command of the command line that ended with an error."""


class EngineError(ThetahatError, RuntimeError):
    """An engine that is not installed, does not answer, or loses its workers."""


class PrecisionWarning(UserWarning):
    """An array of less than double precision was converted; its resolution did not improve."""
