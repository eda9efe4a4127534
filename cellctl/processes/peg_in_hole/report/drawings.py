"""Pictures of one insertion: the search on its face, and what was felt on the way in."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cellctl.geometry.pose import Array
from cellctl.plot_style import (
    ACCENT,
    GOOD,
    GOOD_FILL,
    LIMIT,
    MUTED,
    SECOND,
    envelope,
    line,
    style,
    to_svg,
)
from cellctl.processes.peg_in_hole.insertion.felt import OUT_OF_BAND_N, OUT_OF_BAND_N_M

_POINTS = {
    "face": (MUTED, "."),
    "dip": (SECOND, "v"),
    "edge": (ACCENT, "s"),
    "wall": (LIMIT, "x"),
    "entry": (GOOD, "*"),
}
"""Colour and marker by what was felt."""
_MOST_JAM = 2.0
"""Drawn at the rim of the picture where it is more."""


def search_picture(trace: Mapping[str, Any], belief: Mapping[str, Any]) -> str:
    """Where the peg touched, over what is still believed of the hole; depth along the path. SVG."""
    points = trace["points"]
    x, y, depth, time_s = (
        np.array([point[name] for point in points])
        for name in ("x_mm", "y_mm", "depth_mm", "time_s")
    )
    with style():
        figure = Figure(figsize=(7.2, 3.4), layout="constrained")
        face, path = figure.subplots(1, 2)
        reach = belief["reach_mm"]
        face.imshow(
            np.array(belief["weights"]).T,
            origin="lower",
            extent=(-reach, reach, -reach, reach),
            cmap="Greys",
            vmin=0.0,
            vmax=2.0,
        )
        face.plot(x, y, color=MUTED, linewidth=0.5)
        for felt, (colour, marker) in _POINTS.items():
            chosen = np.array([point["felt"] == felt for point in points])
            if chosen.any():
                face.plot(x[chosen], y[chosen], marker, markersize=4, color=colour, label=felt)
                when_s = time_s[chosen] - time_s[0]
                path.plot(when_s, depth[chosen], marker, markersize=4, color=colour)
        # Runs of earlier versions have classified nothing.
        for contact in trace.get("contacts", []):
            face.plot(contact["x_mm"], contact["y_mm"], "P", color=ACCENT, label=contact["class"])
        face.set_xlabel("x on the face, mm")
        face.set_ylabel("y, mm")
        face.legend(loc="upper right", fontsize=7)
        path.plot(time_s - time_s[0], depth, color=MUTED, linewidth=0.5)
        path.invert_yaxis()
        path.set_xlabel("time of the search, s")
        path.set_ylabel("depth below the face, mm")
        return to_svg(figure)


def insertion_picture(
    ticks: Mapping[str, Array], limit_n: float | None = None, jam: Array | None = None
) -> str:
    """Force along the axis and across it, moment, and nearness of a jam, over depth. SVG.

    ``limit_n``: of the insertion; None where the record does not say. ``jam`` (n,): ratio of each
    tick, 1 on the border, NaN where it cannot be told or decides nothing.
    """
    with style():
        rows, heights = (2, (2, 1)) if jam is None else (3, (2, 1, 1))
        figure = Figure(figsize=(7.2, 3.6 if jam is None else 4.6), layout="constrained")
        force, moment, *others = figure.subplots(rows, 1, sharex=True, height_ratios=heights)
        depth = ticks["depth_mm"]
        across_n = np.hypot(ticks["fx_n"], ticks["fy_n"])
        force.plot(*envelope(depth, across_n), **line(SECOND), linewidth=0.8, label="√(Fx² + Fy²)")
        force.plot(*envelope(depth, -ticks["fz_n"]), color=ACCENT, linewidth=0.9, label="−Fz")
        across_n_m = np.hypot(ticks["mx_nm"], ticks["my_nm"])
        moment.plot(*envelope(depth, across_n_m), **line(SECOND), linewidth=0.8)
        # Of a peg that slides in freely: beyond it the insertion takes side force and moment for a
        # jam, and not for a closed hole.
        force.axhspan(0.0, OUT_OF_BAND_N, color=GOOD_FILL, zorder=0, label="free peg, across")
        moment.axhspan(0.0, OUT_OF_BAND_N_M, color=GOOD_FILL, zorder=0)
        if limit_n is not None:
            force.axhline(limit_n, color=LIMIT, linestyle="--", linewidth=0.8, label="limit")
        for axes in others:
            _draw_jam(axes, depth, jam)
        force.set_ylabel("force, N")
        # Which moment it is stands below the picture: a longer word would be higher than the axis.
        moment.set_ylabel("moment, N·m")
        figure.axes[-1].set_xlabel("depth below the face, mm")
        # Over the axes: within them it would cover curve or limit.
        force.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=4)
        return to_svg(figure)


def _draw_jam(axes: Axes, depth_mm: Array, jam: Array | None) -> None:
    """Of the ticks that tell it; a line would join what was felt at different times."""
    assert jam is not None
    told = np.isfinite(jam)
    axes.plot(depth_mm[told], np.minimum(jam[told], _MOST_JAM), ".", markersize=2, color=ACCENT)
    axes.axhline(1.0, color=LIMIT, linestyle="--", linewidth=0.8)
    axes.set_ylim(0.0, _MOST_JAM * 1.05)
    axes.set_ylabel("jam ratio")
