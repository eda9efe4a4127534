"""Settings of the process for all of its recipes: ``[processes.deck-to-frame]``."""

from typing import Annotated

from pydantic import Field

from cellctl.config.base import JointsDeg, Section, WrittenPose


class DeckSettings(Section):
    """Settings of the calibration procedures."""

    board: Annotated[str, Field(pattern=r"^\d+x\d+$", examples=["9x6"])] = "9x6"
    """Inner corners of the calibration chessboard, columns x rows."""
    square_mm: Annotated[float, Field(gt=0, le=100)] = 25.0
    stereo_views: Annotated[int, Field(ge=8, le=100)] = 24
    base_frame_joints_deg: JointsDeg
    """Main robot, middle of both arcs: station empty, targets seen by the large-field head."""
    flange_T_target_board: WrittenPose
    """Where the target board lies under a head, roughly: it looks the same upside down."""
    circle_stops: Annotated[int, Field(ge=5, le=60)] = 15
    circle_arc_deg: Annotated[float, Field(ge=20, le=180)] = 100.0
    tracker_frames: Annotated[int, Field(ge=1, le=200)] = 20
    payload_poses: Annotated[int, Field(ge=8, le=60)] = 17
    payload_cone_deg: Annotated[float, Field(ge=3, le=30)] = 12.0
    validity_days: Annotated[int, Field(ge=1, le=3650)] = 180
