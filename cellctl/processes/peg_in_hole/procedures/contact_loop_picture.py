"""The picture of a contact loop: force against travel, and how the loop answers a step."""

import numpy as np

from cellctl.calibration.checks import Checks, all_passed
from cellctl.calibration.drawing import as_png, list_checks, new_figure, title
from cellctl.cell.contact_motion.commissioning import CommissionedLoop
from cellctl.geometry.pose import MM
from cellctl.plot_style import style


@style()
def loop_picture(found: CommissionedLoop, checks: Checks) -> bytes:
    """PNG: readings at standstill with their line, the answer to a step, and the checks."""
    figure = new_figure(15.0, 5.0)
    left, middle, right = figure.subplots(1, 3, width_ratios=(3, 3, 3))
    travel_m, force_n = found.readings.T
    stiffness_n_m = found.stiffness.stiffness_n_m
    begin_m = float(np.mean(travel_m - force_n / stiffness_n_m))
    left.plot((travel_m - begin_m) / MM, force_n, "o")
    ends_n = np.array([0.0, float(force_n.max())])
    left.plot(ends_n / stiffness_n_m / MM, ends_n, "-", label=f"{stiffness_n_m * MM:.1f} N/mm")
    left.set_xlabel("travel since the face / mm")
    left.set_ylabel("force on the face / N")
    left.legend()
    answer, dead_ms = found.answer, found.figures.dead_time_s * 1e3
    middle.plot(answer.times_s * 1e3, answer.rise_n, "-")
    middle.axhline(answer.step_n, linestyle="--", linewidth=1.0)
    middle.axvline(dead_ms, linestyle=":", label=f"dead time {dead_ms:.0f} ms")
    middle.set_xlabel("time since the step / ms")
    middle.set_ylabel("rise of the force / N")
    middle.legend()
    list_checks(right, checks, ())
    title(figure, "Contact loop of arm, part and sensor", passed=all_passed(checks))
    return as_png(figure)
