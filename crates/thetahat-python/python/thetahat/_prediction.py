"""The motion of a recording, for predictions of its torques sample by sample."""

from __future__ import annotations

import numpy as np

from ._arrays import Array
from .errors import RecordingError
from .recording import Recording
from .signal import Motion, band_pass

_EVEN = 1e-3
"""Largest deviation of a step from the others, as a part of it, of samples that count as equally spaced."""
_SEGMENT_S = 2.0
"""Length of the segments of which spectra are averaged."""
_SHORTEST = 256
"""Samples below which there is no useful spectrum."""
_SIGNAL_TO_NOISE = 4.0
"""Ratio of the powers of motion and noise down to which the motion is kept."""
_WIDEST = 5.0
"""Largest cut-off as a multiple of the cut-off of the identification: noise that the logger has filtered is not a flat floor."""
_NYQUIST = 0.4
"""Largest cut-off as a part of the sample rate."""

_WIDER = 2.0
"""Factor of the cut-off where the motion jumps."""
_PERIODS = 3.0
"""Periods of the cut-off by which a motion is continued at its ends."""
_FEWEST = 8
"""Samples by which it is continued at least."""
_JUMP = 6.0
"""Standard deviations of the difference of both accelerations beyond which a motion jumps."""


def motion_of(recording: Recording, cutoff_hz: float) -> Motion:
    """Positions, velocities and accelerations at the samples of a recording.

    Each joint has the cut-off at which the spectrum of its position falls to the noise. An identification filters more, since
    it may leave out what its parameters do not need; `cutoff_hz` is its cut-off. Around jumps of the acceleration, which stand
    out of the noise at a wider cut-off, that one is used: otherwise the peak of the torque there would be spread.
    """
    if recording.sample_rate_hz is not None:
        return _filtered(recording.position, recording.sample_rate_hz, cutoff_hz)
    time = recording.times()
    steps = np.diff(time)
    if not len(steps) or np.any(steps <= 0):
        raise RecordingError("the times of the recording do not increase; sort its samples and leave out repeated ones")
    mean = float(time[-1] - time[0]) / len(steps)
    if np.max(np.abs(steps - mean)) <= _EVEN * mean:
        return _filtered(recording.position, 1.0 / mean, cutoff_hz)
    return _resampled(time, recording.position, float(np.median(steps)), cutoff_hz)


def _resampled(time: Array, position: Array, step: float, cutoff_hz: float) -> Motion:
    """The motion by way of equal steps, back at the recorded times."""
    even = np.arange(time[0], time[-1] + 0.5 * step, step)
    motion = _filtered(_interpolated(even, time, position), 1.0 / step, cutoff_hz)
    return Motion(*(_interpolated(time, even, array) for array in motion))


def _interpolated(at: Array, time: Array, values: Array) -> Array:
    return np.column_stack([np.interp(at, time, column) for column in values.T])


def _filtered(position: Array, rate_hz: float, cutoff_hz: float) -> Motion:
    joints = [_of_joint(column, rate_hz, _cutoff(column, rate_hz, cutoff_hz)) for column in position.T]
    return Motion(*(np.column_stack(arrays) for arrays in zip(*joints, strict=True)))


def _of_joint(position: Array, rate_hz: float, cutoff_hz: float) -> list[Array]:
    """Position, velocity and acceleration of a joint, with a wider filter around jumps."""
    samples = min(max(round(_PERIODS * rate_hz / cutoff_hz), _FEWEST), len(position))
    motion = _of_longer(_continued(position, samples), rate_hz, cutoff_hz)
    return [array[samples : len(array) - samples] for array in motion]


def _continued(position: Array, samples: int) -> Array:
    """A position that goes on at both ends as the cubic through its last samples: filters reflect it there."""
    time = np.linspace(-1.0, 1.0, samples)
    later = 1.0 + (time[1] - time[0]) * np.arange(1, samples + 1) if samples > 1 else np.ones(1)
    powers = min(3, samples - 1)
    fits = (np.polynomial.polynomial.polyfit(time, end, powers) for end in (position[:samples][::-1], position[-samples:]))
    ends = [np.polynomial.polynomial.polyval(later, fit) for fit in fits]
    return np.concatenate([ends[0][::-1], position, ends[1]])


def _of_longer(position: Array, rate_hz: float, cutoff_hz: float) -> list[Array]:
    narrow = band_pass(position, rate_hz, cutoff_hz)
    wide = band_pass(position, rate_hz, min(_WIDER * cutoff_hz, _NYQUIST * rate_hz))
    difference = np.abs(wide.acceleration - narrow.acceleration)[:, 0]
    # A quantile, not the variance, which the jumps themselves increase.
    deviation = np.quantile(difference, 0.95) / 1.96
    reach = max(1, round(0.5 * rate_hz / cutoff_hz))
    count = np.convolve(difference > _JUMP * deviation, np.ones(2 * reach + 1))
    jumps = count[reach : reach + len(difference)] > 0.5
    return [np.where(jumps, w[:, 0], n[:, 0]) for w, n in zip(wide, narrow, strict=True)]


def _cutoff(position: Array, rate_hz: float, cutoff_hz: float) -> float:
    """Where the spectrum of a position first falls to its noise, the median of the upper half."""
    if len(position) < _SHORTEST:
        return cutoff_hz
    frequency, power = _spectrum(position, rate_hz)
    noise = np.median(power[len(power) // 2 :])
    smooth = np.convolve(power, np.full(5, 0.2), "same")
    peak = int(np.argmax(smooth))
    below = np.nonzero(smooth[peak:] < (1.0 + _SIGNAL_TO_NOISE) * noise)[0]
    crossing = frequency[peak + below[0]] if len(below) else frequency[-1]
    return float(np.clip(crossing, 1.0, min(_WIDEST * cutoff_hz, _NYQUIST * rate_hz)))


def _spectrum(position: Array, rate_hz: float) -> tuple[Array, Array]:
    """Frequencies and the mean power of overlapping segments without their trend."""
    length = min(len(position), max(_SHORTEST, round(_SEGMENT_S * rate_hz)))
    starts = range(0, len(position) - length + 1, max(1, length // 2))
    ramp, window = np.linspace(-1.0, 1.0, length), np.hanning(length)
    power = np.zeros(length // 2 + 1)
    for start in starts:
        segment = position[start : start + length] - np.mean(position[start : start + length])
        power += np.abs(np.fft.rfft(window * (segment - ramp * (ramp @ segment) / (ramp @ ramp)))) ** 2
    return np.asarray(np.fft.rfftfreq(length, 1.0 / rate_hz), dtype=np.float64), power / len(starts)
