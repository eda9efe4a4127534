"""The evidence of a base-frame calibration as one picture."""

from typing import TYPE_CHECKING

import numpy as np

from cellctl.calibration.drawing import as_png, list_checks, new_figure, title
from cellctl.calibration.solvers.base_frame.axis_fit import AxisFit, perpendicular
from cellctl.calibration.solvers.base_frame.base_frame import BaseFrameResult
from cellctl.geometry.pose import MM
from cellctl.plot_style import INK, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@style()
def base_frame_picture(result: BaseFrameResult) -> bytes:
    """PNG: the circles of both axes seen along them, residuals per point, checks."""
    figure = new_figure(13, 9)
    axes = figure.subplots(2, 2)
    title(figure, "Base frame from A1 and A2", passed=result.passed)
    for number, (fit, place) in enumerate(zip(result.axes or (), axes[0], strict=False), start=1):
        _circles(place, fit)
        arc_deg = np.degrees(fit.arc_rad)
        place.set_title(f"A{number}: {arc_deg:.0f}°, {len(fit.targets)} targets, along the axis")
    _residuals(axes[1][0], result)
    list_checks(axes[1][1], result.checks, result.warnings)
    return as_png(figure)


def _circles(axes: "Axes", fit: AxisFit) -> None:
    first, second = perpendicular(fit.direction)
    relative = (fit.points_m - fit.point_m) / MM
    turn = np.linspace(0, 2 * np.pi, 200)
    for target, radius_m in zip(fit.targets, fit.radii_m, strict=True):
        rows = [name.endswith(f":{target}") for name in fit.residual_names]
        shown = relative[rows]
        points = axes.plot(shown @ first, shown @ second, ".", markersize=4, label=target)
        # Seen along the axis, a target that wobbles or slipped leaves its circle visibly.
        circle = radius_m / MM * np.stack([np.cos(turn), np.sin(turn)])
        axes.plot(*circle, linewidth=0.5, color=points[0].get_color())
    axes.plot(0, 0, "+", color=INK)
    axes.set(aspect="equal", xlabel="mm", ylabel="mm")
    axes.legend(fontsize=8, loc="center", ncols=2)


def _residuals(axes: "Axes", result: BaseFrameResult) -> None:
    for axis in ("A1", "A2"):
        chosen = [(name, value) for name, value in result.residuals_m.items() if axis in name]
        stops = [int(name.split(" ")[1].split(":")[0]) for name, _ in chosen]
        values_mm = [value / MM for _, value in chosen]
        axes.plot(stops, values_mm, "." if axis == "A1" else "x", label=axis)
    axes.set(
        title="distance of each target from its circle", xlabel="stop", ylabel="mm", ylim=(0, None)
    )
    axes.legend(fontsize=8)
