"""Settings of the process for all of its recipes: ``[processes.deck-to-frame]``."""

from typing import Annotated

from pydantic import Field

from cellctl.config.base import JointsDeg, Section, WrittenPose


class DeckSettings(Section):
    """Settings of the calibration procedures."""

    board: Annotated[str, Field(pattern=r"^\d+x\d+$", examples=["9x6"])] = "9x6"
    """Inner corners of the calibration chessboard, columns x rows."""
    square_mm: Annotated[float, Field(gt=0, le=100)] = 25.0
    """Side of a square of the board, as it was measured."""
    stereo_views: Annotated[int, Field(ge=8, le=100)] = 24
    """Views of the board in procedures 101 and 102 (docs/calibration.md)."""
    base_frame_joints_deg: JointsDeg
    """Main robot, middle of both arcs: station empty, targets seen by the large-field head."""
    flange_T_target_board: WrittenPose
    """Where the target board lies under a head, roughly. Elsewhere it is found as well, as long as
    all of it is in view; it looks the same after half a turn, which this pose decides."""
    circle_stops: Annotated[int, Field(ge=5, le=60)] = 15
    """Stops on each arc of procedure 103."""
    circle_arc_deg: Annotated[float, Field(ge=20, le=180)] = 100.0
    """Length of each arc: on a short one the axis of a circle is known badly."""
    tracker_frames: Annotated[int, Field(ge=1, le=200)] = 20
    """Exposures of the large-field head that are averaged at each stop."""
    payload_poses: Annotated[int, Field(ge=8, le=60)] = 17
    """Poses of procedure 106: twelve for the fit, four to test it, and the first one again
    (``cellctl.force.gravity.poses``)."""
    payload_cone_deg: Annotated[float, Field(ge=3, le=30)] = 12.0
    """Half angle of the cone in which they lie."""
    validity_days: Annotated[int, Field(ge=1, le=3650)] = 180
    """How long a calibration counts that passes: the customer's rule, and none of physics."""
