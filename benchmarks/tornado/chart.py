"""The tornado: what each imperfection costs at each size, as bars beside the limits."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.tornado.costs import FIGURES, Cost
from benchmarks.tornado.outcome import Verdict
from cellctl.plot_style import ACCENT, GRID, LIMIT, MUTED, SECOND, style

_SHADES = (1.0, 0.6, 0.3)
"""Shades of the bars, from the smallest size to the largest."""


@style()
def draw(found: Sequence[Cost], path: Path) -> None:
    """Write the chart of at least one cost as a PNG file."""
    names = list(dict.fromkeys(cost.imperfection for cost in found))
    scales = sorted({cost.scale for cost in found})
    figure = Figure(figsize=(11.0, 1.4 + 0.42 * len(names)), layout="constrained", dpi=120)
    columns = figure.subplots(1, len(FIGURES), sharey=True, squeeze=False)[0]
    for axes, (key, title, limit) in zip(columns, FIGURES, strict=True):
        for cost in found:
            _bar(axes, cost, key, names.index(cost.imperfection), scales)
        axes.axvline(limit, color=LIMIT, linewidth=1.0)
        axes.axvline(0.0, color=MUTED, linewidth=0.8)
        axes.set_title(f"{title} more (limit {limit:g})")
    columns[0].set_yticks(range(len(names)), names)
    columns[0].invert_yaxis()
    written = ", ".join(f"{scale:g}" for scale in scales)
    figure.supxlabel(
        f"bars from dark to light: {written} times the realistic size, worst seed; "
        "orange: the cell did not call the part good; red cross: called good and is not"
    )
    figure.savefig(path)


def _bar(axes: Axes, cost: Cost, key: str, row: int, scales: Sequence[float]) -> None:
    place = scales.index(cost.scale)
    height = 0.8 / len(scales)
    y = row - 0.4 + height * (place + 0.5)
    value = cost.more[key]
    noticed = cost.count(Verdict.NOTICED) > 0
    shade = _SHADES[min(place, len(_SHADES) - 1)]
    if value is not None:
        axes.barh(y, value, height, color=SECOND if noticed else ACCENT, alpha=shade)
    elif noticed:
        axes.plot([0.0], [y], marker="s", color=SECOND, markeredgecolor=GRID, clip_on=False)
    if cost.count(Verdict.NOT_NOTICED):
        axes.plot([value or 0.0], [y], marker="x", color=LIMIT, markersize=8, markeredgewidth=2)
