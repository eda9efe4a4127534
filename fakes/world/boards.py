"""Where the operator's hands put the boards."""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.scenario import HeadName, Scenario
from fakes.world.frames import MM, Array, displacement, from_written, stream

_PRINT_MARGIN = 1.1
"""For lens distortion and the growth of the near side of a tilted board."""


def target_board_pose(scenario: Scenario, seed: int, head: HeadName, number: int) -> RigidTransform:
    """cell_T_board of board P, roughly under a head, its x along the rows of the head's images."""
    board, rng = scenario.target_board, stream(seed, "target board", head, number)
    cell_T_frame = from_written(scenario.parts.frame_mm_deg)
    sees = scenario.heads[head].sees
    holes = [hole.position_mm for hole in scenario.parts.holes if hole.name in sees]
    middle = cell_T_frame.apply(np.append(np.mean(holes, axis=0), board.height_mm) * MM)
    measure = scenario.taught[scenario.heads[head].robot]["measure"]
    flange_x = from_written(measure).rotation.apply([1.0, 0.0, 0.0])
    turn = Rotation.from_euler("z", np.arctan2(flange_x[1], flange_x[0]))
    offset = rng.uniform(-1, 1, 3) * np.array(board.placement.xyz_mm) * MM
    tilt = rng.uniform(-1, 1, 3) * np.deg2rad(board.placement.rotation_deg)
    return RigidTransform.from_components(middle, turn) * displacement(offset, tilt)


def chessboard_view(scenario: Scenario, seed: int, head: HeadName, number: int) -> RigidTransform:
    """camera_T_board of one view: all of the print in both images, else spread at random.

    Over the depth of the stereo overlap, sideways as far as the images allow, tilted, and turned
    by a quarter where that fits.
    """
    board, rng = scenario.chessboard, stream(seed, "chessboard view", head, number)
    half_toe_in = np.deg2rad(scenario.cameras.toe_in_deg / 2)
    depth = rng.uniform(*board.distance_mm)
    quarter = rng.choice([False, True])
    room = _room_mm(scenario, depth, quarter=bool(quarter))
    if room.min() < 0:
        quarter, room = False, np.maximum(_room_mm(scenario, depth, quarter=False), 0.0)
    side = rng.uniform(-1, 1, 2) * room
    between = Rotation.from_euler("y", -half_toe_in)
    half_baseline = scenario.cameras.baseline_mm / 2
    middle = half_baseline * np.array([np.cos(half_toe_in), 0.0, np.sin(half_toe_in)])
    place = middle + between.apply([*side, depth])
    heading, tilt = rng.uniform(0, 2 * np.pi), np.deg2rad(board.tilt_deg) * np.sqrt(rng.random())
    lean = Rotation.from_rotvec(tilt * np.array([np.cos(heading), np.sin(heading), 0.0]))
    turn = Rotation.from_euler("z", quarter * np.pi / 2 + rng.uniform(-1, 1) * board.turn_rad)
    facing = between * Rotation.from_euler("x", np.pi)
    return RigidTransform.from_components(place * MM, facing * lean * turn)


def _room_mm(scenario: Scenario, depth_mm: float, *, quarter: bool) -> Array:
    """How far the board may go sideways before its print leaves one of the images."""
    cameras, board = scenario.cameras, scenario.chessboard
    width, height = cameras.image_px
    x, y = cameras.centre_px
    reach_px = np.array([min(x, width - x), min(y, height - y)])
    half_toe_in = np.deg2rad(cameras.toe_in_deg / 2)
    crossing_mm = cameras.baseline_mm / 2 / np.tan(half_toe_in)
    apart_mm = abs(depth_mm - crossing_mm) * np.tan(half_toe_in)
    half_print = (np.array(board.inner_corners) + 1) * board.square_mm / 2
    if quarter:
        half_print = half_print[::-1]
    view_mm = reach_px * depth_mm / cameras.focal_px - np.array([apart_mm, 0.0])
    return np.asarray(view_mm - _PRINT_MARGIN * half_print)
