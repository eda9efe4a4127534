"""The evidence of a taught reference as one picture."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from cellctl.calibration.checks import Checks, all_passed
from cellctl.calibration.drawing import as_png, list_checks, new_figure, title
from cellctl.geometry.pose import Array
from cellctl.plot_style import ACCENT, style
from cellctl.processes.antenna_module.chain.reference.reference_looks import ReferenceLooks

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_UM = 1e-6


@style()
def reference_picture(looks: ReferenceLooks, checks: Checks) -> bytes:
    """PNG: scatter of the looks at marks and plate in µm, checks."""
    figure = new_figure(13, 5)
    marks, plate, text = figure.subplots(1, 3)
    title(figure, "Reference", passed=all_passed(checks))
    _scatter(marks, looks.turned().residuals_m)
    marks.set_title("gripper marks in camera II, beside their circle")
    _scatter(plate, looks.plate_in_camera_1)
    plate.set_title("plate in camera I, about its mean")
    list_checks(text, checks, ())
    return as_png(figure)


def _scatter(axes: "Axes", places_m: Sequence[Array] | Array) -> None:
    off_um = (np.asarray(places_m) - np.mean(places_m, axis=0)) / _UM
    axes.plot(off_um[:, 0], off_um[:, 1], "o", color=ACCENT)
    reach_um = 1.2 * max(10.0, float(np.abs(off_um).max()))
    axes.set(xlim=(-reach_um, reach_um), ylim=(-reach_um, reach_um), aspect="equal")
    axes.set_xlabel("x of the base, µm")
    axes.set_ylabel("y of the base, µm")
