"""The largest plug gauge that passed each pin hole (paper, figure 14)."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from cellctl.plot_style import ACCENT, BEYOND, GOOD_FILL, INK, LIMIT, WITHIN, line, style, to_svg
from cellctl.records.entries import Gauge

HOLE_MM = 6.0
"""Pin hole of both parts: a gauge of 6.00 would mean no offset at all."""
LEAST_MM = 5.80
"""The acceptance of the paper: an offset of less than 0.2 mm."""


def plug_gauges(gauges: Sequence[Gauge]) -> str:
    """One scale a hole, 5.80 to 6.00 mm in steps of 0.01."""
    with style():
        height = 0.75 + 0.42 * len(gauges)
        figure = Figure(figsize=(7.2, height), layout="constrained")
        axes = figure.subplots()
        axes.axvspan(LEAST_MM, HOLE_MM, color=GOOD_FILL, linewidth=0)
        axes.axvline(LEAST_MM, **line(LIMIT), linewidth=1.0)
        for row, gauge in enumerate(gauges):
            passed = gauge.diameter_mm >= LEAST_MM
            colour = ACCENT if passed else LIMIT
            marker = WITHIN if passed else BEYOND
            axes.plot([LEAST_MM, gauge.diameter_mm], [row, row], **line(colour), linewidth=3)
            axes.plot(gauge.diameter_mm, row, marker, markersize=7, color=colour)
            axes.annotate(
                f"{gauge.diameter_mm:.2f} mm",
                (gauge.diameter_mm, row),
                xytext=(0, 7),
                textcoords="offset points",
                ha="center",
                color=INK,
                fontsize=8,
            )
        axes.set_yticks(range(len(gauges)), [gauge.hole for gauge in gauges], fontsize=9)
        axes.set_ylim(len(gauges) - 0.3, -0.7)
        least = min([LEAST_MM, *(gauge.diameter_mm for gauge in gauges)])
        axes.set_xlim(least - 0.015, HOLE_MM + 0.012)
        axes.set_xticks(np.arange(LEAST_MM, HOLE_MM + 0.005, 0.02))
        axes.set_xticks(np.arange(LEAST_MM, HOLE_MM + 0.005, 0.01), minor=True)
        axes.set_xlabel(f"largest gauge that passes, mm (hole {HOLE_MM:.2f})")
        axes.grid(axis="y", visible=False)
        return to_svg(figure)
