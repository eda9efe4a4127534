"""The error of every component by pass of the loop against its threshold (paper, figure 11)."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from cellctl.plot_style import (
    ACCENT,
    BEYOND,
    GOOD,
    GOOD_FILL,
    LIMIT,
    MUTED,
    WITHIN,
    line,
    style,
    to_svg,
)
from cellctl.records.entries import LoopPass


def errors_by_pass(passes: Sequence[LoopPass]) -> str:
    """Six panels, linear within the threshold and logarithmic outside, bars of two sigma."""
    with style():
        figure = Figure(figsize=(7.2, 3.9), layout="constrained")
        axes = figure.subplots(2, 3, sharex=True)
        for index, panel in enumerate(axes.flat):
            _panel(panel, passes, index)
        for panel in axes[1]:
            panel.set_xlabel("iteration")
        return to_svg(figure)


def _panel(axes: Axes, passes: Sequence[LoopPass], index: int) -> None:
    points = [
        (entry.number, entry.components[index].value, entry.components[index].sigma or 0.0)
        for entry in passes
        if entry.components[index].value is not None
    ]
    last = passes[-1].components[index]
    threshold = last.limit or 1.0
    axes.set_title(f"{last.name}, {last.unit}")
    axes.axhspan(-threshold, threshold, color=GOOD_FILL, linewidth=0, zorder=0)
    for edge in (-threshold, threshold):
        axes.axhline(edge, **line(GOOD), linewidth=0.8)
    axes.axhline(0, color=MUTED, linewidth=0.5)
    axes.set_yscale("symlog", linthresh=threshold, linscale=1.0)
    extent = max([threshold * 2.0, *(abs(error or 0.0) * 1.8 for _, error, _ in points)])
    axes.set_ylim(-extent, extent)
    ticks = _ticks(threshold, extent)
    axes.set_yticks(ticks, [f"{tick:g}".replace("-", "−") for tick in ticks])
    axes.yaxis.set_minor_locator(MaxNLocator(1))
    axes.tick_params(axis="y", which="minor", length=0)
    numbers = [point[0] for point in points]
    errors = [point[1] or 0.0 for point in points]
    bars = [2 * point[2] for point in points]
    axes.errorbar(numbers, errors, yerr=bars, color=ACCENT, linewidth=1.2, capsize=2, elinewidth=1)
    for number, error in zip(numbers, errors, strict=True):
        within = abs(error) <= threshold
        colour, marker = (ACCENT, WITHIN) if within else (LIMIT, BEYOND)
        axes.plot(number, error, marker, markersize=4, color=colour, zorder=3)
    axes.set_xlim(0.6, max([*numbers, 2]) + 0.4)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    if points:
        axes.set_title(
            f"{errors[-1]:+.4f}".replace("-", "−"), loc="right", color=MUTED, fontweight="normal"
        )


def _ticks(threshold: float, extent: float) -> list[float]:
    ticks = [threshold]
    while ticks[-1] * 10 < extent:
        ticks.append(ticks[-1] * 10)
    return [*(-tick for tick in reversed(ticks)), 0.0, *ticks]
