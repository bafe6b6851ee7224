"""Campaigns, long recordings and fleets of robots beyond one machine: on threads, Dask or Ray.

A job takes texts and returns Parquet rows, triangular factors or estimates. The results have the same bytes for
any engine, number of workers and order. Each job writes its own file atomically: a job whose worker is killed is repeated,
a driver that is killed continues.

Programs that start Dask or Ray on this machine need ``if __name__ == "__main__":``, like all that start processes.
"""

from ._campaign import Campaign, campaign
from ._fleet import Fleet, ParameterEstimate, ParameterResult, RobotResult, Session, SessionResult, compare, fleet
from ._reduce import Reduced, reduce
from ._statistics import Dispersion, Estimate, Test

__all__ = [
    "Campaign",
    "Dispersion",
    "Estimate",
    "Fleet",
    "ParameterEstimate",
    "ParameterResult",
    "Reduced",
    "RobotResult",
    "Session",
    "SessionResult",
    "Test",
    "campaign",
    "compare",
    "fleet",
    "reduce",
]
