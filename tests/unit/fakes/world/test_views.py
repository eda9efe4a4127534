"""From the taught poses the heads see what they shall see, whatever the seed."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from fakes.scenario import HeadName, RobotName, Scenario
from fakes.world.scene import LensTruth, ScenePlate, StereoTruth
from fakes.world.world import World
from tests.unit.fakes.world.driving import to_taught

HEADS: tuple[HeadName, ...] = ("head_1", "head_2")


def project(lens: LensTruth, points: np.ndarray) -> np.ndarray:
    return np.asarray(points[:, :2] / points[:, 2:] * lens.focal_px + lens.centre_px)


def in_both(stereo: StereoTruth, points: np.ndarray, margin_px: float) -> bool:
    pixels = np.vstack(
        [
            project(stereo.left, points),
            project(stereo.right, stereo.right_T_left.apply(points)),
        ]
    )
    room = np.array(stereo.image_size_px) - margin_px
    return bool((pixels > margin_px).all() and (pixels < room).all())


def measuring(scenario: Scenario, seed: int) -> World:
    world = World(scenario, seed)
    stations: tuple[tuple[RobotName, str], ...] = (
        ("aux_1", "measure"),
        ("aux_2", "measure"),
        ("main", "clear"),
    )
    for robot, pose in stations:
        to_taught(world, robot, pose)
    return world


@pytest.mark.parametrize("seed", range(5))
def test_holes_are_well_inside_both_images(scenario: Scenario, seed: int) -> None:
    world = measuring(scenario, seed)
    for head in HEADS:
        scene = world.camera_scene(head)
        assert scene.frame is not None
        assert scene.deck is None, "the deck at its clear pose must not cover the frame"
        assert scene.frame.camera_T_part.rotation.as_matrix()[2, 2] < -0.97
        assert in_both(scene.stereo, seen_holes(scenario, head, scene.frame), 250)
    to_taught(world, "main", "deck_measure")
    for head in HEADS:
        scene = world.camera_scene(head)
        assert scene.deck is not None
        assert in_both(scene.stereo, seen_holes(scenario, head, scene.deck), 150)


def seen_holes(scenario: Scenario, head: HeadName, plate: ScenePlate) -> np.ndarray:
    names = scenario.heads[head].sees
    places = [[*hole.position_m, 0.0] for hole in plate.holes if hole.name in names]
    return np.asarray(plate.camera_T_part.apply(np.array(places)))


@pytest.mark.parametrize("head", HEADS)
def test_all_of_the_chessboard_is_in_both_images(scenario: Scenario, head: HeadName) -> None:
    world = measuring(scenario, 1)
    board = scenario.chessboard
    half = (np.array(board.inner_corners) - 1) * board.square_mm / 2000
    corners = np.array([[sx * half[0], sy * half[1], 0] for sx in (-1, 1) for sy in (-1, 1)])
    outer = corners * (half + board.square_mm / 1000)[[0, 1, 1]] / half[[0, 1, 1]]
    for number in range(60):
        world.place_chessboard(head, number)
        scene = world.camera_scene(head)
        assert scene.chessboard is not None
        camera_T_board = scene.chessboard.camera_T_board
        assert in_both(scene.stereo, camera_T_board.apply(outer), 2)
        assert camera_T_board.rotation.as_matrix()[2, 2] < -0.8


@pytest.mark.parametrize("head", HEADS)
def test_all_discs_are_in_both_images_and_seen_from_above(
    scenario: Scenario, head: HeadName
) -> None:
    world = measuring(scenario, 2)
    for number in range(10):
        world.place_target_board(head, number)
        scene = world.camera_scene(head)
        assert scene.target_board is not None
        discs = np.array([[*disc.position_m, 0] for disc in scene.target_board.discs])
        points = scene.target_board.camera_T_board.apply(discs)
        assert in_both(scene.stereo, points, 80)
        names = {target.name for target in world.targets(1)}
        assert names >= {f"P{index}" for index in range(1, 10)}


def test_boards_stay_where_they_were_put(scenario: Scenario) -> None:
    world = measuring(scenario, 1)
    world.place_target_board("head_1", 0)
    before = world.placed.target_board
    to_taught(world, "aux_1", "retracted")
    assert world.placed.target_board is before
    world.remove_boards()
    assert world.camera_scene("head_1").target_board is None


def test_unmoved_scene_differs_in_noise_only(scenario: Scenario) -> None:
    world = measuring(scenario, 1)
    world.advance(world.time_s + 3)
    one, other = world.camera_scene("head_1"), world.camera_scene("head_1")
    assert one.noise_seed != other.noise_seed
    assert one.frame is not None
    assert other.frame is not None
    assert same(one.frame.camera_T_part, other.frame.camera_T_part)


def same(one: RigidTransform, other: RigidTransform) -> bool:
    return bool((one.as_matrix() == other.as_matrix()).all())


def test_nominal_rig_has_the_geometry_of_table_1(scenario: Scenario) -> None:
    stereo = World(scenario, 1).truth.heads["head_1"].stereo
    assert np.linalg.norm(stereo.right_T_left.translation) == pytest.approx(0.179, abs=6e-4)
    angle_deg = np.rad2deg(stereo.right_T_left.rotation.magnitude())
    assert angle_deg == pytest.approx(20, abs=0.4)
