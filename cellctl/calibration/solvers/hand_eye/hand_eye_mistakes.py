"""Which mistake explains poses of robot and camera that do not fit each other.

A closed form always yields something. When the board does not stay in its place, the same poses are
tried as they would be without the usual mistakes; the one with which they fit is named. Nothing is
mended by itself: the user's file is wrong, and other figures in it may be, too.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.checks import LimitCheck
from cellctl.calibration.solvers.hand_eye.hand_eye_result import HandEyePose, Setup
from cellctl.calibration.solvers.hand_eye.hand_eye_start import closed_form
from cellctl.calibration.unit_slips import meant_in_radians
from cellctl.errors.calibration import PosesNotDiverse, RobotCameraMismatch
from cellctl.geometry.pose import MM, pose_error

_FITS = 0.01
"""Scatter of the board's place, as a share of its distance, below which it belongs to these poses,
whatever the arm's accuracy."""
_SCALE = 0.01
"""Lengths that differ by less are not worth a word."""
_BETTER = 10.0
"""A correction is told when the poses fit so many times better with it than as given."""
_TURNED_RAD = np.radians(2)
"""A pose fits within this once its board is turned by 180°: far more than robot and camera scatter,
and far less than any other error of a whole pose leaves."""

Change = Callable[[RigidTransform], RigidTransform]


@dataclass(frozen=True, slots=True)
class _Mistake:
    words: str
    flange: Change = lambda pose: pose
    board: Change = lambda pose: pose
    other_setup: bool = False


def _scaled(factor: float) -> Change:
    return lambda pose: RigidTransform.from_components(pose.translation * factor, pose.rotation)


_MISTAKES = (
    _Mistake(
        "the data fit {other}, or the poses of the robot are inverted (flange_T_base)",
        other_setup=True,
    ),
    _Mistake("the poses of the board are inverted (board_T_camera)", board=lambda p: p.inv()),
    _Mistake("the robot's lengths are in metres", flange=_scaled(1e3)),
    _Mistake("the board's lengths are in metres", board=_scaled(1e3)),
    _Mistake("the robot's angles are in radians", flange=meant_in_radians),
    _Mistake("the board's angles are in radians", board=meant_in_radians),
)


def explanation(poses: Sequence[HandEyePose], setup: Setup) -> str | None:
    """The mistake without which the poses fit; None when no single one explains them."""
    given_m = _spread_m(poses, setup)
    found = []
    for mistake in _MISTAKES:
        changed = _without(mistake, poses, setup)
        limit_m = min(_FITS * board_distance_m(changed[0]), given_m / _BETTER)
        spread_m = _spread_m(*changed)
        if spread_m <= limit_m:
            found.append((spread_m, mistake))
    if not found:
        return None
    best = min(found, key=lambda one: one[0])[1]
    return best.words.format(other=setup.other.value)


def board_distance_m(poses: Sequence[HandEyePose]) -> float:
    """Median distance of the board from the camera."""
    return float(
        np.median([np.linalg.norm(pose.camera_T_board.pose.translation) for pose in poses])
    )


def another_size(scale: float, sigma: float) -> list[str]:
    """Words that say that the board has another size than it was given, if the robot's motions say
    so.

    ``scale`` is the robot's lengths over the board's, ``sigma`` its standard deviation.
    """
    if abs(scale - 1.0) < max(_SCALE, 4.0 * sigma):
        return []
    return [
        f"the board is {scale:.3f} times as large as it was said to be, by the robot's motions: "
        f"check its squares and the camera's focal length"
    ]


def all_inverted(setup: Setup, mounting: LimitCheck) -> list[str]:
    """Words for a mounting that is too far from the flange: the poses, or indeed the mounting."""
    if mounting.passed:
        return []
    on_flange, standing = "camera", "board"
    if setup is Setup.EYE_TO_HAND:
        on_flange, standing = standing, on_flange
    near_mm, far_mm = f"{mounting.limit:.0f} mm", f"{mounting.value:.0f} mm"
    return [
        f"the {on_flange} would be {far_mm} from the flange, farther than the {standing} from the "
        f"base. Are all poses inverted (flange_T_base and board_T_camera)? Then the {on_flange} is "
        f"{near_mm} from the flange and the {standing} {far_mm} from the base, and the poses fit "
        "as well. Write base_T_flange and camera_T_board; if they are, measure the mounting: then "
        f"the {standing} has to stand farther from the base"
    ]


def odd_poses(
    poses: Sequence[HandEyePose],
    rejected: Sequence[str],
    predicted: Callable[[HandEyePose], RigidTransform],
) -> list[str]:
    """What may be wrong with poses that were left out.

    ``predicted`` is camera_T_board as the calibration expects it.
    """
    out = [pose for pose in poses if pose.name in rejected]
    fits_m = _FITS * board_distance_m(poses)
    said = []
    for one, other in combinations(out, 2):
        exchanged = (
            replace(one, camera_T_board=other.camera_T_board),
            replace(other, camera_T_board=one.camera_T_board),
        )
        if all(_off(pose, predicted)[0] < fits_m for pose in exchanged):
            said.append(f"{one.name} and {other.name} fit with their pictures exchanged")
    turned = RigidTransform.from_rotation(Rotation.from_euler("z", 180, degrees=True))
    for pose in out:
        seen = replace(pose.camera_T_board, pose=pose.camera_T_board.pose * turned)
        if _off(replace(pose, camera_T_board=seen), predicted)[1] < _TURNED_RAD:
            said.append(f"in {pose.name} the board was taken for turned by 180°")
    return said


def _off(
    pose: HandEyePose, predicted: Callable[[HandEyePose], RigidTransform]
) -> tuple[float, float]:
    shift, turn = pose_error(predicted(pose), pose.camera_T_board.pose)
    return float(np.linalg.norm(shift)), float(np.linalg.norm(turn))


def _without(
    mistake: _Mistake, poses: Sequence[HandEyePose], setup: Setup
) -> tuple[list[HandEyePose], Setup]:
    changed = [
        replace(
            pose,
            base_T_flange=mistake.flange(pose.base_T_flange),
            camera_T_board=replace(
                pose.camera_T_board, pose=mistake.board(pose.camera_T_board.pose)
            ),
        )
        for pose in poses
    ]
    return changed, setup.other if mistake.other_setup else setup


def _spread_m(poses: Sequence[HandEyePose], setup: Setup) -> float:
    """Median distance of the board from its place; infinite where there is no solution."""
    seen = [pose.camera_T_board.pose for pose in poses]
    # A board nearer than this no camera sees whole: lengths of both in metres fit each other.
    if np.median([np.linalg.norm(pose.translation) for pose in seen]) < 5 * MM:
        return float("inf")
    turns = [setup.turn(pose.base_T_flange) for pose in poses]
    try:
        x, z, _ = closed_form(turns, seen)
    except (RobotCameraMismatch, PosesNotDiverse):
        return float("inf")
    places = [(turn * x * pose).translation for turn, pose in zip(turns, seen, strict=True)]
    return float(np.median(np.linalg.norm(np.array(places) - z.translation, axis=1)))
