"""Campaigns, long recordings and fleets of robots beyond one machine: on threads, Dask or Ray.

A job is one of the library's own: texts in, Parquet rows, triangular factors or estimates out. What comes out has the same bytes for
any engine, number of workers and order. Each job leaves a file of its own, whole or not at all: a job whose worker is killed is done
again, a driver that is killed goes on where it was.

Programs that begin Dask or Ray on this machine need ``if __name__ == "__main__":``, as any that begin processes.
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
