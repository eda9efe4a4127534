"""The evidence of a stereo calibration as one picture."""

from typing import TYPE_CHECKING

import numpy as np

from cellctl.calibration.boards.board_drawing import draw_board, draw_residuals
from cellctl.calibration.drawing import as_png, list_checks, new_figure, title
from cellctl.calibration.solvers.stereo.stereo_result import StereoResult
from cellctl.plot_style import LIMIT, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@style()
def stereo_picture(result: StereoResult) -> bytes:
    """PNG: residuals over both images, residuals per view, shape of the board, checks."""
    figure = new_figure(14, 9)
    axes = figure.subplots(2, 3)
    title(figure, f"Stereo head, {result.board}", passed=result.passed)
    for side, field, place in (
        ("left", result.left_residuals, axes[0][0]),
        ("right", result.right_residuals, axes[0][1]),
    ):
        draw_residuals(place, field, result.head.image_size, f"{side} residuals")
    _scatter(axes[0][2], result)
    _views(axes[1][0], result)
    draw_board(axes[1][1], result.board, result.board_m)
    list_checks(axes[1][2], result.checks, result.warnings)
    return as_png(figure)


def _scatter(axes: "Axes", result: StereoResult) -> None:
    for name, field in (("left", result.left_residuals), ("right", result.right_residuals)):
        axes.plot(field[:, 2], field[:, 3], ".", markersize=1.5, label=name)
    axes.set(title=f"residuals, rms {result.head.rms_px:.4f} px", aspect="equal")
    axes.set(xlabel="du / px", ylabel="dv / px")
    axes.legend(fontsize=8, markerscale=6)


def _views(axes: "Axes", result: StereoResult) -> None:
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
