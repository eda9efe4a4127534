"""The evidence of a tool calibration as one picture."""

from cellctl.calibration.drawing import as_png, bars, list_checks, new_figure, title
from cellctl.calibration.solvers.tool.tool import ToolResult
from cellctl.geometry.pose import MM
from cellctl.plot_style import style


@style()
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
