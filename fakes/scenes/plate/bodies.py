"""Plates and boards as they were made and as they lie: what the scenario says, with its errors."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.scenes.plate.scenario import Plate, PlateHole, PrintedBoard
from fakes.world.frames import MM, from_written, stream, stream_seed
from fakes.world.scene import SceneChessboard, SceneHole, ScenePlate
from fakes.world.truth import drawn_spread


@dataclass(frozen=True, slots=True)
class LyingPlate:
    """A plate in the cell."""

    name: str
    cell_T_body: RigidTransform
    size_m: tuple[float, float]
    thickness_m: float
    holes: tuple[SceneHole, ...]
    seed: int

    def seen(self, camera_T_cell: RigidTransform) -> ScenePlate:
        """As a camera has it before it."""
        pose = camera_T_cell * self.cell_T_body
        return ScenePlate(self.name, pose, self.size_m, self.thickness_m, self.holes, self.seed)


@dataclass(frozen=True, slots=True)
class LyingBoard:
    """A printed chessboard in the cell."""

    cell_T_body: RigidTransform
    size_m: tuple[float, float]
    inner_corners: tuple[int, int]
    square_m: float
    seed: int

    def seen(self, camera_T_cell: RigidTransform) -> SceneChessboard:
        """As a camera has it before it; the board is flat."""
        return SceneChessboard(
            camera_T_board=camera_T_cell * self.cell_T_body,
            inner_corners=self.inner_corners,
            square_m=self.square_m,
            size_m=self.size_m,
            bow_m=(0.0, 0.0),
            seed=self.seed,
        )


def draw_plate(plate: Plate, seed: int, name: str, number: int) -> LyingPlate:
    """The ``number``-th plate of this name that is laid into the cell."""
    rng = stream(seed, "plate", name, number)
    width, height = plate.size_mm
    return LyingPlate(
        name=name,
        cell_T_body=from_written(plate.cell_T_plate_mm_deg) * drawn_spread(rng, plate.placement),
        size_m=(width * MM, height * MM),
        thickness_m=plate.thickness_mm * MM,
        holes=tuple(_hole(plate, hole, rng) for hole in plate.holes),
        seed=stream_seed(seed, "plate texture", name, number),
    )


def draw_board(board: PrintedBoard, seed: int, name: str, number: int) -> LyingBoard:
    """The board of this name, laid into the cell for the ``number``-th time."""
    rng = stream(seed, "board", name, number)
    width, height = board.size_mm
    return LyingBoard(
        cell_T_body=from_written(board.cell_T_board_mm_deg) * drawn_spread(rng, board.placement),
        size_m=(width * MM, height * MM),
        inner_corners=board.inner_corners,
        square_m=board.square_mm * MM,
        seed=stream_seed(seed, "board texture", name),
    )


def _hole(plate: Plate, hole: PlateHole, rng: np.random.Generator) -> SceneHole:
    x, y = (np.array(hole.position_mm) + rng.normal(0, plate.hole_sigma_mm, 2)) * MM
    return SceneHole(
        name=hole.name,
        kind=hole.kind,
        position_m=(float(x), float(y)),
        diameter_m=hole.diameter_mm * MM,
        countersink_m=None if hole.countersink_mm is None else hole.countersink_mm * MM,
        depth_m=plate.thickness_mm * MM,
        through=hole.through,
    )
