"""What the pictures of all calibrations share: PNG in the look of ``cellctl.plot_style``."""

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING

from cellctl.calibration.checks import LimitCheck
from cellctl.plot_style import ACCENT, GOOD, LIMIT, SECOND

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TEXT_SIZE = 9


def new_figure(width: float = 12.0, height: float = 8.0) -> "Figure":
    """A figure that needs no display and leaves no global state."""
    from matplotlib.figure import Figure

    # Not ``pyplot``: it keeps every figure until it is closed, and the workers live as long as the
    # daemon.
    return Figure(figsize=(width, height), layout="constrained")


def title(figure: "Figure", text: str, *, passed: bool) -> None:
    """Heading with the verdict."""
    verdict = "passed" if passed else "NOT PASSED"
    figure.suptitle(f"{text}: {verdict}", color=GOOD if passed else LIMIT)


def list_checks(axes: "Axes", checks: Sequence[LimitCheck], warnings: Sequence[str]) -> None:
    """The figures against their limits and the warnings, as text."""
    axes.axis("off")
    step = 0.95 / max(len(checks) + len(warnings), 8)
    for line, check in enumerate(checks):
        color = GOOD if check.passed else LIMIT
        axes.text(0.0, 0.98 - line * step, str(check), color=color, va="top", fontsize=TEXT_SIZE)
    for line, warning in enumerate(warnings, start=len(checks)):
        text = f"! {warning}"
        height = 0.98 - line * step
        axes.text(0.0, height, text, color=SECOND, va="top", fontsize=TEXT_SIZE, wrap=True)


def bars(axes: "Axes", names: Sequence[str], values: Sequence[float], unit: str) -> None:
    """One bar per name, labelled below; beyond 40 bars the names would not be legible."""
    axes.bar(range(len(values)), values, color=ACCENT)
    axes.set_ylabel(unit)
    axes.grid(visible=False, axis="x")
    if len(names) <= 40:
        axes.set_xticks(range(len(names)), names, rotation=90, fontsize=7)


def as_png(figure: "Figure") -> bytes:
    """The picture as a file's content."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=110)
    return buffer.getvalue()
