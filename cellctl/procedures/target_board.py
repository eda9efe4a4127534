"""The target board before one stereo head and the large-field head (paper fig. 3, eq. 1, 2)."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
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
from cellctl.interfaces import Target, TargetTracker
from cellctl.interfaces.stereo_camera import Image
from cellctl.procedures.input_forms import targets_from_input, targets_to_input
from cellctl.runtime.procedure import ProcedureContext, views_of_pair
from cellctl.vision.camera.stereo_head import (
    StereoHead,
    stereo_head_from_json,
    stereo_head_to_json,
)
from cellctl.vision.features.hole import Hole
from cellctl.vision.holes.search import HeadImages
from cellctl.vision.holes.turned import pose_turned_like
from cellctl.vision.measure import measure_pair
from cellctl.vision.measurement import PairMeasurement
from cellctl.vision.registration.average import average
from cellctl.workers import VisionWorkers

DISC_DIAMETER_M = 20 * MM
PAIRS = 4
"""Pairs of images whose measurements are averaged."""
SEARCH_RADIUS_M = 35 * MM
"""Less than half the pitch of the discs."""


@dataclass(frozen=True, slots=True, eq=False)
class BoardLook:
    """What a placement is computed from; plain data, but for the model of the head."""

    model: StereoHead
    head_T_board: RigidTransform
    """Roughly where the board lies."""
    pairs: list[list[str]]
    """Files of the images, left and right."""
    targets: tuple[Target, ...]
    """All that the large-field head has seen."""

    def to_input(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "head": stereo_head_to_json(self.model),
            "head_T_board_predicted": self.head_T_board.as_matrix().tolist(),
            "pairs": self.pairs,
            "targets": targets_to_input(self.targets),
        }

    @classmethod
    def from_input(cls, written: Mapping[str, Any]) -> "BoardLook":
        """The inverse of ``to_input``."""
        return cls(
            stereo_head_from_json(written["head"]),
            RigidTransform.from_matrix(np.array(written["head_T_board_predicted"], float)),
            [list(pair) for pair in written["pairs"]],
            targets_from_input(written["targets"]),
        )


async def place_board(
    context: ProcedureContext,
    station: StereoStation,
    model: StereoHead,
    tracker: TargetTracker,
    workers: VisionWorkers,
    *,
    flange_T_board: RigidTransform,
    tracker_frames: int,
) -> tuple[BoardPlacement, BoardLook]:
    """The board as head and large-field head see it, both at once, and what it is computed from.

    ``flange_T_board`` is roughly where the board lies under the head's robot. A board that does not
    lie there is looked for in the whole images; then it only tells which way round the board lies,
    for that looks the same after half a turn. Raises the faults of vision, and what the devices
    raise.
    """
    head_T_board = station.flange_T_head.inv() * flange_T_board
    # At once: a board that moved between the two measurements would show as a pose between the
    # heads.
    seen: list[Any] = await gather_or_cancel(
        _in_head(context, station, model, workers, head_T_board),
        tracker.measure(tracker_frames),
    )
    (in_head, files), targets = seen
    look = BoardLook(model, head_T_board, files, targets)
    return BoardPlacement(board_in_large_field(targets), in_head), look


async def _in_head(
    context: ProcedureContext,
    station: StereoStation,
    model: StereoHead,
    workers: VisionWorkers,
    head_T_board: RigidTransform,
) -> tuple[BoardPose, list[list[str]]]:
    """The board, and the files of the images."""
    found: list[PairMeasurement] = []
    files: list[list[str]] = []
    for number in range(1, PAIRS + 1):
        pair = await station.camera.grab()
        views = views_of_pair(station.name, pair)
        files.append(await context.keep_images(f"board-{number}", views))
        images = HeadImages(model, pair.left, pair.right)
        measured, head_T_board = await workers.run(
            measured_board, images, head_T_board, may_lie_elsewhere=not found
        )
        found.append(measured)
    return board_in_head(found), files


def placed_again(look: BoardLook, image: Callable[[str], Image]) -> BoardPlacement:
    """The placement from its recorded look, as ``place_board``; ``image`` reads one by its file.

    Raises the faults of vision and ``BoardPoseInvalid``.
    """
    head_T_board = look.head_T_board
    found: list[PairMeasurement] = []
    for left, right in look.pairs:
        images = HeadImages(look.model, image(left), image(right))
        measured, head_T_board = measured_board(images, head_T_board, may_lie_elsewhere=not found)
        found.append(measured)
    return BoardPlacement(board_in_large_field(look.targets), board_in_head(found))


def measured_board(
    images: HeadImages, head_T_board: RigidTransform, *, may_lie_elsewhere: bool
) -> tuple[PairMeasurement, RigidTransform]:
    """The discs of the board in one pair of images, and roughly where the board lies.

    It is looked for at ``head_T_board`` and, if it ``may_lie_elsewhere``, in the whole images: that
    holds for the first pair alone, because where one pair shows the board it lies for all of them.
    Raises the faults of vision.
    """
    discs = board_discs()
    # The board has nine equal discs and looks the same after half a turn; only a predicted pose
    # tells which disc is which.
    search = partial(
        measure_pair, images.left, images.right, images.head, discs, search_radius_m=SEARCH_RADIUS_M
    )
    try:
        return search(camera_T_part=head_T_board), head_T_board
    except HoleMissing:
        if not may_lie_elsewhere:
            raise
    head_T_board = pose_turned_like(images, discs, head_T_board)
    return search(camera_T_part=head_T_board), head_T_board


def board_discs() -> list[Hole]:
    """The discs of the board as vision looks for them."""
    drawing = target_board_discs()
    return [Hole(name, "disc", DISC_DIAMETER_M, place) for name, place in drawing.items()]


def board_in_head(found: Sequence[PairMeasurement]) -> BoardPose:
    """The board from what a head has measured, several times; raises ``BoardPoseInvalid``."""
    points = [
        BoardPoint(hole.name, hole.position_m, hole.covariance_m2) for hole in average(found).holes
    ]
    return fit_board(target_board_discs(), points)


def board_in_large_field(targets: Iterable[Target]) -> BoardPose:
    """The board from what the large-field head has seen; raises ``BoardPoseInvalid``."""
    drawing = target_board_discs()
    return fit_board(drawing, points_from_targets(targets, drawing))
