"""What every calibration with a board draws: residuals over the image, the board as found."""

from typing import TYPE_CHECKING

import numpy as np

from cellctl.calibration.boards.board import CalibrationBoard
from cellctl.geometry.pose import MM, Array
from cellctl.plot_style import ACCENT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MAX_ARROWS = 2500
_ARROW_SCALE = 400.0
"""Image pixels per pixel of residual."""


def draw_residuals(axes: "Axes", field: Array, image_size: tuple[int, int], title: str) -> None:
    """Arrows of the residuals, columns u, v, du, dv in px, in an image of width and height."""
    # More arrows would cover each other, and a pattern of the residuals shows with fewer.
    chosen = field[:: max(1, len(field) // _MAX_ARROWS)]
    axes.quiver(
        chosen[:, 0],
        chosen[:, 1],
        chosen[:, 2] * _ARROW_SCALE,
        chosen[:, 3] * _ARROW_SCALE,
        angles="xy",
        scale_units="xy",
        scale=1.0,
        width=0.002,
        color=ACCENT,
    )
    width, height = image_size
    axes.set(title=f"{title}, x {_ARROW_SCALE:.0f}", aspect="equal")
    axes.set(xlim=(0, width), ylim=(height, 0), xlabel="px")


def draw_board(axes: "Axes", board: CalibrationBoard, board_m: Array) -> None:
    """Heights of the corners, shape (n, 3), over the board."""
    shape = (board.rows, board.columns)
    x, y, z = (board_m[:, axis].reshape(shape) / MM for axis in range(3))
    axes.grid(visible=False)
    shown = axes.contourf(x, y, z * 1000, levels=15, cmap="viridis")
    axes.figure.colorbar(shown, ax=axes, label="µm")
    flatness_um = float(np.ptp(z)) * 1000
    axes.set(title=f"board as found, flat to {flatness_um:.0f} µm", aspect="equal", xlabel="mm")
