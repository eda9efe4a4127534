"""One look for all figures: ink, one accent, limits in red, targets in green.

Reports are printed in grey too: each colour has a line of its own (``DASHES``), and points that
mean something else have another marker.

Reports take SVG, calibrations PNG; both are drawn inside ``style()``, which also serves as a
decorator of the function that draws.

matplotlib is loaded by whoever draws, and by importing a drawing it is not: the daemon knows every
picture and has its workers draw them, and would start a quarter later for it.
"""

import io
import itertools
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from cycler import cycler
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

INK, MUTED, GRID = "#1c2733", "#6b7785", "#dfe4ea"
ACCENT, SECOND, THIRD = "#1f5fa8", "#c77d0a", "#7a8795"
GOOD, GOOD_FILL, LIMIT = "#2b8a57", "#e3f3ea", "#c0342b"

Dashes = str | tuple[float, tuple[float, ...]]
DASHES: Mapping[str, Dashes] = {
    ACCENT: "-",
    SECOND: (0.0, (2.5, 1.0)),
    GOOD: (0.0, (5.0, 3.0)),
    THIRD: (0.0, (1.0, 1.5)),
    LIMIT: (0.0, (9.0, 2.0, 1.5, 2.0)),
    INK: (0.0, (5.0, 1.5, 1.0, 1.5, 1.0, 1.5)),
}
"""Line style by colour."""
WITHIN, BEYOND = "o", "X"
"""Markers of points that are within their limit, and of those that are not."""

_SETTINGS: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelcolor": MUTED,
    "axes.edgecolor": GRID,
    "axes.grid": True,
    "axes.prop_cycle": cycler(color=list(DASHES)) + cycler(linestyle=list(DASHES.values())),
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "text.color": INK,
    # Names of holes, views and devices are anybody's text: a pair of `$` in one is no formula.
    "text.parse_math": False,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "legend.frameon": False,
    # Names inside an SVG are random without it, and a report made twice would differ.
    "svg.hashsalt": "cellctl",
    # Letters as outlines: a report looks the same on a PC without the font.
    "svg.fonttype": "path",
}


@contextmanager
def style() -> Iterator[None]:
    """The look, for the figures made inside."""
    from matplotlib import rc_context

    with rc_context(_SETTINGS):
        yield


def to_svg(figure: "Figure") -> str:
    """The figure as an ``<svg>`` element; the same figure gives the same text."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    FigureCanvasSVG(figure)
    stream = io.StringIO()
    figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    svg = stream.getvalue()
    size = re.compile(r'width="[\d.]+pt" height="[\d.]+pt"')
    # Without the XML header, which is not allowed inside HTML, and as wide as the page.
    return size.sub('width="100%"', svg[svg.index("<svg") :], count=1)


def line(colour: str) -> dict[str, Any]:
    """Colour and line style of a line, for matplotlib."""
    return {"color": colour, "linestyle": DASHES[colour]}


def label_line(axes: "Axes", y: float, text: str, colour: str) -> None:
    """A horizontal line with its meaning written on it, at its left end."""
    axes.axhline(y, **line(colour), linewidth=1.0, zorder=1)
    axes.annotate(
        text,
        (0.0, y),
        xycoords=("axes fraction", "data"),
        xytext=(4, 2),
        textcoords="offset points",
        ha="left",
        va="bottom",
        color=colour,
        fontsize=7,
    )


def envelope(x: Array, y: Array, bins: int = 700) -> tuple[Array, Array]:
    """At most ``2 · bins`` points that keep every peak: least and greatest of each stretch."""
    if len(x) <= 2 * bins:
        return x, y
    edges = np.linspace(0, len(x), bins + 1).astype(int)
    kept = []
    for begin, end in itertools.pairwise(edges):
        pair = {begin + int(np.argmin(y[begin:end])), begin + int(np.argmax(y[begin:end]))}
        kept.extend(sorted(pair))
    return x[kept], y[kept]
