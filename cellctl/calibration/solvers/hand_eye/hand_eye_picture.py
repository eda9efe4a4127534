"""The evidence of a hand-eye calibration as one picture."""

import numpy as np

from cellctl.calibration.drawing import as_png, bars, list_checks, new_figure, title
from cellctl.calibration.solvers.hand_eye.hand_eye_result import HandEyeResult
from cellctl.geometry.pose import MM
from cellctl.plot_style import style


@style()
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
