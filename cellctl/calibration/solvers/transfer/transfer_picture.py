"""The evidence of a board transfer as one picture."""

from typing import TYPE_CHECKING

import numpy as np

from cellctl.calibration.drawing import as_png, bars, list_checks, new_figure, title
from cellctl.calibration.solvers.transfer.board_transfer import TransferResult
from cellctl.geometry.pose import MM
from cellctl.plot_style import ACCENT, GOOD, LIMIT, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@style()
def transfer_picture(result: TransferResult) -> bytes:
    """PNG: heads and base from above, residuals of large and small heads, checks."""
    figure = new_figure(13, 9)
    axes = figure.subplots(2, 2)
    title(figure, "Heads I and II in the base by the target board", passed=result.passed)
    _from_above(axes[0][0], result)
    for place, side, text in (
        (axes[0][1], " C ", "large-field head"),
        (axes[1][0], " C1 | C2 ", "small-field heads"),
    ):
        marks = side.split("|")
        chosen = {
            name: value
            for name, value in result.residuals_m.items()
            if any(f" {mark.strip()} " in name for mark in marks)
        }
        labels = [_short(name) for name in chosen]
        bars(place, labels, [value / MM for value in chosen.values()], "mm")
        place.set_title(f"distance of each disc from the drawing, {text}")
    list_checks(axes[1][1], result.checks, result.warnings)
    return as_png(figure)


def _short(name: str) -> str:
    """``head 1, placement 2, C P3`` as ``I.2 P3``."""
    head, placement, disc = name.split(", ")
    number = "I" if head.endswith("1") else "II"
    return f"{number}.{placement.rsplit(' ', 1)[-1]} {disc.split(' ')[-1]}"


def _from_above(axes: "Axes", result: TransferResult) -> None:
    poses = (("B", None), ("C1", result.base_T_c1), ("C2", result.base_T_c2))
    for name, pose in poses:
        origin = np.zeros(3) if pose is None else pose.pose.translation / MM
        frame = np.eye(3) if pose is None else pose.pose.rotation.as_matrix()
        for axis, color in enumerate((LIMIT, GOOD, ACCENT)):
            end = origin + 150 * frame[:, axis]
            axes.plot([origin[0], end[0]], [origin[1], end[1]], color=color)
        axes.annotate(name, (float(origin[0]), float(origin[1])))
    distance_mm = float(np.linalg.norm(result.c1_T_c2.pose.translation)) / MM
    axes.set(title=f"from above; heads {distance_mm:.1f} mm apart", aspect="equal")
    axes.set(xlabel="x of B / mm", ylabel="y of B / mm")
