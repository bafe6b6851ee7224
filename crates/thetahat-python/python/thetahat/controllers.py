"""Controllers of the simulated loop."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

_OneOrEach = float | Sequence[float] | None


@dataclasses.dataclass(frozen=True)
class Controller:
    """An independent controller for each motor; one number applies to all motors, a sequence has one for each.

    Give either ``bandwidth_hz``, from which the gains follow with the inertia, or both gains. `PD` and `Cascaded` are the two
    laws.

    Parameters
    ----------
    bandwidth_hz : float or sequence
        Natural frequency of each loop, Hz.
    damping : float
        Damping of loops with a given bandwidth.
    position_gain, velocity_gain : float or sequence
        Gains, if they are known; drive signal per rad (m) and per rad/s (m/s), or 1/s and drive signal per rad/s for a
        cascade.
    velocity_feed_forward, acceleration_feed_forward : float
        Shares of the reference's derivatives that are fed forward.
    saturation : float or sequence
        Largest drive signal.
    sample_time_s, delay_s : float
        Sample time, zero for a continuous controller, and the delay from a sample to its control signal.
    velocity : {"exact", "averaged-difference"}
        The velocity signal of the controller.
    """

    bandwidth_hz: _OneOrEach = None
    damping: float = 1.0
    position_gain: _OneOrEach = None
    velocity_gain: _OneOrEach = None
    velocity_feed_forward: float = 0.0
    acceleration_feed_forward: float = 0.0
    saturation: _OneOrEach = None
    sample_time_s: float = 0.0
    delay_s: float = 0.0
    velocity: str = "exact"

    _law = ""

    def settings(self) -> dict[str, Any]:
        """The table ``[controller]`` of an experiment file."""
        return {"law": self._law, **dataclasses.asdict(self)}


class PD(Controller):
    """``u = kp (r - q) + kv (f_v dr - v) + f_a J ddr``.

    Examples
    --------
    >>> PD(bandwidth_hz=20).settings()["law"]
    'pd'
    """

    _law = "pd"


class Cascaded(Controller):
    """A position loop around a velocity loop: ``u = kv (kp (r - q) + f_v dr - v) + f_a J ddr``."""

    _law = "cascaded"
