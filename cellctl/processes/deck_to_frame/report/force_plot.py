"""Force against time and against travel (paper, figure 12)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cellctl.force.contact.curve import ForceCurve
from cellctl.geometry.pose import MM, Array
from cellctl.plot_style import (
    ACCENT,
    GOOD,
    INK,
    LIMIT,
    SECOND,
    envelope,
    label_line,
    line,
    style,
    to_svg,
)

_CONTACT_MM = 0.5
"""Stretch at the end of the travel that is drawn once more, magnified: the contact lies in it."""


def force_by_time(curve: ForceCurve, target_n: float | None, limit_n: float | None) -> str:
    """Force along the approach and across it, over time."""
    with style():
        figure = Figure(figsize=(7.2, 2.7), layout="constrained")
        axes = figure.subplots()
        time_s = curve.time_s - (curve.time_s[0] if len(curve.time_s) else 0.0)
        _draw(axes, time_s, curve)
        axes.set_xlabel("time, s")
        _finish(axes, time_s, curve, target_n, limit_n)
        return to_svg(figure)


def force_by_travel(curve: ForceCurve, target_n: float | None, limit_n: float | None) -> str:
    """Force along the approach over travel from the stand-off: all of it, and the contact."""
    with style():
        figure = Figure(figsize=(7.2, 2.7), layout="constrained")
        whole, contact = figure.subplots(1, 2, sharey=True, width_ratios=(1, 2))
        known = np.isfinite(curve.travel_m)
        travel_mm, force_n = curve.travel_m[known] / MM, curve.wrench[known, 2]
        kept = ForceCurve(curve.time_s[known], curve.wrench[known], curve.travel_m[known])
        whole.plot(*envelope(travel_mm, force_n), color=ACCENT, linewidth=0.9)
        whole.set_xlabel("travel, mm")
        near = travel_mm > travel_mm.max() - _CONTACT_MM
        contact.plot(*envelope(travel_mm[near], force_n[near]), color=ACCENT, linewidth=0.9)
        contact.set_xlabel(f"the last {_CONTACT_MM:g} mm of travel, mm")
        _bounds(whole, target_n, limit_n, written=False)
        _finish(contact, travel_mm, kept, target_n, limit_n)
        contact.set_ylabel("")
        whole.set_ylabel("force, N")
        return to_svg(figure)


def _draw(axes: Axes, x: Array, curve: ForceCurve) -> None:
    lateral = np.hypot(curve.wrench[:, 0], curve.wrench[:, 1])
    lateral_label = "√(Fx² + Fy²)"
    axes.plot(*envelope(x, lateral), **line(SECOND), linewidth=0.8, label=lateral_label)
    axes.plot(*envelope(x, curve.wrench[:, 2]), color=ACCENT, linewidth=0.9, label="Fz")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)


def _finish(
    axes: Axes, x: Array, curve: ForceCurve, target_n: float | None, limit_n: float | None
) -> None:
    axes.set_ylabel("force, N")
    _bounds(axes, target_n, limit_n)
    force_n = curve.wrench[:, 2]
    if not len(force_n):
        return
    peak = int(np.argmax(force_n))
    axes.plot(x[peak], force_n[peak], "o", markersize=4, color=INK)
    axes.annotate(
        f"peak {force_n[peak]:.1f} N",
        (x[peak], force_n[peak]),
        xytext=(-6, 4),
        textcoords="offset points",
        ha="right",
        fontsize=7,
    )
    top = max(float(force_n.max()), limit_n or 0.0) * 1.15
    axes.set_ylim(min(float(force_n.min()) * 1.1, -2.0), max(top, 5.0))


def _bounds(
    axes: Axes, target_n: float | None, limit_n: float | None, *, written: bool = True
) -> None:
    if target_n is not None:
        label_line(axes, target_n, f"target {target_n:g} N" if written else "", GOOD)
    if limit_n is not None:
        label_line(axes, limit_n, f"limit {limit_n:g} N" if written else "", LIMIT)
