"""The evidence of a plug correction as one picture."""

from typing import TYPE_CHECKING

import numpy as np

from cellctl.calibration.drawing import as_png, list_checks, new_figure, title
from cellctl.geometry.pose import MM, Array
from cellctl.plot_style import LIMIT, style
from cellctl.processes.antenna_module.chain.teaching.taught import PlugCorrection, TaughtSlot
from cellctl.processes.antenna_module.chain.teaching.teaching import TeachLimits

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_UM = 1e-6


@style()
def taught_picture(correction: PlugCorrection, limits: TeachLimits | None = None) -> bytes:
    """PNG: each taught plug beside the mean of its slot in x, y and yaw, their scatter, limits,
    checks. Of a correction that was read from its record the single plugs are not known."""
    limits = limits or TeachLimits()
    figure = new_figure(14, 5)
    plane, yaw, text = figure.subplots(1, 3)
    title(figure, "Plug correction", passed=correction.passed)
    for slot in correction.slots:
        _draw(plane, yaw, slot)
    _bound(plane, correction, limits.scatter_m / _UM)
    for sign in (-1.0, 1.0):
        yaw.axhline(sign * float(np.degrees(limits.scatter_rad)), color=LIMIT, linestyle="--")
    plane.set_title("taught plugs beside their mean")
    plane.set_xlabel("x of the socket, µm")
    plane.set_ylabel("y of the socket, µm")
    yaw.set_title("their yaw")
    yaw.set_xlabel("plug")
    yaw.set_ylabel("yaw from the mean, °")
    plane.legend(loc="upper right")
    text.set_title(f"holds within {correction.range_m / MM:.0f} mm of a taught slot")
    list_checks(text, correction.checks, ())
    return as_png(figure)


def _draw(plane: "Axes", yaw: "Axes", slot: TaughtSlot) -> None:
    off = slot.from_mean
    x, y = _circle(slot.scatter_m / _UM)
    (scatter,) = plane.plot(x, y, label=f"slot {slot.name}, {slot.plugs} plugs, 1 σ")
    plane.plot(off[:, 0] / _UM, off[:, 1] / _UM, "o", color=scatter.get_color())
    deg = float(np.degrees(slot.scatter_rad))
    yaw.axhspan(-deg, deg, alpha=0.15, color=scatter.get_color())
    numbers = np.arange(1, len(off) + 1)
    yaw.plot(numbers, np.degrees(off[:, 2]), "o", color=scatter.get_color())
    yaw.set_xticks(numbers)


def _bound(axes: "Axes", correction: PlugCorrection, limit_um: float) -> None:
    """The standard deviation per axis that is allowed, and room for what is beyond it."""
    axes.plot(*_circle(limit_um), "--", color=LIMIT, label="limit, 1 σ")
    farthest_m = max(np.abs(slot.from_mean[:, :2]).max(initial=0.0) for slot in correction.slots)
    reach_um = 1.3 * max(limit_um, float(farthest_m) / _UM)
    axes.set(xlim=(-reach_um, reach_um), ylim=(-reach_um, reach_um), aspect="equal")


def _circle(radius: float) -> tuple[Array, Array]:
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    return np.asarray(radius * np.cos(turn)), np.asarray(radius * np.sin(turn))
