"""Picture of one stream over its time: what the arm did, how fast, and how old its ticks were."""

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cellctl.geometry.pose import Array
from cellctl.plot_style import ACCENT, INK, LIMIT, MUTED, SECOND, envelope, line, style, to_svg
from cellctl.processes.peg_in_hole.record.tick_log import ReadTicks

_KINDS = ("hold", "move_free", "touch", "press", "slide", "turn", "comply", "feed", "back_out")
"""Rows of the band, from above."""


def stream_picture(ticks: ReadTicks, contacts: Sequence[dict[str, Any]] = ()) -> str:
    """Band of motions with the classified contacts, depth, commanded speed, and ages. SVG.

    ``ticks`` of a file that has them all; ``contacts`` as the record of the search has them.
    """
    time_s, values = ticks.values["time_s"], ticks.values
    with style():
        figure = Figure(figsize=(7.2, 6.0), layout="constrained")
        band, depth, speed, ages = figure.subplots(
            4, 1, sharex=True, height_ratios=(1.9, 1.2, 1, 1)
        )
        _draw_band(band, time_s, ticks.kinds)
        _draw_contacts(band, values, contacts)
        depth.plot(*envelope(time_s, values["depth_mm"]), color=ACCENT, linewidth=0.9)
        depth.invert_yaxis()
        depth.set_ylabel("depth, mm")
        _draw_speed(speed, time_s, values["speed_mm_s"], values["at_bound"])
        ages.plot(*envelope(time_s, values["age_ms"]), color=ACCENT, linewidth=0.8, label="tick")
        ages.plot(
            *envelope(time_s, values["force_age_ms"]), **line(SECOND), linewidth=0.8, label="force"
        )
        ages.set_ylabel("age, ms")
        ages.legend(loc="upper right", ncols=2)
        ages.set_xlabel("time since the stream began, s")
        return to_svg(figure)


def _draw_band(axes: Axes, time_s: Array, kinds: Sequence[str]) -> None:
    """A bar for each motion, in the row of its kind."""
    shown = [kind for kind in _KINDS if kind in kinds]
    for row, kind in enumerate(shown):
        bars = [
            (begin, end - begin) for name, begin, end in _stretches(time_s, kinds) if name == kind
        ]
        axes.broken_barh(bars, (row - 0.35, 0.7), facecolor=MUTED)
    axes.set_yticks(range(len(shown)), [kind.replace("_", " ") for kind in shown])
    axes.set_ylim(len(shown) - 0.4, -1.6)
    axes.grid(visible=False, axis="y")


def _stretches(time_s: Array, kinds: Sequence[str]) -> Iterator[tuple[str, float, float]]:
    """Kind, begin and end of ticks in a row of one kind; each ends where the next begins."""
    first = 0
    for kind, some in groupby(kinds):
        after = first + len(list(some))
        yield kind, float(time_s[first]), float(time_s[min(after, len(time_s) - 1)])
        first = after


def _draw_contacts(
    axes: Axes, values: dict[str, Array] | Any, contacts: Sequence[dict[str, Any]]
) -> None:
    """Classes over the band. A contact is one of the ticks, found by where the tip was: its time is
    that of another clock."""
    at_mm = np.stack([values[name] for name in ("x_mm", "y_mm", "depth_mm")], axis=1)
    for number, contact in enumerate(contacts):
        place_mm = np.array([contact[name] for name in ("x_mm", "y_mm", "depth_mm")])
        tick = int(np.argmin(np.linalg.norm(at_mm - place_mm, axis=1)))
        time_s = float(values["time_s"][tick])
        axes.axvline(time_s, color=INK, linewidth=0.6, linestyle=":")
        # Two heights, because the last two classes of a search often follow each other at once.
        axes.text(time_s, -1.1 + 0.6 * (number % 2), f" {contact['class']}", fontsize=7, color=INK)


def _draw_speed(axes: Axes, time_s: Array, speed_mm_s: Array, at_bound: Array) -> None:
    axes.plot(*envelope(time_s, speed_mm_s), color=ACCENT, linewidth=0.8, label="commanded")
    held = at_bound > 0
    if held.any():
        axes.plot(
            time_s[held],
            speed_mm_s[held],
            "x",
            markersize=4,
            color=LIMIT,
            label="an axis at its bound",
        )
    axes.set_ylabel("speed, mm/s")
    axes.legend(loc="upper right", ncols=2)
