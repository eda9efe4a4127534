"""The evidence of a stereo calibration as one picture."""

import numpy as np
from matplotlib.axes import Axes

from cellctl.calibration.drawing import as_png, list_checks, new_figure, title
from cellctl.calibration.solvers.stereo.stereo_result import StereoResult
from cellctl.geometry.pose import MM, Array
from cellctl.plot_style import ACCENT, LIMIT, style

_MAX_ARROWS = 2500
_ARROW_SCALE = 400.0
"""Image pixels per pixel of residual."""


@style()
def stereo_picture(result: StereoResult) -> bytes:
    """PNG: residuals over both images, residuals per view, shape of the board, checks."""
    figure = new_figure(14, 9)
    axes = figure.subplots(2, 3)
    title(figure, f"Stereo head, {result.board}", passed=result.passed)
    width, height = result.head.image_size
    for side, field, place in (
        ("left", result.left_residuals, axes[0][0]),
        ("right", result.right_residuals, axes[0][1]),
    ):
        _residual_field(place, field)
        place.set(title=f"{side} residuals, x {_ARROW_SCALE:.0f}", aspect="equal")
        place.set(xlim=(0, width), ylim=(height, 0), xlabel="px")
    _scatter(axes[0][2], result)
    _views(axes[1][0], result)
    _board(axes[1][1], result)
    list_checks(axes[1][2], result.checks, result.warnings)
    return as_png(figure)


def _residual_field(axes: Axes, field: Array) -> None:
    # More arrows would cover each other, and a pattern of the residuals shows with fewer.
    chosen = field[:: max(1, len(field) // _MAX_ARROWS)]
    axes.quiver(
        chosen[:, 0],
        chosen[:, 1],
        chosen[:, 2] * _ARROW_SCALE,
        chosen[:, 3] * _ARROW_SCALE,
        angles="xy",
        scale_units="xy",
        scale=1.0,
        width=0.002,
        color=ACCENT,
    )


def _scatter(axes: Axes, result: StereoResult) -> None:
    for name, field in (("left", result.left_residuals), ("right", result.right_residuals)):
        axes.plot(field[:, 2], field[:, 3], ".", markersize=1.5, label=name)
    axes.set(title=f"residuals, rms {result.head.rms_px:.4f} px", aspect="equal")
    axes.set(xlabel="du / px", ylabel="dv / px")
    axes.legend(fontsize=8, markerscale=6)


def _views(axes: Axes, result: StereoResult) -> None:
    places = np.arange(len(result.views))
    axes.bar(places - 0.2, [view.left_rms_px for view in result.views], 0.4, label="left")
    axes.bar(places + 0.2, [view.right_rms_px for view in result.views], 0.4, label="right")
    for place, view in enumerate(result.views):
        if not view.used:
            axes.axvspan(place - 0.5, place + 0.5, color=LIMIT, alpha=0.3)
    labels = [view.name for view in result.views]
    axes.set_xticks(places, labels, rotation=90, fontsize=7)
    axes.set(title="rms per view (rejected: red)", ylabel="px")
    axes.margins(y=0.12)  # room for the legend above the bars
    axes.grid(visible=False, axis="x")
    axes.legend(fontsize=8, loc="upper right", ncols=2)


def _board(axes: Axes, result: StereoResult) -> None:
    shape = (result.board.rows, result.board.columns)
    x, y, z = (result.board_m[:, axis].reshape(shape) / MM for axis in range(3))
    axes.grid(visible=False)
    shown = axes.contourf(x, y, z * 1000, levels=15, cmap="viridis")
    axes.figure.colorbar(shown, ax=axes, label="µm")
    flatness_um = result.flatness_m / MM * 1000
    axes.set(title=f"board as found, flat to {flatness_um:.0f} µm", aspect="equal", xlabel="mm")
