"""The picture of a contact stiffness: force against travel."""

import numpy as np

from cellctl.calibration.checks import Checks, all_passed
from cellctl.calibration.drawing import as_png, list_checks, new_figure, title
from cellctl.geometry.pose import MM
from cellctl.plot_style import style
from cellctl.processes.deck_to_frame.mating.commissioning import ContactStiffness
from cellctl.processes.deck_to_frame.procedures.contact_stiffness_result import readings_of


@style()
def stiffness_picture(measured: ContactStiffness, checks: Checks) -> bytes:
    """PNG: standstill readings of every contact with their line, and the checks."""
    figure = new_figure(11.0, 5.0)
    left, right = figure.subplots(1, 2, width_ratios=(3, 2))
    for number, (single, contact) in enumerate(
        zip(measured.single, measured.contacts, strict=True), start=1
    ):
        travel_m = np.array([reading.travel_m for reading in readings_of(contact)])
        force_n = np.array([reading.force_n for reading in readings_of(contact)])
        text = f"contact {number}: {single.stiffness_n_m * MM:.0f} N/mm"
        (dots,) = left.plot(travel_m / MM, force_n, "o", markersize=4, label=text)
        ends_m = np.array([single.contact_m, travel_m.max()])
        line_n = single.stiffness_n_m * (ends_m - single.contact_m)
        left.plot(ends_m / MM, line_n, "-", color=dots.get_color(), linewidth=1.0)
    left.set_xlabel("travel from the stand-off / mm")
    left.set_ylabel("force along the approach / N")
    left.legend(fontsize="small")
    list_checks(right, checks, ())
    title(figure, "Contact stiffness, arm and contact in series", passed=all_passed(checks))
    return as_png(figure)
