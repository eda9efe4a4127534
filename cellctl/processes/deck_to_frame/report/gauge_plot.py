"""The largest plug gauge that passed each pin hole (paper, figure 14)."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cellctl.plot_style import ACCENT, BEYOND, GOOD_FILL, INK, LIMIT, WITHIN, line, style, to_svg
from cellctl.processes.deck_to_frame.report.gauged_holes import GaugedHole

_FINE_MM = 0.4
"""Widest scale with a tick for every step of 0.01 mm; on a wider one they would touch."""


def plug_gauges(holes: Sequence[GaugedHole]) -> str:
    """One line a hole, from its least gauge to what has passed, in mm; at least one hole."""
    with style():
        height = 0.75 + 0.42 * len(holes)
        figure = Figure(figsize=(7.2, height), layout="constrained")
        axes = figure.subplots()
        for row, hole in enumerate(holes):
            at = (row - 0.5, row + 0.5)
            axes.fill_betweenx(at, hole.least_mm, hole.most_mm, color=GOOD_FILL, linewidth=0)
            axes.plot([hole.least_mm, hole.least_mm], at, **line(LIMIT), linewidth=1.0)
            _gauge(axes, row, hole)
        axes.set_yticks(range(len(holes)), [hole.gauge.hole for hole in holes], fontsize=9)
        axes.set_ylim(len(holes) - 0.3, -0.7)
        least = min(hole.least_mm for hole in holes)
        most = max(hole.most_mm for hole in holes)
        left = min(least, *(hole.gauge.diameter_mm for hole in holes))
        right = max(most, *(hole.gauge.diameter_mm for hole in holes))
        axes.set_xlim(left - 0.015, right + 0.012)
        if right - left <= _FINE_MM:
            axes.set_xticks(np.arange(least, most + 0.005, 0.02))
            axes.set_xticks(np.arange(least, most + 0.005, 0.01), minor=True)
        bores = ", ".join(dict.fromkeys(f"{hole.bore_mm:.2f}" for hole in holes))
        axes.set_xlabel(f"largest gauge that passes, mm (hole {bores})")
        axes.grid(axis="y", visible=False)
        return to_svg(figure)


def _gauge(axes: Axes, row: int, hole: GaugedHole) -> None:
    diameter_mm = hole.gauge.diameter_mm
    colour, marker = (LIMIT, BEYOND) if hole.failed else (ACCENT, WITHIN)
    axes.plot([hole.least_mm, diameter_mm], [row, row], **line(colour), linewidth=3)
    axes.plot(diameter_mm, row, marker, markersize=7, color=colour)
    axes.annotate(
        f"{diameter_mm:.2f} mm",
        (diameter_mm, row),
        xytext=(0, 7),
        textcoords="offset points",
        ha="center",
        color=INK,
        fontsize=8,
    )
