"""What the heads see of the world."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.scenario import HeadName
from fakes.world.frames import MM, from_written, stream_seed
from fakes.world.scene import CameraScene, SceneChessboard, ScenePlate, SceneTargetBoard
from fakes.world.snapshot import Snapshot
from fakes.world.truth import board_discs

_FACING_MIN = 0.6
_NEAREST_M = 0.15
_SLOPE_MAX = 0.5
"""Half the field of view is about 0.34 times the distance."""


def camera_pose(world: Snapshot, head: HeadName) -> RigidTransform:
    """True cell_T_camera of a head's left camera."""
    cell_T_flange = world.flanges[world.scenario.heads[head].robot]
    return cell_T_flange * world.truth.heads[head].flange_T_head


def measuring_camera_pose(world: Snapshot, head: HeadName) -> RigidTransform:
    """cell_T_camera as it would be with the head at its taught measuring pose, roughly."""
    cell_T_flange = from_written(world.scenario.taught[world.scenario.heads[head].robot]["measure"])
    return cell_T_flange * world.truth.heads[head].flange_T_head


def camera_scene(world: Snapshot, head: HeadName, exposure: int) -> CameraScene:
    """One exposure, with everything that is in the cell."""
    camera_T_cell = camera_pose(world, head).inv()
    truth = world.truth.heads[head]
    frame, deck = _plates(world, camera_T_cell)
    return CameraScene(
        head=head,
        time_s=world.time_s,
        stereo=truth.stereo,
        frame=frame,
        deck=deck,
        target_board=_target_board(world, camera_T_cell),
        chessboard=_chessboard(world, camera_T_cell),
        light_seed=truth.light_seed,
        noise_seed=stream_seed(world.seed, "exposure", head, exposure),
    )


def _plates(
    world: Snapshot, camera_T_cell: RigidTransform
) -> tuple[ScenePlate | None, ScenePlate | None]:
    parts, frame, deck = world.placed.parts, None, None
    if parts is None:
        return None, None
    width, height = np.array(world.scenario.parts.size_mm) * MM
    size = (float(width), float(height))
    pose = camera_T_cell * parts.cell_T_frame
    if world.placed.frame and in_view(pose, size):
        frame = ScenePlate("frame", pose, size, parts.frame_holes, parts.frame_seed)
    if world.cell_T_deck is not None:
        pose = camera_T_cell * world.cell_T_deck
        if in_view(pose, size):
            deck = ScenePlate("deck", pose, size, parts.deck_holes, parts.deck_seed)
    return frame, deck


def in_view(camera_T_plate: RigidTransform, size_m: tuple[float, float]) -> bool:
    """True when part of a plate's face can be in an image; generous at the edges.

    The world has arms elsewhere: a deck behind the camera, edge-on or far aside is not seen.
    """
    facing = float(camera_T_plate.rotation.as_matrix()[2, 2]) < -_FACING_MIN
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, 17), np.linspace(-0.5, 0.5, 9))
    face = np.column_stack([x.ravel() * size_m[0], y.ravel() * size_m[1], np.zeros(x.size)])
    points = camera_T_plate.apply(face)
    ahead = points[points[:, 2] > _NEAREST_M]
    slopes = np.abs(ahead[:, :2] / ahead[:, 2:])
    return facing and bool((slopes < _SLOPE_MAX).all(axis=1).any())


def _target_board(world: Snapshot, camera_T_cell: RigidTransform) -> SceneTargetBoard | None:
    cell_T_board = world.placed.target_board
    if cell_T_board is None:
        return None
    board = world.scenario.target_board
    return SceneTargetBoard(
        camera_T_board=camera_T_cell * cell_T_board,
        size_m=(board.size_mm[0] * MM, board.size_mm[1] * MM),
        disc_diameter_m=board.disc_diameter_mm * MM,
        discs=board_discs(world.scenario),
        seed=stream_seed(world.seed, "target board texture"),
    )


def _chessboard(world: Snapshot, camera_T_cell: RigidTransform) -> SceneChessboard | None:
    cell_T_board = world.placed.chessboard
    if cell_T_board is None:
        return None
    board = world.scenario.chessboard
    return SceneChessboard(
        camera_T_board=camera_T_cell * cell_T_board,
        inner_corners=board.inner_corners,
        square_m=board.square_mm * MM,
        size_m=(board.size_mm[0] * MM, board.size_mm[1] * MM),
        bow_m=world.truth.chessboard_bow_m,
        seed=stream_seed(world.seed, "chessboard texture"),
    )
