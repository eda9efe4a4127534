"""Where the operator's hands put the boards."""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.scenario import HeadName, Scenario
from fakes.world.frames import MM, displacement, from_written, stream

_EDGE_PX = 40.0
"""Room for lens distortion and for lenses that differ from the nominal one."""
_DRAWS = 1000


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
    """camera_T_board of one view: all of the print in both images, else spread at random."""
    rng = stream(seed, "chessboard view", head, number)
    for _ in range(_DRAWS):
        view = _random_view(scenario, rng)
        if _all_in_view(scenario, view):
            return view
    raise ValueError("the chessboard of the scenario fits no view of the heads")


def _random_view(scenario: Scenario, rng: np.random.Generator) -> RigidTransform:
    """Over the depth of the stereo overlap, sideways, tilted and turned a little."""
    board = scenario.chessboard
    side = rng.uniform(-1, 1, 2) * np.array(board.offset_mm)
    between = Rotation.from_euler("y", -_half_toe_in(scenario))
    across, depth = scenario.cameras.baseline_mm / 2, rng.uniform(*board.distance_mm)
    place = between.apply([across + side[0], side[1], depth])
    heading, tilt = rng.uniform(0, 2 * np.pi), np.deg2rad(board.tilt_deg) * np.sqrt(rng.random())
    lean = Rotation.from_rotvec(tilt * np.array([np.cos(heading), np.sin(heading), 0.0]))
    turn_rad = rng.uniform(-1, 1) * board.turn_rad
    facing = between * Rotation.from_euler("x", np.pi) * lean * Rotation.from_euler("z", turn_rad)
    return RigidTransform.from_components(place * MM, facing)


def _all_in_view(scenario: Scenario, camera_T_board: RigidTransform) -> bool:
    cameras, board = scenario.cameras, scenario.chessboard
    half_x, half_y = (np.array(board.inner_corners) + 1) * board.square_mm / 2 * MM
    print_corners = np.array([[x, y, 0.0] for x in (-half_x, half_x) for y in (-half_y, half_y)])
    in_left = camera_T_board.apply(print_corners)
    across = Rotation.from_euler("y", -_half_toe_in(scenario)).apply([1.0, 0.0, 0.0])
    toe_in = Rotation.from_euler("y", 2 * _half_toe_in(scenario))
    in_right = toe_in.apply(in_left - across * cameras.baseline_mm * MM)
    points = np.vstack([in_left, in_right])
    pixels = points[:, :2] / points[:, 2:] * cameras.focal_px + cameras.centre_px
    inside = (pixels > _EDGE_PX) & (pixels < np.array(cameras.image_px) - _EDGE_PX)
    return bool(inside.all())


def _half_toe_in(scenario: Scenario) -> float:
    return float(np.deg2rad(scenario.cameras.toe_in_deg / 2))
