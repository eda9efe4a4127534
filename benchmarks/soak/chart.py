"""What each process kept over the time, with its trend."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from benchmarks.soak.trend import Looked, Trend, Verdict, judged_from
from cellctl.plot_style import ACCENT, LIMIT, MUTED, SECOND, style

TITLES = {"memory_kb": "memory MB", "descriptors": "handles", "threads": "threads"}
_COLOURS = {Verdict.FLAT: ACCENT, Verdict.UNDECIDED: SECOND, Verdict.GROWS: LIMIT}


@style()
def draw(looked: Sequence[Looked], found: Sequence[Trend], path: Path) -> None:
    """Write one row a process and one column a quantity as a PNG file."""
    by_name = {(trend.process, trend.quantity): trend for trend in found}
    size = 12.0, 0.8 + 1.6 * len(looked)
    figure = Figure(figsize=size, layout="constrained", dpi=120)
    panels = figure.subplots(len(looked), len(TITLES), sharex=True, squeeze=False)
    for row, one in zip(panels, looked, strict=True):
        minutes = np.array(one.time_s) / 60.0
        begin = judged_from(len(minutes))
        for axes, (quantity, title) in zip(row, TITLES.items(), strict=True):
            scale = 1e-3 if quantity == "memory_kb" else 1.0
            values = scale * np.array([getattr(kept, quantity) for kept in one.kept], dtype=float)
            axes.plot(minutes[:begin], values[:begin], ".", color=MUTED, markersize=4)
            axes.plot(minutes[begin:], values[begin:], ".", color=ACCENT, markersize=4)
            trend = by_name[one.process, quantity]
            # The line goes through the middle of the points, as that of Theil and Sen does.
            middle = np.median(minutes[begin:]), np.median(values[begin:])
            line = middle[1] + scale * trend.slope * (minutes[begin:] - middle[0]) / 60.0
            axes.plot(minutes[begin:], line, color=_COLOURS[trend.verdict])
            interval = f"{scale * trend.low:+.2g} … {scale * trend.high:+.2g} an hour"
            axes.set_title(f"{one.process}: {title}, {interval}", fontsize=8)
            axes.set_ylim(0.0, 1.25 * max(values.max(), 1e-9))
    figure.supxlabel("minutes; grey: warm-up, not judged")
    figure.savefig(path)
