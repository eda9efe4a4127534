"""Where the operator puts the calibration board, and the reference plate that stays."""

from typing import Final, Literal

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.scenes.antenna_bench.scenario import BenchScenario
from fakes.world.connector.scene import SceneMark, SceneMarks
from fakes.world.frames import MM, from_written, stream
from fakes.world.truth import drawn_spread

BoardPlace = Literal["table", "flange"]
BOARD_PLACES: Final[tuple[BoardPlace, ...]] = ("table", "flange")
_UPSIDE_DOWN = RigidTransform.from_rotation(Rotation.from_euler("x", 180, degrees=True))


def board_pose(
    scenario: BenchScenario, seed: int, where: BoardPlace, number: int
) -> RigidTransform:
    """cell_T_board on the table, flange_T_board on the flange; z out of the print."""
    board = scenario.board
    nominal = board.cell_T_board_mm_deg if where == "table" else board.flange_T_board_mm_deg
    rng = stream(seed, "calibration board", where, number)
    return from_written(nominal) * drawn_spread(rng, board.placement)


def plate_pose(scenario: BenchScenario, cell_T_fixed_camera: RigidTransform) -> RigidTransform:
    """cell_T_plate of the strip with dots; z upwards, towards camera I."""
    plate = scenario.plate
    rng = stream(scenario.hardware_seed, "reference plate")
    return (
        cell_T_fixed_camera
        * from_written(plate.camera_T_plate_mm_deg)
        * drawn_spread(rng, plate.placement)
    )


def plate_dots(scenario: BenchScenario, camera_T_plate: RigidTransform) -> SceneMarks:
    """The dots as a camera sees them from its side; from below in a mirror."""
    plate = scenario.plate
    # z of whatever a scene shows points towards the camera: seen from below the strip is turned
    # over, and its dots are mirrored so that they stay where they are in the cell.
    from_below = camera_T_plate.rotation.as_matrix()[2, 2] > 0
    side = -1.0 if from_below else 1.0
    dots = tuple(
        SceneMark(f"D{index}", (x * MM, side * y * MM), plate.dot_diameter_mm * MM)
        for index, (x, y) in enumerate(plate.dots_mm, start=1)
    )
    pose = camera_T_plate * _UPSIDE_DOWN if from_below else camera_T_plate
    return SceneMarks("reference plate", pose, (), dots)


def plate_size_m(scenario: BenchScenario) -> tuple[float, float]:
    """Width and height of the field with dots."""
    dots = np.array(scenario.plate.dots_mm)
    width, height = 2 * np.abs(dots).max(axis=0) + scenario.plate.dot_diameter_mm
    return float(width * MM), float(height * MM)
