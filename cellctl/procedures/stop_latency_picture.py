"""The picture of a stop latency: overrun against speed."""

import numpy as np

from cellctl.calibration.checks import Checks, all_passed
from cellctl.calibration.drawing import as_png, list_checks, new_figure, title
from cellctl.force.contact.commissioning import LatencyEstimate
from cellctl.geometry.pose import MM, Array
from cellctl.plot_style import style


@style()
def latency_picture(
    estimate: LatencyEstimate, speeds_m_s: Array, overruns_m: Array, checks: Checks
) -> bytes:
    """PNG: overrun of every stop, the line whose slope is the latency, and the checks."""
    figure = new_figure(11.0, 5.0)
    left, right = figure.subplots(1, 2, width_ratios=(3, 2))
    left.plot(speeds_m_s / MM, overruns_m / MM, "o", markersize=4)
    line_m_s = np.array([0.0, float(speeds_m_s.max())])
    left.plot(line_m_s / MM, (estimate.latency_s * line_m_s + estimate.offset_m) / MM, "-")
    left.set_xlabel("speed / mm/s")
    left.set_ylabel("way from request to standstill / mm")
    list_checks(right, checks, ())
    title(figure, f"Stop latency {estimate.latency_s * 1e3:.0f} ms", passed=all_passed(checks))
    return as_png(figure)
