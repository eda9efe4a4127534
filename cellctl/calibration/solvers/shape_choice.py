"""How much freedom the shape of the board gets, decided by views that the calibration has not seen.

A printed board is bent, and its corners are not where the drawing has them either: paper stretches,
a printer feeds unevenly. Releasing every corner costs the figures nothing when there are many
views, but seconds of computing, and with few views it fits their noise. So both are solved, and the
print is released when views that were held out are measured better by it.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from cellctl.calibration.boards.board_shape import BoardShape
from cellctl.calibration.solvers.single_camera.single_camera_result import SingleCameraResult
from cellctl.calibration.solvers.stereo.stereo_result import StereoResult

WORTH = 0.95
"""Held-out error with the print released, over that without, from which on it is released. The
noise of corners that were averaged over eight views and more changes the ratio by less."""

R = TypeVar("R", StereoResult, SingleCameraResult)


def with_chosen_shape(
    calibrate: Callable[[BoardShape], R], held_out: Callable[[R], float | None]
) -> R:
    """The calibration with the shape that the data ask for; its ``method`` says why.

    ``held_out`` gives the error of a result for views that it has not seen, None when there were
    too few to hold any back.
    """
    bent = calibrate(BoardShape.BENT)
    without = held_out(bent)
    if without is None:
        return replace(bent, method=f"{bent.method} (too few views to try another)")
    printed = calibrate(BoardShape.PRINTED)
    released = held_out(printed)
    ratio = float("inf") if released is None else released / without
    chosen = printed if ratio <= WORTH else bent
    said = f"held-out error with every corner released is {ratio:.3f} of that without"
    return replace(chosen, method=f"{chosen.method} ({said})")
