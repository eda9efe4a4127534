"""The evidence of a turn about the flange axis as one picture."""

import numpy as np

from cellctl.calibration.drawing import as_png, list_checks, new_figure, title
from cellctl.geometry.pose import MM
from cellctl.plot_style import ACCENT, LIMIT, style
from cellctl.processes.antenna_module.chain.teaching.tool_turn import ToolTurnResult

_UM = 1e-6


@style()
def turn_picture(result: ToolTurnResult) -> bytes:
    """PNG: where the feature was seen round the axis, what is left of each look, checks."""
    figure = new_figure(14, 5)
    circle, rest, text = figure.subplots(1, 3)
    title(figure, "Turn about the flange axis", passed=result.passed)
    round_mm = np.linspace(0.0, 2.0 * np.pi, 181)
    radius_mm = float(np.linalg.norm(result.offset_m)) / MM
    x_mm, y_mm = result.axis_m / MM
    circle.plot(x_mm + radius_mm * np.cos(round_mm), y_mm + radius_mm * np.sin(round_mm), "--")
    circle.plot(*(result.seen_m / MM).T, "o", color=ACCENT, label="feature")
    circle.plot(x_mm, y_mm, "+", color=LIMIT, label="axis")
    circle.set(aspect="equal", xlabel="x of the camera, mm", ylabel="y of the camera, mm")
    circle.set_title(f"feature {radius_mm:.3f} mm beside the axis")
    circle.legend(loc="upper right")
    left_um = result.residuals_m / _UM
    rest.plot(left_um[:, 0], left_um[:, 1], "o", color=ACCENT)
    reach_um = 1.2 * max(10.0, float(np.abs(left_um).max(initial=0.0)))
    rest.set(xlim=(-reach_um, reach_um), ylim=(-reach_um, reach_um), aspect="equal")
    rest.set(xlabel="x, µm", ylabel="y, µm", title="seen beside the circle")
    list_checks(text, result.checks, ())
    return as_png(figure)
