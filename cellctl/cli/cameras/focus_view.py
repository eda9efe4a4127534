"""What `cellctl focus` sees in one exposure."""

from dataclasses import dataclass

from cellctl.calibration.boards.board import CalibrationBoard
from cellctl.calibration.boards.corners.corner_detection import detect_corners
from cellctl.cli.cameras.opening import Exposed, View
from cellctl.vision.camera.setting_up import ImageFigures, image_figures, overlap_share
from cellctl.vision.holes.candidates import find_candidates, outermost

HolesWanted = tuple[float, float] | None
"""Least and greatest radius, px."""


@dataclass(frozen=True, slots=True)
class SideView:
    """One image."""

    side: str
    figures: ImageFigures
    exposure_s: float | None
    gain_db: float | None
    board_corners: int | None
    """Corners of the board that was asked for; 0 where it was not found, None without one."""
    holes: int | None
    """Dark round features of the size that was asked for, None without one."""


@dataclass(frozen=True, slots=True)
class FocusView:
    """One exposure."""

    frame_id: int
    took_s: float
    sides: tuple[SideView, ...]
    overlap_share: float | None
    """Share of the left view that the right camera of a head sees too; None where it is not
    seen."""


def looked_at(
    exposed: Exposed, took_s: float, board: CalibrationBoard | None, holes: HolesWanted
) -> FocusView:
    """All figures of an exposure. Raises nothing: an image that shows nothing has figures too."""
    sides = tuple(_side(view, board, holes) for view in exposed.views)
    greys = [view.grey for view in exposed.views]
    overlap = overlap_share(greys[0], greys[1]) if len(greys) == 2 else None
    return FocusView(exposed.frame_id, took_s, sides, overlap)


def _side(view: View, board: CalibrationBoard | None, holes: HolesWanted) -> SideView:
    grey = view.grey
    corners = None if board is None else detect_corners(grey, board)
    found = None if holes is None else len(outermost(find_candidates(grey, holes)))
    return SideView(
        side=view.side or "image",
        figures=image_figures(grey),
        exposure_s=view.exposure_s,
        gain_db=None if view.exposure is None else view.exposure.gain_db,
        board_corners=None if board is None else (0 if corners is None else len(corners.ids)),
        holes=found,
    )
