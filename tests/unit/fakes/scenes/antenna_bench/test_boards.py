"""Calibration board and reference plate lie where both cameras see all of them."""

import tomllib
from itertools import product
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.processes.antenna_module.connector.marks import read_marks
from fakes.render.optics.lens import views_of
from fakes.render.optics.surface import to_pixels
from fakes.scenes.antenna_bench.scenario import BenchScenario
from fakes.scenes.antenna_bench.scene import AntennaBench
from fakes.world.arm import inverse
from fakes.world.connector.scene import SceneMarks
from fakes.world.frames import MM, from_written, to_written
from fakes.world.scene import SceneChessboard
from tests.rigs.sweeps import sweep
from tests.unit.fakes.scenes.antenna_bench.placed_arm import bench_at, bench_with

CONFIG = Path(__file__).parents[5] / "config"
TILT_DEG, TURN_DEG, NEARER_MM = 20.0, 40.0, 20.0
_TURNED = [
    (heading, turn, way)
    for heading, turn, way in product(range(0, 360, 45), (-TURN_DEG, TURN_DEG), (-1, 1))
]


def pose_round(
    scenario: BenchScenario, taught: str, heading_deg: float, turn_deg: float, way: int
) -> RigidTransform:
    """cell_T_flange of a calibration pose: tilted, turned, nearer or farther than taught."""
    flange = from_written(scenario.taught["arm"][taught])
    if taught == "board_look":
        camera = scenario.cameras["camera_1"].flange_T_camera_mm_deg
        assert camera is not None
        flange_T_pivot = from_written(camera) * _along_z(250.0)
    else:
        flange_T_pivot = from_written(scenario.board.flange_T_board_mm_deg)
    axis = [np.cos(np.deg2rad(heading_deg)), np.sin(np.deg2rad(heading_deg)), 0.0]
    tilt = Rotation.from_rotvec(np.deg2rad(TILT_DEG) * np.array(axis))
    turned = tilt * Rotation.from_euler("z", turn_deg, degrees=True)
    turn, nearer = RigidTransform.from_rotation(turned), _along_z(way * NEARER_MM)
    # Along the line of sight: that of the carried camera turns with the flange.
    move = turn * nearer if taught == "board_look" else nearer * turn
    return flange * flange_T_pivot * move * flange_T_pivot.inv()


def _along_z(way_mm: float) -> RigidTransform:
    return RigidTransform.from_translation([0.0, 0.0, way_mm * MM])


def print_px(world: AntennaBench, camera: str) -> NDArray[np.float64]:
    """Corners of the print in the picture of a camera, which sees nothing but the board."""
    (board,) = world.camera_scene(camera).bodies
    assert isinstance(board, SceneChessboard)
    half = (np.array(board.inner_corners) + 1) * board.square_m / 2
    corners = np.array([[x, y, 0.0] for x, y in product((-1, 1), (-1, 1))]) * [*half, 0.0]
    (view,) = views_of(world.truth.cameras[camera].optics)
    return np.asarray(to_pixels(view, board.camera_T_board, corners))


@pytest.mark.parametrize(
    ("taught", "camera", "where"),
    sweep(
        (("board_look", "camera_1", "table"), ("board_show", "camera_2", "flange")),
        (("board_look", "camera_1", "table"),),
    ),
)
def test_all_of_the_board_is_seen_from_every_calibration_pose(
    scenario: BenchScenario, taught: str, camera: str, where: str
) -> None:
    size = np.array(scenario.optics["connector"].image_px)
    for number, turned in enumerate(_TURNED):
        flange = to_written(pose_round(scenario, taught, *turned))
        world = bench_with(scenario, tuple(flange), seed=number)
        world.operator.place_board(where, number)
        pixels = print_px(world, camera)
        assert (pixels > 15).all(), turned
        assert (pixels < size - 15).all(), turned


@pytest.mark.parametrize("taught", ["board_look", "board_show"])
def test_the_arm_has_room_round_both_board_poses_in_one_configuration(
    scenario: BenchScenario, taught: str
) -> None:
    arm = tomllib.loads((CONFIG / "antenna.toml").read_text(encoding="utf-8"))["robots"]["arm"]
    limits, near = arm["settings"], np.deg2rad(arm["poses_deg"][taught])
    for turned in _TURNED:
        flange = pose_round(scenario, taught, *turned)
        joints = np.rad2deg(inverse(scenario.robots["arm"].chain_mm, flange, near))
        assert (joints > limits["joints_min_deg"]).all(), turned
        assert (joints < limits["joints_max_deg"]).all(), turned
        assert (flange.translation / MM > limits["workspace_min_mm"]).all(), turned
        assert (flange.translation / MM < limits["workspace_max_mm"]).all(), turned
    assert limits["joints_min_deg"][2] > 0, "A3 keeps its sign"
    assert limits["joints_min_deg"][4] > 0, "A5 keeps its sign"


def test_another_number_is_another_placement(scenario: BenchScenario) -> None:
    world = bench_at(scenario, "board_look")
    places = []
    for number in (0, 0, 1):
        world.operator.place_board("table", number)
        places.append(print_px(world, "camera_1"))
    np.testing.assert_array_equal(places[0], places[1])
    assert np.abs(places[2] - places[0]).max() > 1.0
    world.operator.remove_boards()
    assert world.camera_scene("camera_1").bodies == ()


def test_the_board_hangs_only_where_no_module_is(scenario: BenchScenario) -> None:
    world = bench_at(scenario, "board_show")
    world.module.place = "gripper"
    with pytest.raises(ValueError, match="holds a module"):
        world.operator.place_board("flange")
    with pytest.raises(ValueError, match="table or flange"):
        world.operator.place_board("ceiling")


def dots(world: AntennaBench, camera: str) -> SceneMarks:
    found = [
        body
        for body in world.camera_scene(camera).bodies
        if isinstance(body, SceneMarks) and body.name == "reference plate"
    ]
    (plate,) = found
    return plate


@pytest.mark.parametrize(
    ("taught", "camera", "side"),
    sweep(
        (("reference_look", "camera_1", "above"), ("inspect_plug", "camera_2", "below")),
        (("inspect_plug", "camera_2", "below"),),
    ),
)
def test_both_cameras_see_the_dots_of_the_plate_as_drawn(
    scenario: BenchScenario, taught: str, camera: str, side: Literal["above", "below"]
) -> None:
    drawing = read_marks(CONFIG / "connectors" / f"reference-plate-{side}.toml")
    size = np.array(scenario.optics["connector"].image_px)
    for hardware_seed in range(20):
        world = bench_at(scenario, taught, hardware_seed=hardware_seed)
        plate = dots(world, camera)
        places = np.array([mark.position_m for mark in plate.marks])
        np.testing.assert_allclose(places, drawing.positions_m, atol=1e-9)
        assert {mark.diameter_m for mark in plate.marks} == {drawing.diameter_m}
        assert plate.camera_T_marks.rotation.as_matrix()[2, 2] < -0.99, "it faces the camera"
        (view,) = views_of(world.truth.cameras[camera].optics)
        pixels = to_pixels(view, plate.camera_T_marks, np.pad(places, ((0, 0), (0, 1))))
        room_px = 20 + drawing.diameter_m / 2 / 30e-6
        assert (pixels > room_px).all()
        assert (pixels < size - room_px).all()


def test_both_cameras_see_the_same_dots(scenario: BenchScenario) -> None:
    world = bench_at(scenario, "reference_look")
    places = []
    for camera in ("camera_1", "camera_2"):
        plate = dots(world, camera)
        points = np.array([[*mark.position_m, 0.0] for mark in plate.marks])
        places.append((world.camera_pose(camera) * plate.camera_T_marks).apply(points))
    np.testing.assert_allclose(places[0], places[1], atol=1e-9)


@pytest.mark.parametrize(
    ("fault", "key"),
    [
        ("camera_1_shifted", "flange_T_cam1_mm_deg"),
        ("camera_2_shifted", "base_T_cam2_mm_deg"),
        ("marks_shifted", "flange_T_marks_mm_deg"),
        ("plate_shifted", "cell_T_plate_mm_deg"),
    ],
)
def test_an_injected_slip_moves_one_device_alone(
    scenario: BenchScenario, fault: str, key: str
) -> None:
    world = bench_at(scenario, "inspect_plug")
    keys = {
        "flange_T_cam1_mm_deg", "base_T_cam2_mm_deg", "flange_T_marks_mm_deg", "cell_T_plate_mm_deg"
    }  # fmt: skip
    before = world.truth_report()
    world.faults.inject(fault, x_mm=0.02, y_mm=-0.03, turn_deg=0.1)
    after = world.truth_report()
    slip = np.subtract(after[key], before[key])
    np.testing.assert_allclose(slip[:3], [0.02, -0.03, 0.0], atol=1e-9)
    # Of a body that looks down, A turns the other way.
    assert abs(slip[3:]).max() == pytest.approx(0.1, abs=1e-3)
    for other in keys - {key}:
        np.testing.assert_allclose(after[other], before[other], atol=1e-9)
    world.faults.clear(fault)
    np.testing.assert_allclose(world.truth_report()[key], before[key], atol=1e-9)


def test_the_truth_tells_lenses_and_mounts(scenario: BenchScenario) -> None:
    world = bench_at(scenario, "board_look")
    report = world.truth_report()
    lens = views_of(world.truth.cameras["camera_2"].optics)[0].lens
    assert report["intrinsics"]["camera_2"]["focal_px"] == list(lens.focal_px)
    assert report["intrinsics"]["camera_2"]["centre_px"] == list(lens.centre_px)
    camera_1 = world.flange("arm") * from_written(report["flange_T_cam1_mm_deg"])
    np.testing.assert_allclose(
        to_written(camera_1), report["cell_T_camera_mm_deg"]["camera_1"], atol=1e-6
    )
