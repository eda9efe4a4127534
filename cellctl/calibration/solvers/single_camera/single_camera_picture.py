"""The evidence of the calibration of one camera as one picture."""

from typing import TYPE_CHECKING

import numpy as np

from cellctl.calibration.boards.board_drawing import draw_board, draw_residuals
from cellctl.calibration.drawing import as_png, list_checks, new_figure, title
from cellctl.calibration.solvers.single_camera.single_camera_result import SingleCameraResult
from cellctl.plot_style import ACCENT, LIMIT, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@style()
def single_camera_picture(result: SingleCameraResult) -> bytes:
    """PNG: residuals over the image, residuals per view, shape of the board, checks."""
    figure = new_figure(12, 8)
    axes = figure.subplots(2, 2)
    title(figure, f"Camera, {result.board}", passed=result.passed)
    draw_residuals(axes[0][0], result.residuals, result.camera.image_size, "residuals")
    _views(axes[0][1], result)
    draw_board(axes[1][0], result.board, result.board_m)
    list_checks(axes[1][1], result.checks, result.warnings)
    return as_png(figure)


def _views(axes: "Axes", result: SingleCameraResult) -> None:
    places = np.arange(len(result.views))
    colours = [ACCENT if view.used else LIMIT for view in result.views]
    axes.bar(places, [view.rms_px for view in result.views], color=colours)
    axes.set_xticks(places, [view.name for view in result.views], rotation=90, fontsize=7)
    axes.set(title="rms per view (rejected: red)", ylabel="px")
    axes.grid(visible=False, axis="x")
