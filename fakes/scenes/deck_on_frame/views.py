"""What the cameras see of a deck, its frame and the boards of the calibrations."""

from collections.abc import Iterator

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.scenes.deck_on_frame.boards import board_discs
from fakes.scenes.deck_on_frame.flex import deck_T_tangent
from fakes.scenes.deck_on_frame.parts import PartsTruth
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.world.frames import MM, stream_seed
from fakes.world.scene import ScenePlate, SceneTargetBoard
from fakes.world.views import in_view

FRAME_THICKNESS_M = 40e-3


def plates(
    scenario: DeckScenario,
    parts: PartsTruth,
    camera_T_cell: RigidTransform,
    *,
    frame: bool,
    cell_T_deck: RigidTransform | None,
) -> Iterator[ScenePlate]:
    """Frame and deck, as far as they are there and in view."""
    width, height = np.array(scenario.parts.size_mm) * MM
    size = (float(width), float(height))
    pose = camera_T_cell * parts.cell_T_frame
    if frame and in_view(pose, size):
        yield ScenePlate(
            "frame", pose, size, FRAME_THICKNESS_M, parts.frame_holes, parts.frame_seed
        )
    if cell_T_deck is not None:
        pose = camera_T_cell * cell_T_deck
        if in_view(pose, size):
            thickness_m = scenario.parts.deck_thickness_mm * MM
            pose = pose * deck_T_tangent(scenario, pose)
            yield ScenePlate("deck", pose, size, thickness_m, parts.deck_holes, parts.deck_seed)


def seen_target_board(
    scenario: DeckScenario, seed: int, camera_T_board: RigidTransform
) -> SceneTargetBoard:
    """Board P."""
    board = scenario.target_board
    return SceneTargetBoard(
        camera_T_board=camera_T_board,
        size_m=(board.size_mm[0] * MM, board.size_mm[1] * MM),
        disc_diameter_m=board.disc_diameter_mm * MM,
        discs=board_discs(board),
        seed=stream_seed(seed, "target board texture"),
    )
