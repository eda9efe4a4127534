"""`cellctl calibrate camera` from images, as a user would call it."""

import json
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation
from typer.testing import CliRunner, Result

from cellctl.calibration.solvers.single_camera.single_camera_result import SingleCameraResult
from cellctl.cli.offline.calibrate import app
from cellctl.errors.calibration import (
    KnownBoardDiffers,
    MixedImageSizes,
    PoorCoverage,
    TooFewViews,
    WrongBoard,
)
from cellctl.errors.config import FileInvalid
from cellctl.errors.vision import ImageFileInvalid
from cellctl.vision.camera.single_camera import read_single_camera
from fakes.render import api
from fakes.world.scene import CameraScene, LensTruth, MonoTruth, SceneChessboard
from tests.rigs.calibration import circle_boards

SIZE, FOCAL_PX, DISTANCE_M = (640, 480), (1500.0, 1503.0), 0.25
LENS = LensTruth(FOCAL_PX, (322.0, 238.0), (-0.08, 0.05, 2e-4, -1e-4, 0.0), 0.8, 1.0)
SQUARE_MM = 8
COUNT = 8


def picture_of(number: int) -> NDArray[np.uint8]:
    """The board anywhere before the camera, tilted to all sides."""
    rng = np.random.default_rng(number)
    shift_m = rng.uniform(-1, 1, 3) * (8e-3, 7e-3, 25e-3) + np.array([0.0, 0.0, DISTANCE_M])
    tilt = 0.5 * np.array([np.cos(2.4 * number), np.sin(2.4 * number), rng.uniform(-0.6, 0.6)])
    turn = Rotation.from_euler("x", np.pi) * Rotation.from_rotvec(tilt)
    pose = RigidTransform.from_components(shift_m, turn)
    size_m = (9 * SQUARE_MM * 1e-3, 6.5 * SQUARE_MM * 1e-3)
    board = SceneChessboard(pose, (7, 4), SQUARE_MM * 1e-3, size_m, (1e-5, -2e-5), 1)
    optics = MonoTruth(SIZE, LENS, colour=False)
    (image,) = api.render_scene(CameraScene("cam", 0.0, optics, (board,), 1, number))
    return image


@pytest.fixture(scope="module")
def images(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("camera")
    for number in range(COUNT):
        cv2.imwrite(str(folder / f"c-{number:02d}.png"), picture_of(number))
    cv2.imwrite(str(folder / "c-empty.png"), np.full((SIZE[1], SIZE[0]), 90, np.uint8))
    return folder


def calibrate(images: str, out: Path, *more: object, board: str = "7x4") -> Result:
    arguments = ("camera", "--images", images, "--board", board, "--square-mm", SQUARE_MM,
                 "--out", out, *more)  # fmt: skip
    return CliRunner().invoke(app, [str(one) for one in arguments])


def test_a_camera_from_images(images: Path, tmp_path: Path) -> None:
    out, picture = tmp_path / "cam.json", tmp_path / "cam.png"
    result = calibrate(f"{images}/c-*.png", out, "--picture", picture)
    assert result.exit_code == 0, result.output
    assert "left out: c-empty" in result.output
    camera = read_single_camera(out)
    assert camera.image_size == SIZE
    assert camera.model.camera_matrix[0, 0] == pytest.approx(FOCAL_PX[0], rel=4e-3)
    record = json.loads(out.read_text())
    assert record["id"] == camera.id
    assert camera.id in result.output
    assert (record["verdict"], len(record["views"])) == ("pass", COUNT)
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_wrong_inputs_are_named_and_nothing_is_written(images: Path, tmp_path: Path) -> None:
    out = tmp_path / "cam.json"
    for number in range(8):
        shutil.copy(images / "c-03.png", tmp_path / f"same-{number}.png")
    (tmp_path / "text.png").write_text("no image")
    # Small, because all sizes of boards are looked for in it.
    small = cv2.resize(picture_of(0), (200, 150), interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(tmp_path / "same-8.png"), small)
    cases: tuple[tuple[str, str, type[Exception], str], ...] = (
        (f"{images}/none-*.png", "7x4", FileInvalid, "no file matches"),
        (f"{images}", "7x4", FileInvalid, "is a folder: give a pattern of the images in it"),
        (f"{tmp_path}/text.png", "7x4", ImageFileInvalid, "text.png"),
        (f"{images}/c-0[0-2].png", "7x4", TooFewViews, "3 usable views"),
        (f"{tmp_path}/same-8.png", "8x5", WrongBoard, "8 x 5"),
        (f"{tmp_path}/same-[0-7].png", "7x4", PoorCoverage, "image cells"),
        (f"{tmp_path}/same-[78].png", "7x4", MixedImageSizes, "same-8"),
    )
    for pattern, board, fault, words in cases:
        result = calibrate(pattern, out, board=board)
        assert isinstance(result.exception, fault), (pattern, result.exception)
        assert words in str(result.exception)
    assert not out.exists()


def test_a_camera_from_a_circle_grid(tmp_path: Path) -> None:
    stereo, rng = circle_boards.head(4.0), np.random.default_rng(8)
    for number in range(COUNT + 4):
        tilt_deg = (*rng.uniform(-35, 35, 2), rng.uniform(-180, 180))
        seen = circle_boards.seen_grid(stereo, circle_boards.STAGGERED, tilt_deg, rng)
        cv2.imwrite(str(tmp_path / f"g-{number}.png"), seen.image)
    out, picture = tmp_path / "cam.json", tmp_path / "cam.png"
    arguments = ("camera", "--images", tmp_path / "g-*.png", "--board", "4x11", "--square-mm",
                 12, "--circle-mm", 10.5, "--asymmetric", "--out", out, "--picture",
                 picture)  # fmt: skip
    result = CliRunner().invoke(app, [str(one) for one in arguments])
    assert result.exit_code == 0, result.output
    truth = stereo.left.focal_px[0]
    assert read_single_camera(out).model.camera_matrix[0, 0] == pytest.approx(truth, rel=2e-3)
    board = SingleCameraResult.from_record(json.loads(out.read_text())).board
    assert str(board) == "4 x 11 asymmetric circle grid, 12 mm pitch"
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (("--asymmetric",), "--asymmetric needs --circle-mm"),
        (("--circle-mm", "9"), "smaller than their distance"),
        (("--marker-mm", "5"), "--marker-mm needs --charuco"),
        (("--charuco", "5X5_100"), "--charuco needs --marker-mm"),
        (("--circle-mm", "3", "--charuco", "5X5_100", "--marker-mm", "5"), "not both"),
    ],
)
def test_options_of_boards_that_do_not_go_together(
    tmp_path: Path, options: tuple[str, ...], reason: str
) -> None:
    result = calibrate("x", tmp_path / "o.json", *options)
    assert result.exit_code == 2
    # The console breaks lines where they end.
    assert reason in " ".join(result.output.replace("│", " ").split())


def test_the_board_of_an_earlier_result(images: Path, tmp_path: Path) -> None:
    first, second = tmp_path / "first.json", tmp_path / "second.json"
    assert calibrate(f"{images}/c-*.png", first).exit_code == 0
    again = calibrate(f"{images}/c-*.png", second, "--known-board", first)
    assert again.exit_code == 0, again.output
    boards = [np.array(json.loads(p.read_text())["board_corners_mm"]) for p in (first, second)]
    assert np.abs(boards[0] - boards[1]).max() < 5e-3
    other = calibrate(f"{images}/c-*.png", second, "--known-board", first, "--square-mm", "9")
    assert isinstance(other.exception, KnownBoardDiffers)
    cut = tmp_path / "cut.json"
    cut.write_text('{"board": {}}')
    for path, words in ((cut, "holds no board"), (tmp_path / "none.json", "No such file")):
        result = calibrate(f"{images}/c-*.png", second, "--known-board", path)
        assert isinstance(result.exception, FileInvalid)
        assert words in str(result.exception)


SAMPLES = Path(__file__).parents[4] / "config" / "samples" / "board"


def of_samples(pattern: str, out: Path) -> Result:
    # With shape and lens given: to choose them takes five more calibrations.
    arguments = ("camera", "--images", pattern, "--board", "9x6", "--square-mm", 20, "--out", out,
                 "--board-shape", "bent", "--lens", "five")  # fmt: skip
    return CliRunner().invoke(app, [str(one) for one in arguments])


def test_images_named_left_and_right_are_of_two_cameras(tmp_path: Path) -> None:
    fault = of_samples(f"{SAMPLES}/*.png", tmp_path / "cam.json").exception
    assert isinstance(fault, FileInvalid)
    assert "left-01.png and right-01.png are named as of two cameras" in str(fault)


def test_images_of_both_cameras_of_a_head_are_not_accepted(tmp_path: Path) -> None:
    # Both cameras are nearly alike, so that one fits them all with small residuals.
    for number, path in enumerate(sorted(SAMPLES.glob("*.png"))):
        shutil.copy(path, tmp_path / f"image-{number:02d}.png")
    mixed = of_samples(f"{tmp_path}/image-*.png", tmp_path / "cam.json")
    assert mixed.exit_code == 3, mixed.output
    said = "views in pairs, as of the two cameras of a head"
    assert f"{said} 1 (≤ 0.5): OUT OF LIMIT" in mixed.output
    alone = of_samples(f"{SAMPLES}/left-*.png", tmp_path / "left.json")
    assert f"{said} 0 (≤ 0.5): ok" in alone.output
