"""The evidence of hand-eye and tool calibrations as pictures."""

import numpy as np

from cellctl.calibration.drawing import as_png, bars, list_checks, new_figure, title
from cellctl.calibration.solvers.hand_eye.hand_eye_result import HandEyeResult
from cellctl.calibration.solvers.tool.tool import ToolResult
from cellctl.geometry.pose import MM


def hand_eye_picture(result: HandEyeResult) -> bytes:
    """PNG: residuals per pose in mm and degrees, turns of the flange, checks."""
    figure = new_figure(13, 8)
    axes = figure.subplots(2, 2)
    title(figure, f"Hand-eye, {result.setup.value}", passed=result.passed)
    names = [f"{name} (out)" if name in result.rejected else name for name in result.residuals]
    distances, angles = np.array(list(result.residuals.values())).T
    bars(axes[0][0], names, (distances / MM).tolist(), "mm")
    axes[0][0].set_title("distance of the board from where it should be")
    bars(axes[0][1], names, np.degrees(angles).tolist(), "°")
    axes[0][1].set_title("angle of the board from where it should be")
    directions = ["strongest", "second", "weakest"]
    bars(axes[1][0], directions, np.degrees(result.spread_rad).tolist(), "° rms")
    axes[1][0].set_title("turns of the flange between poses, by direction")
    list_checks(axes[1][1], result.checks, result.warnings)
    return as_png(figure)


def tool_picture(result: ToolResult) -> bytes:
    """PNG: residual per touching pose, checks."""
    figure = new_figure(11, 5)
    left, right = figure.subplots(1, 2)
    title(figure, "Tool", passed=result.passed)
    names = [f"pose {number}" for number in range(1, len(result.residuals_m) + 1)]
    bars(left, names, [value / MM for value in result.residuals_m], "mm")
    left.set_title("distance of the tip from the common point")
    list_checks(right, result.checks, ())
    return as_png(figure)
