"""Figures of Matplotlib that notebooks show without a backend."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ._arrays import Array
    from .recording import Recording


class ShownFigure(Figure):
    """A figure with a picture of itself: it does not belong to pyplot, which would show it otherwise."""

    def _repr_png_(self) -> bytes:
        content = io.BytesIO()
        self.savefig(content, format="png", dpi=100)
        return content.getvalue()


def rows_of_axes(count: int) -> tuple[Figure, list[Axes]]:
    """A figure with axes above one another over the same time."""
    figure = ShownFigure(figsize=(8.0, 1.0 + 1.8 * count), layout="constrained")
    axes = list(figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0])
    axes[-1].set_xlabel("time [s]")
    return figure, axes


def recording_figure(recording: Recording) -> Figure:
    """The signals of a recording, one below another, with a line for each joint."""
    signals = {
        "position [rad or m]": recording.position,
        "velocity [rad/s or m/s]": recording.velocity,
        "torque [N m or N]": recording.torque,
    }
    held = {label: array for label, array in signals.items() if array is not None}
    figure, axes = rows_of_axes(len(held))
    labels = recording.joints or [f"joint {k + 1}" for k in range(recording.position.shape[1])]
    for axis, (label, array) in zip(axes, held.items(), strict=True):
        _lines(axis, recording.times(), array, labels)
        axis.set_ylabel(label)
    axes[0].legend(loc="upper right")
    return figure


def _lines(axis: Axes, time: Array, array: Array, labels: tuple[str, ...] | list[str]) -> None:
    for joint, label in enumerate(labels):
        axis.plot(time, array[:, joint], label=label, linewidth=1.0)
