"""A printed chessboard as it was made: bowed a little, the same in the whole life of a cell."""

from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from fakes.scenario_file.sections import ChessboardPrint
from fakes.world.frames import MM, stream, stream_seed
from fakes.world.scene import SceneChessboard


@dataclass(frozen=True, slots=True)
class MadeChessboard:
    """The board with the bow that it really has."""

    inner_corners: tuple[int, int]
    square_m: float
    size_m: tuple[float, float]
    bow_m: tuple[float, float]
    seed: int
    """Seed of its texture."""

    def seen(self, camera_T_board: RigidTransform) -> SceneChessboard:
        """The board in the frame of a camera."""
        return SceneChessboard(
            camera_T_board=camera_T_board,
            inner_corners=self.inner_corners,
            square_m=self.square_m,
            size_m=self.size_m,
            bow_m=self.bow_m,
            seed=self.seed,
        )


def chessboard_as_made(board: ChessboardPrint, hardware_seed: int, seed: int) -> MadeChessboard:
    """Its bow belongs to the hardware like the cameras; its texture to the run."""
    rng = stream(hardware_seed, "chessboard")
    bow_x, bow_y = rng.uniform(-1, 1, 2) * board.bow_spread_mm * MM
    return MadeChessboard(
        inner_corners=board.inner_corners,
        square_m=board.square_mm * MM,
        size_m=(board.size_mm[0] * MM, board.size_mm[1] * MM),
        bow_m=(float(bow_x), float(bow_y)),
        seed=stream_seed(seed, "chessboard texture"),
    )
