"""Force over depth of an insertion, with what each depth allows."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from cellctl.geometry.pose import MM
from cellctl.plot_style import ACCENT, LIMIT, MUTED, SECOND, envelope, line, style, to_svg
from cellctl.processes.antenna_module.insertion.curve import InsertionCurve

Bounds = Sequence[tuple[float, float, float]]
"""From and to a depth in mm, the axial force in N that is allowed there."""


def force_by_depth(curve: InsertionCurve, bounds: Bounds, seat_mm: float | None) -> str:
    """Resistance and side force over depth, as SVG; the seat, if felt, as a dotted line."""
    with style():
        figure = Figure(figsize=(7.2, 3.0), layout="constrained")
        axes = figure.subplots()
        depth_mm = curve.depth_m / MM
        side_n = np.hypot(curve.force_n[:, 0], curve.force_n[:, 1])
        axes.plot(*envelope(depth_mm, side_n), **line(SECOND), linewidth=0.8, label="√(Fx² + Fy²)")
        axes.plot(*envelope(depth_mm, curve.force_n[:, 2]), color=ACCENT, linewidth=0.9, label="Fz")
        for number, (begin_mm, end_mm, force_n) in enumerate(bounds):
            label = "" if number else "allowed Fz"
            across = [begin_mm, end_mm], [force_n, force_n]
            axes.plot(*across, **line(LIMIT), linewidth=1.0, label=label)
        if seat_mm is not None:
            axes.axvline(seat_mm, color=MUTED, linewidth=0.8, linestyle=":", label="seat")
        axes.set_xlabel("depth from the first touch, mm")
        axes.set_ylabel("force, N")
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, borderaxespad=0.2)
        return to_svg(figure)
