"""The figures of a study as distributions, beside their limits."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from benchmarks.study.kinds import StudyKind
from benchmarks.study.outcome import StudyOutcome
from benchmarks.study.table import values_of
from cellctl.plot_style import ACCENT, LIMIT, MUTED, style

_COLUMNS = 3


@style()
def draw(kind: StudyKind, outcomes: Sequence[StudyOutcome], path: Path) -> None:
    """Write one panel a figure as a PNG file: the share of trials that are above a value.

    On a logarithmic share, because a study of thousands is about what happens seldom.
    """
    good = [one for one in outcomes if one.good]
    rows = -(-len(kind.figures) // _COLUMNS)
    figure = Figure(figsize=(12.0, 0.6 + 2.6 * rows), layout="constrained", dpi=120)
    panels = figure.subplots(rows, _COLUMNS, squeeze=False).ravel()
    for axes, shown in zip(panels, kind.figures, strict=False):
        values = np.sort(values_of(shown.key, good))
        axes.set_title(shown.title, fontsize=9)
        if not len(values):
            continue
        above = 1.0 - np.arange(len(values)) / len(values)
        axes.step(values, above, where="post", color=ACCENT)
        axes.axhline(1.0 / len(values), color=MUTED, linewidth=0.6)
        if shown.limit is not None:
            axes.axvline(shown.limit, color=LIMIT)
        axes.set_yscale("log")
    for axes in panels[len(kind.figures) :]:
        axes.set_visible(False)
    figure.supylabel("share of good trials at or above")
    figure.suptitle(f"{kind.about}: {len(good)} of {len(outcomes)} seeds good")
    figure.savefig(path)
