"""The target board before one stereo head and the large-field head (paper fig. 3, eq. 1, 2)."""

from collections.abc import Sequence

from scipy.spatial.transform import RigidTransform

from cellctl.calibration.boards.board_pose import (
    BoardPoint,
    BoardPose,
    fit_board,
    points_from_targets,
    target_board_discs,
)
from cellctl.calibration.solvers.transfer.board_transfer import BoardPlacement
from cellctl.cell.gather import gather_or_cancel
from cellctl.cell.stereo_station import StereoStation
from cellctl.errors.vision import HoleMissing
from cellctl.geometry.pose import MM
from cellctl.interfaces import StereoPair, TargetTracker
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.features.hole import Hole
from cellctl.vision.holes.search import HeadImages
from cellctl.vision.holes.turned import pose_turned_like
from cellctl.vision.measure import measure_pair
from cellctl.vision.measurement import PairMeasurement
from cellctl.vision.registration.average import average
from cellctl.workers import VisionWorkers

DISC_DIAMETER_M = 20 * MM
PAIRS = 4
SEARCH_RADIUS_M = 35 * MM
"""Less than half the pitch of the discs."""


async def place_board(
    station: StereoStation,
    model: StereoHead,
    tracker: TargetTracker,
    workers: VisionWorkers,
    *,
    flange_T_board: RigidTransform,
    tracker_frames: int,
) -> BoardPlacement:
    """The board as head and large-field head see it, both at once.

    ``flange_T_board`` is roughly where the board lies under the head's robot. A board that does not
    lie there is looked for in the whole images; then it only tells which way round the board lies,
    for that looks the same after half a turn. Raises the faults of vision, and what the devices
    raise.
    """
    head_T_board = station.flange_T_head.inv() * flange_T_board
    # At once: a board that moved between the two measurements would show as a pose between the
    # heads.
    in_head, in_large_field = await gather_or_cancel(
        _in_head(station, model, workers, head_T_board), _in_large_field(tracker, tracker_frames)
    )
    return BoardPlacement(in_large_field, in_head)


async def _in_head(
    station: StereoStation, model: StereoHead, workers: VisionWorkers, head_T_board: RigidTransform
) -> BoardPose:
    drawing = target_board_discs()
    discs = [Hole(name, "disc", DISC_DIAMETER_M, place) for name, place in drawing.items()]
    found: list[PairMeasurement] = []
    for _ in range(PAIRS):
        pair = await station.camera.grab()
        try:
            measured = await _measured(workers, pair, model, discs, head_T_board)
        except HoleMissing:
            # Where one picture shows the board it lies for all of them.
            if found:
                raise
            images = HeadImages(model, pair.left, pair.right)
            head_T_board = await workers.run(pose_turned_like, images, discs, head_T_board)
            measured = await _measured(workers, pair, model, discs, head_T_board)
        found.append(measured)
    points = [
        BoardPoint(hole.name, hole.position_m, hole.covariance_m2) for hole in average(found).holes
    ]
    return fit_board(drawing, points)


async def _measured(
    workers: VisionWorkers,
    pair: StereoPair,
    model: StereoHead,
    discs: Sequence[Hole],
    head_T_board: RigidTransform,
) -> PairMeasurement:
    return await workers.run(
        measure_pair,
        pair.left,
        pair.right,
        model,
        discs,
        # The board has nine equal discs and looks the same after half a turn; only a predicted
        # pose tells which disc is which.
        camera_T_part=head_T_board,
        search_radius_m=SEARCH_RADIUS_M,
    )


async def _in_large_field(tracker: TargetTracker, frames: int) -> BoardPose:
    drawing = target_board_discs()
    seen = await tracker.measure(frames)
    return fit_board(drawing, points_from_targets(seen, drawing))
