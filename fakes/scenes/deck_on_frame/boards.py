"""The boards of the calibrations: discs of board P, and where the operator's hands put them."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.scenario_file.sections import Optics, StereoRig
from fakes.scenes.deck_on_frame.scenario import DeckScenario, TargetBoard
from fakes.world.arm import forward, nominal_links
from fakes.world.frames import MM, displacement, from_written, stream
from fakes.world.scene import SceneDisc

_EDGE_PX = 40.0
"""Room for lens distortion and for lenses that differ from the nominal one."""
_BESIDE_FLANGE_MM = (23.3, 30.0)
"""Where board P lies under the flange, x and y: as ``flange_T_target_board`` of the cell file says.
A disc is looked for within 35 mm of there."""
_DRAWS = 1000
"""Views that are tried before the scenario's board is taken for one that fits into no picture."""


def board_discs(board: TargetBoard) -> tuple[SceneDisc, ...]:
    """P1 to P9, row by row: x right, y down the rows, P5 in the middle."""
    pitch_x, pitch_y = np.array(board.pitch_mm) * MM
    return tuple(
        SceneDisc(f"P{3 * row + column + 1}", ((column - 1) * pitch_x, (row - 1) * pitch_y))
        for row in range(3)
        for column in range(3)
    )


def measuring_flange(
    scenario: DeckScenario, head: str, joints_deg: Sequence[float] | None = None
) -> RigidTransform:
    """cell_T_flange of the robot that carries a head, where it measures: at these joints of the
    nominal arm, without them at the pose of the scenario."""
    carrier = scenario.stereo_cameras[head].carried_by
    assert carrier is not None  # the model of the scene demands it
    if joints_deg is None:
        return from_written(scenario.taught[carrier]["measure"])
    robot = scenario.robots[carrier]
    base_T_flange = forward(nominal_links(robot.chain_mm), np.deg2rad(joints_deg))
    return from_written(robot.base_mm_deg) * base_T_flange


def target_board_pose(
    scenario: DeckScenario, seed: int, head: str, number: int, flange: RigidTransform
) -> RigidTransform:
    """cell_T_board of board P, roughly under a head whose arm has its flange at ``flange``, its x
    along the rows of the head's images.

    Not over the middle of the holes that the head measures: those may lie to one side of its
    pictures, where the outer discs of the board would be out of sight.
    """
    board, rng = scenario.target_board, stream(seed, "target board", head, number)
    frame_T_cell = from_written(scenario.parts.frame_mm_deg).inv()
    flange_x, looks = flange.rotation.apply([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    above = frame_T_cell.apply(flange.translation)[2] - board.height_mm * MM
    middle = flange.translation - looks * above / frame_T_cell.rotation.apply(looks)[2]
    middle = middle + flange.rotation.apply([*_BESIDE_FLANGE_MM, 0.0]) * MM
    turn = Rotation.from_euler("z", np.arctan2(flange_x[1], flange_x[0]))
    offset = rng.uniform(-1, 1, 3) * np.array(board.placement.xyz_mm) * MM
    tilt = rng.uniform(-1, 1, 3) * np.deg2rad(board.placement.rotation_deg)
    return RigidTransform.from_components(middle, turn) * displacement(offset, tilt)


def chessboard_view(scenario: DeckScenario, seed: int, head: str, number: int) -> RigidTransform:
    """camera_T_board of one view: all of the print in both images, else spread at random."""
    rng = stream(seed, "chessboard view", head, number)
    optics = scenario.optics[scenario.stereo_cameras[head].optics]
    assert optics.stereo is not None  # the model of the scenario demands it of a stereo camera
    for _ in range(_DRAWS):
        view = _random_view(scenario, optics.stereo, rng)
        if _all_in_view(scenario, optics, optics.stereo, view):
            return view
    raise ValueError("the chessboard of the scenario fits no view of the heads")


def _random_view(
    scenario: DeckScenario, rig: StereoRig, rng: np.random.Generator
) -> RigidTransform:
    """A pose within the stereo overlap: any depth, off to a side, tilted and turned a little."""
    board = scenario.chessboard
    side = rng.uniform(-1, 1, 2) * np.array(board.offset_mm)
    between = Rotation.from_euler("y", -_half_toe_in(rig))
    across, depth = rig.baseline_mm / 2, rng.uniform(*board.distance_mm)
    place = between.apply([across + side[0], side[1], depth])
    heading, tilt = rng.uniform(0, 2 * np.pi), np.deg2rad(board.tilt_deg) * np.sqrt(rng.random())
    lean = Rotation.from_rotvec(tilt * np.array([np.cos(heading), np.sin(heading), 0.0]))
    turn_rad = rng.uniform(-1, 1) * board.turn_rad
    facing = between * Rotation.from_euler("x", np.pi) * lean * Rotation.from_euler("z", turn_rad)
    return RigidTransform.from_components(place * MM, facing)


def _all_in_view(
    scenario: DeckScenario, optics: Optics, rig: StereoRig, camera_T_board: RigidTransform
) -> bool:
    board = scenario.chessboard
    half_x, half_y = (np.array(board.inner_corners) + 1) * board.square_mm / 2 * MM
    print_corners = np.array([[x, y, 0.0] for x in (-half_x, half_x) for y in (-half_y, half_y)])
    in_left = camera_T_board.apply(print_corners)
    across = Rotation.from_euler("y", -_half_toe_in(rig)).apply([1.0, 0.0, 0.0])
    toe_in = Rotation.from_euler("y", 2 * _half_toe_in(rig))
    in_right = toe_in.apply(in_left - across * rig.baseline_mm * MM)
    points = np.vstack([in_left, in_right])
    pixels = points[:, :2] / points[:, 2:] * optics.focal_px + optics.centre_px
    inside = (pixels > _EDGE_PX) & (pixels < np.array(optics.image_px) - _EDGE_PX)
    return bool(inside.all())


def _half_toe_in(rig: StereoRig) -> float:
    return float(np.deg2rad(rig.toe_in_deg / 2))
