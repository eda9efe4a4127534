"""What a picture shows: walls, parts below, finish fixed to the part, boards that OpenCV reads."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from fakes.render import api
from fakes.render.optics.canvas import Image
from fakes.render.worker import fingerprint, render_frame
from fakes.world.scene import CameraScene, LensTruth, ScenePlate, StereoTruth

CLEAN = api.RenderOptions.clean()


def cut(stereo: StereoTruth, plate: ScenePlate, name: str, half: int = 60) -> StereoTruth:
    """The head with images reduced to the surroundings of a hole: quick to render."""
    places = api.project_hole_centres(stereo, plate)[name]

    def shifted(lens: LensTruth, place: NDArray[np.float64]) -> LensTruth:
        x, y = np.array(lens.centre_px) - place + half
        return replace(lens, centre_px=(float(x), float(y)))

    left, right = shifted(stereo.left, places[0]), shifted(stereo.right, places[1])
    size = (2 * half + 1, 2 * half + 1)
    return replace(stereo, image_size_px=size, left=left, right=right)


def bright_side(picture: Image, radius_px: float = 19.0) -> float:
    """Offset in x of the light's centroid inside the hole in the middle, px."""
    half = picture.shape[0] // 2
    y, x = np.mgrid[-half : half + 1, -half : half + 1]
    inside = np.hypot(x, y) < radius_px
    weight = (picture - picture[inside].min())[inside]
    return float((weight * x[inside]).sum() / weight.sum())


def test_cameras_see_opposite_walls() -> None:
    deck = api.nominal_plate("deck")
    head = cut(api.nominal_head(), deck, "P1")
    # the light must not decide: mean over several directions
    options = replace(CLEAN, wall_grey=70.0)
    pairs = [api.clean_pair(head, [deck], options, light_seed=seed) for seed in range(6)]
    left = np.mean([bright_side(pair[0]) for pair in pairs])
    right = np.mean([bright_side(pair[1]) for pair in pairs])
    assert left > 2  # the left camera looks at the right wall
    assert right < -2


def test_frame_below_shows_through_the_deck() -> None:
    deck = api.nominal_plate("deck", shift_m=(0.0, 0.0, -0.04))
    frame = api.nominal_plate("frame", shift_m=(0.012, 0.0, 0.0))
    head = cut(api.nominal_head(), deck, "P1")
    options = replace(CLEAN, wall_grey=18.001)
    alone = api.clean_pair(head, [deck], options)[0]
    above_frame = api.clean_pair(head, [frame, deck], options)[0]
    difference = above_frame - alone
    half = difference.shape[0] // 2
    assert difference[half - 8 : half + 9, half - 8 : half + 9].max() > 10
    assert np.abs(difference[:20]).max() < 1e-3


def test_nearer_part_hides_the_farther_one() -> None:
    deck = replace(api.nominal_plate("deck", shift_m=(0.0, 0.0, -0.04)), holes=())
    frame = api.nominal_plate("frame")
    head = cut(api.nominal_head(), frame, "P1")
    hidden = api.clean_pair(head, [deck, frame], CLEAN)[0]
    assert np.ptp(hidden) < 1e-3


def test_finish_moves_with_the_part() -> None:
    deck = replace(api.nominal_plate("deck"), holes=())
    options = replace(CLEAN, texture_grey=6.0)
    head = replace(api.nominal_head(blur_px=0.0), image_size_px=(1600, 1100))
    pixel_m = 0.508 / 3580
    moved = api.nominal_plate("deck", shift_m=(0.0, 8 * pixel_m, 0.0))
    first = api.clean_pair(head, [deck], options)[0][500:900, 1150:1550].astype(float)
    second = api.clean_pair(head, [replace(moved, holes=())], options)[0]
    shifts = {
        dy: np.corrcoef(first.ravel(), second[500 + dy : 900 + dy, 1150:1550].ravel())[0, 1]
        for dy in range(4, 13)
    }
    assert max(shifts, key=lambda dy: shifts[dy]) == 8
    assert shifts[8] > 0.9
    other = api.clean_pair(head, [replace(deck, seed=99)], options)[0][500:900, 1150:1550]
    assert abs(np.corrcoef(first.ravel(), other.ravel())[0, 1]) < 0.4


def test_clutter_stays_clear_of_holes_and_can_be_switched_off() -> None:
    deck = api.nominal_plate("deck")
    head = cut(api.nominal_head(), deck, "P2", half=300)
    plain = api.clean_pair(head, [deck], CLEAN)[0]
    cluttered_options = replace(CLEAN, false_circles_per_m2=4000.0, scratches_per_m2=0.0)
    cluttered = api.clean_pair(head, [deck], cluttered_options)[0]
    changed = np.abs(cluttered - plain) > 0.5
    assert changed.mean() > 0.01
    y, x = np.mgrid[-300:301, -300:301]
    assert not changed[np.hypot(x, y) < 42].any()


@pytest.mark.figures  # calibrations find it in their images
def test_opencv_finds_the_chessboard_where_it_is() -> None:
    board = api.nominal_chessboard(api.facing_pose(tilt_deg=(8.0, -12.0, 3.0)))
    stereo = api.nominal_head()
    left, right = api.render_pair(stereo, [board], api.RenderOptions(), np.random.default_rng(1))
    columns, rows = board.inner_corners
    grid_x, grid_y = np.meshgrid(np.arange(columns), np.arange(rows))
    points = np.column_stack([grid_x.ravel(), grid_y.ravel(), np.zeros(grid_x.size)]).astype(float)
    points[:, :2] -= [(columns - 1) / 2, (rows - 1) / 2]
    from fakes.render.optics.lens import views
    from fakes.render.optics.surface import to_pixels

    for image, view in zip((left, right), views(stereo), strict=True):
        truth = to_pixels(view, board.camera_T_board, points * board.square_m)
        found, corners = cv2.findChessboardCornersSB(image, board.inner_corners)
        assert found
        distance = np.linalg.norm(corners.reshape(-1, 1, 2) - truth[None], axis=2).min(axis=1)
        assert distance.max() < 0.15


@pytest.mark.figures  # `test_charuco.py` reads it in images as well
def test_opencv_reads_the_charuco_board() -> None:
    board = api.SceneCharucoBoard(
        api.facing_pose(tilt_deg=(5.0, 6.0, 0.0)),
        squares=(11, 8),
        square_m=0.02,
        marker_m=0.015,
        dictionary=cv2.aruco.DICT_4X4_50,
        size_m=(0.25, 0.19),
    )
    stereo = api.nominal_head()
    left, _ = api.render_pair(stereo, [board], api.RenderOptions(), np.random.default_rng(1))
    dictionary = cv2.aruco.getPredefinedDictionary(board.dictionary)
    layout = cv2.aruco.CharucoBoard(board.squares, board.square_m, board.marker_m, dictionary)
    corners, ids, _, _ = cv2.aruco.CharucoDetector(layout).detectBoard(left)
    assert len(ids) == 70
    points = np.asarray(layout.getChessboardCorners())[ids.ravel()].astype(float)
    points[:, 0] -= 11 * board.square_m / 2
    points[:, 1] = 8 * board.square_m / 2 - points[:, 1]
    from fakes.render.optics.lens import views
    from fakes.render.optics.surface import to_pixels

    truth = to_pixels(views(stereo)[0], board.camera_T_board, points)
    assert np.linalg.norm(corners.reshape(-1, 2) - truth, axis=1).max() < 0.5


def scene_of(head: StereoTruth, deck: ScenePlate, noise_seed: int) -> CameraScene:
    return CameraScene("head_1", 1.0 * noise_seed, head, (deck,), 3, noise_seed)


def test_same_scene_gives_the_same_frame_and_a_new_seed_only_new_noise() -> None:
    deck = api.nominal_plate("deck")
    head = cut(api.nominal_head(), deck, "P1")
    options = api.RenderOptions()
    first = render_frame(scene_of(head, deck, 1), options)
    again = render_frame(scene_of(head, deck, 1), options)
    other = render_frame(scene_of(head, deck, 2), options)
    assert first == again
    pixels = [np.frombuffer(frame.payload, np.uint8).astype(float) for frame in (first, other)]
    difference = pixels[0] - pixels[1]
    assert abs(difference.mean()) < 0.1
    assert 1.5 < difference.std() < 4


def test_fingerprint_sees_a_micrometre() -> None:
    scene = scene_of(api.nominal_head(), api.nominal_plate("deck"), 1)
    same = scene_of(api.nominal_head(), api.nominal_plate("deck"), 1)
    moved = replace(scene, bodies=(api.nominal_plate("deck", shift_m=(1e-6, 0.0, 0.0)),))
    assert fingerprint(scene) == fingerprint(same)
    assert fingerprint(scene) != fingerprint(moved)


def test_face_turned_away_leaves_the_background() -> None:
    away = api.nominal_plate("deck", tilt_deg=(180.0, 0.0, 0.0))
    head = cut(api.nominal_head(), api.nominal_plate("deck"), "P1")
    left, right = api.clean_pair(head, [away], CLEAN)
    assert np.ptp(left) == 0
    assert np.ptp(right) == 0
