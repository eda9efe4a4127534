"""`cellctl calibrate …` from files, as a user would call it."""

import json
from itertools import product
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform
from typer.testing import CliRunner, Result

from cellctl.calibration.pose_record import covariance_to_written
from cellctl.calibration.solvers.base_frame.axis_fit import AxisStop
from cellctl.calibration.solvers.hand_eye.hand_eye_result import HandEyeResult, Setup
from cellctl.cli.offline.calibrate import app
from cellctl.errors.calibration import (
    BoardPoseInvalid,
    CalibrationCamerasSwapped,
    PosesNotDiverse,
    RobotCameraMismatch,
    WrongBoard,
)
from cellctl.errors.config import FileInvalid
from cellctl.geometry.pose import MM, pose_from_xyzabc, pose_to_xyzabc
from cellctl.vision.camera.lens import project
from cellctl.vision.camera.stereo_head import CameraModel, read_stereo_head
from fakes.render import api
from fakes.world.scene import LensTruth, SceneChessboard, StereoTruth
from tests.rigs.calibration import board_placements as transfer_case
from tests.rigs.calibration import hand_eye_views as hand_eye_case
from tests.rigs.calibration import tool_touches as tool_case
from tests.rigs.calibration import turned_arm as base_frame_case
from tests.rigs.sweeps import sweep


def call(*arguments: object) -> Result:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def written(pose: RigidTransform) -> list[float]:
    numbers: list[float] = pose_to_xyzabc(pose).tolist()
    return numbers


def save(path: Path, data: object) -> Path:
    path.write_text(json.dumps(data))
    return path


def hand_eye_file(folder: Path, **extra: Any) -> Path:
    poses = hand_eye_case.make_poses(0, Setup.EYE_IN_HAND)
    entries = [
        {
            "base_T_flange": written(pose.base_T_flange),
            "camera_T_board": written(pose.camera_T_board.pose),
            "covariance_mm_deg": covariance_to_written(pose.camera_T_board.covariance).tolist(),
        }
        for pose in poses
    ]
    return save(folder / "he.json", {"setup": "eye-in-hand", "poses": entries, **extra})


def test_hand_eye(tmp_path: Path) -> None:
    out, picture = tmp_path / "out.json", tmp_path / "he.png"
    file = hand_eye_file(tmp_path, camera_id="ab12")
    result = call("hand-eye", "--in", file, "--out", out, "--picture", picture)
    assert result.exit_code == 0, result.output
    assert "flange_T_camera: X 6" in result.output
    record = json.loads(out.read_text())
    assert record["camera_id"] == HandEyeResult.from_record(record).camera_id == "ab12"
    matrix = np.array(record["flange_T_camera"]["matrix_mm"])
    truth = hand_eye_case.FLANGE_T_CAMERA
    assert np.abs(matrix[:3, 3] - truth.translation / MM).max() < 0.3
    assert picture.read_bytes().startswith(b"\x89PNG")


HAND_EYE = Path(__file__).parents[4] / "config" / "samples" / "hand-eye.json"


def test_poses_of_a_hand_eye_calibration_that_are_all_inverted_do_not_pass(tmp_path: Path) -> None:
    """They fit as well as the right ones, with the camera where the board is."""
    data = json.loads(HAND_EYE.read_text())
    for entry in data["poses"]:
        for key in ("base_T_flange", "camera_T_board"):
            entry[key] = written(pose_from_xyzabc(entry[key]).inv())
        del entry["covariance_mm_deg"]
    out = tmp_path / "out.json"
    result = call("hand-eye", "--in", save(tmp_path / "inverted.json", data), "--out", out)
    assert result.exit_code == 3
    assert "FAIL  camera from the flange, less than the board from the base 1517 mm" in (
        result.output
    )
    assert (
        "Are all poses inverted (flange_T_base and board_T_camera)? Then the camera is 110 mm from "
        "the flange and the board 1517 mm from the base"
    ) in result.output
    assert "all poses inverted" in json.loads(out.read_text())["warnings"][0]


@pytest.mark.parametrize(
    "more_terms",
    [(), (0.3, 0.1, 0.0), (0.3, 0.1, 0.0, 5e-3, 0.0, -4e-3, 0.0, 0.02, -0.03)],
    ids=len,
)
def test_hand_eye_from_corners(tmp_path: Path, more_terms: tuple[float, ...]) -> None:
    plain = hand_eye_case.CAMERA
    camera = CameraModel(plain.camera_matrix, np.array([*plain.distortion, *more_terms]))
    rng = np.random.default_rng(5)
    entries = []
    for _ in range(12):
        seen = hand_eye_case.random_view(rng)
        flange = hand_eye_case.BASE_T_BOARD * seen.inv() * hand_eye_case.FLANGE_T_CAMERA.inv()
        pixels = project(camera, seen.apply(hand_eye_case.BOARD_M))
        noisy = pixels + rng.normal(0, 0.1, pixels.shape)
        matrix = flange.as_matrix()
        matrix[:3, 3] /= MM
        entries.append({"base_T_flange": matrix.tolist(), "corners_px": noisy.tolist()})
    data = {
        "setup": "eye-in-hand",
        "camera": {
            "camera_matrix": camera.camera_matrix.tolist(),
            "distortion": camera.distortion.tolist(),
        },
        "board_points_mm": (hand_eye_case.BOARD_M / MM).tolist(),
        "poses": entries,
    }
    result = call("hand-eye", "--in", save(tmp_path / "he.json", data))
    assert result.exit_code == 0, result.output


def test_setup_option_overrides_the_file(tmp_path: Path) -> None:
    result = call("hand-eye", "--in", hand_eye_file(tmp_path), "--setup", "eye-to-hand")
    assert result.exit_code == 1
    assert "the data fit eye-in-hand" in str(result.exception)


@pytest.mark.parametrize(
    ("setup", "missing"),
    sweep(product(Setup, (0, 5, 10)), ((Setup.EYE_IN_HAND, 5), (Setup.EYE_TO_HAND, 0))),
)
def test_images_paired_with_the_poses_of_their_neighbours(
    tmp_path: Path, setup: Setup, missing: int
) -> None:
    """A board that was not found in one image, and all later ones written one line too early."""
    poses = hand_eye_case.make_poses(1, setup)
    seen = [pose.camera_T_board.pose for pose in poses]
    del seen[missing]
    entries = [
        {"base_T_flange": written(pose.base_T_flange), "camera_T_board": written(board)}
        for pose, board in zip(poses[:-1], seen, strict=True)
    ]
    out = tmp_path / "he.json"
    data = {"setup": setup.value, "poses": entries}
    result = call("hand-eye", "--in", save(tmp_path / "in.json", data), "--out", out)
    assert isinstance(result.exception, RobotCameraMismatch)
    assert not out.exists()


def stops(axis: list[AxisStop]) -> list[dict[str, Any]]:
    return [
        {
            "joints_deg": np.degrees(stop.joints_rad).tolist(),
            "targets": [
                {"name": t.name, "position_mm": (t.position_m / MM).tolist(), "sigma_mm": 0.05}
                for t in stop.targets
            ],
        }
        for stop in axis
    ]


def base_frame_file(folder: Path, **extra: Any) -> Path:
    rng = np.random.default_rng(0)
    first, second = (stops(base_frame_case.sweep(rng, joint, 100)) for joint in (0, 1))
    data = {"d1_mm": 1045, "a1_mm": 500, "a1": first, "a2": second, **extra}
    return save(folder / "bf.json", data)


def test_base_frame(tmp_path: Path) -> None:
    out = tmp_path / "out.json"
    result = call("base-frame", "--in", base_frame_file(tmp_path), "--out", out)
    assert result.exit_code == 0, result.output
    assert json.loads(out.read_text())["verdict"] == "pass"


def test_result_beyond_its_limits_is_written_with_exit_code_3(tmp_path: Path) -> None:
    out = tmp_path / "out.json"
    result = call("base-frame", "--in", base_frame_file(tmp_path, a1_mm=450), "--out", out)
    assert result.exit_code == 3
    assert "FAIL  a1 against D-H 50" in result.output
    assert json.loads(out.read_text())["verdict"] == "fail"


@pytest.mark.parametrize("metres", [{"d1_mm": 1.045}, {"a1_mm": -0.5}])
def test_links_that_are_none_are_refused(tmp_path: Path, metres: dict[str, float]) -> None:
    """The stops fit with any length of the first link: nothing else would tell."""
    result = call("base-frame", "--in", base_frame_file(tmp_path, **metres))
    assert isinstance(result.exception, FileInvalid)
    assert next(iter(metres)) in str(result.exception)


@pytest.mark.parametrize(
    ("mistake", "said"),
    [
        ({"a1_sign": -1}, "a1_sign = 1"),
        pytest.param({"a2_sign": -1}, "a2_sign = 1", marks=pytest.mark.figures),
        pytest.param(
            {"d1_mm": 500, "a1_mm": 1045},
            "d1_mm and a1_mm are exchanged",
            marks=pytest.mark.figures,
        ),
    ],
)
def test_a_mistake_in_the_arm_is_named(
    tmp_path: Path, mistake: dict[str, float], said: str
) -> None:
    result = call("base-frame", "--in", base_frame_file(tmp_path, **mistake))
    assert result.exit_code == 3
    assert said in result.output


def test_stops_of_the_other_axis_are_named(tmp_path: Path) -> None:
    written_file = json.loads(base_frame_file(tmp_path).read_text())
    other = {"a1": written_file["a2"], "a2": written_file["a1"]}
    result = call("base-frame", "--in", base_frame_file(tmp_path, **other))
    assert isinstance(result.exception, FileInvalid)
    assert "the stops of A1 stand in a2" in str(result.exception)


def test_a_height_that_no_stop_contradicts_is_held_against_the_cell(tmp_path: Path) -> None:
    wrong = base_frame_file(tmp_path, d1_mm=1075)
    alone = call("base-frame", "--in", wrong)
    assert alone.exit_code == 0
    assert "nothing here has checked d1_mm = 1075" in alone.output
    cell = Path(__file__).parents[4] / "config" / "deck.toml"
    compared = call("base-frame", "--in", wrong, "--cell", cell)
    assert isinstance(compared.exception, FileInvalid)
    assert "main: 1045 and 500" in str(compared.exception)
    assert call("base-frame", "--in", base_frame_file(tmp_path), "--cell", cell).exit_code == 0


def discs(rng: np.random.Generator, pose: RigidTransform, sigma_m: float) -> list[dict[str, Any]]:
    points = transfer_case.board_points(rng, pose, np.full(3, sigma_m))
    return [
        {
            "name": point.name,
            "position_mm": (point.position_m / MM).tolist(),
            "sigma_mm": sigma_m / MM,
        }
        for point in points
    ]


def transfer_data() -> dict[str, Any]:
    rng = np.random.default_rng(0)
    case = transfer_case
    data: dict[str, Any] = {"c_T_base": written(case.C_T_BASE)}
    for key, base_T_head, seen in (
        ("head_1", case.BASE_T_C1, case.C1_T_BOARD),
        ("head_2", case.BASE_T_C2, case.C2_T_BOARD),
    ):
        large = discs(rng, case.C_T_BASE * base_T_head * seen, 1e-5)
        data[key] = [{"large_field": large, "head": discs(rng, seen, 2e-6)}]
    return data


def test_transfer(tmp_path: Path) -> None:
    result = call("transfer", "--in", save(tmp_path / "t.json", transfer_data()))
    assert result.exit_code == 0, result.output
    assert "C1_T_C2: X" in result.output


def test_what_a_transfer_without_the_cell_file_has_not_checked_is_kept(tmp_path: Path) -> None:
    out = tmp_path / "result.json"
    result = call("transfer", "--in", save(tmp_path / "t.json", transfer_data()), "--out", out)
    assert "warning: nothing here has checked which head is which" in result.output
    (kept,) = json.loads(out.read_text())["warnings"]
    assert "give --cell with the cell file of these heads" in kept


def test_tables_of_a_transfer_that_were_exchanged_or_copied_are_named(tmp_path: Path) -> None:
    data = transfer_data()
    (one,) = data["head_1"]
    exchanged = data | {"head_1": [{"large_field": one["head"], "head": one["large_field"]}]}
    result = call("transfer", "--in", save(tmp_path / "exchanged.json", exchanged))
    assert isinstance(result.exception, BoardPoseInvalid)
    assert "head_1, entry 1: 'large_field' and 'head' are exchanged" in str(result.exception)
    copied = data | {"head_2": data["head_1"]}
    result = call("transfer", "--in", save(tmp_path / "copied.json", copied))
    assert isinstance(result.exception, BoardPoseInvalid)
    assert "one was copied" in str(result.exception)


SAMPLE = Path(__file__).parents[4] / "config" / "samples" / "transfer.json"


def test_exchanged_heads_of_a_transfer_are_named_with_the_cell_file(tmp_path: Path) -> None:
    cell = ("--cell", SAMPLE.parents[1] / "deck.toml")
    assert "which head is which" in call("transfer", "--in", SAMPLE).output
    right = call("transfer", "--in", SAMPLE, *cell)
    assert right.exit_code == 0, right.output
    assert "which head is which" not in right.output
    data = json.loads(SAMPLE.read_text())
    data["head_1"], data["head_2"] = data["head_2"], data["head_1"]
    result = call("transfer", "--in", save(tmp_path / "exchanged.json", data), *cell)
    assert isinstance(result.exception, FileInvalid)
    assert "head_1 and head_2 are exchanged?" in str(result.exception)


def test_a_transfer_in_the_base_of_another_robot_is_named(tmp_path: Path) -> None:
    data = json.loads(SAMPLE.read_text())
    data["c_T_base"][0] += 1000.0
    cell = ("--cell", SAMPLE.parents[1] / "deck.toml")
    result = call("transfer", "--in", save(tmp_path / "elsewhere.json", data), *cell)
    assert isinstance(result.exception, FileInvalid)
    assert "is c_T_base of this robot" in str(result.exception)


def test_an_inverted_base_of_a_transfer_is_named(tmp_path: Path) -> None:
    data = json.loads(SAMPLE.read_text())
    data["c_T_base"] = written(pose_from_xyzabc(data["c_T_base"]).inv())
    file = save(tmp_path / "inverted.json", data)
    alone = call("transfer", "--in", file)
    assert alone.exit_code == 3
    assert (
        "FAIL  least x and z of the heads in the base (c_T_base may be its inverse" in alone.output
    )
    assert "nor beyond doubt that c_T_base is not its inverse" in alone.output
    cell = ("--cell", SAMPLE.parents[1] / "deck.toml")
    result = call("transfer", "--in", file, *cell)
    assert isinstance(result.exception, FileInvalid)
    assert "c_T_base is inverted (base_T_c)?" in str(result.exception)


def tool_data() -> dict[str, Any]:
    rng = np.random.default_rng(0)
    return {
        "touching": [written(pose) for pose in tool_case.touching(rng, 6, 5e-5)],
        "orienting": [written(pose) for pose in tool_case.orienting(rng, 5e-5)],
    }


def test_touches_that_do_not_fit_are_named(tmp_path: Path) -> None:
    data = tool_data()
    data["touching"][2][0] += 5.0
    result = call("tool", "--in", save(tmp_path / "tool.json", data))
    assert result.exit_code == 3
    assert "touching, entry 3 does not fit the others" in result.output


def test_inverted_poses_of_a_tool_are_named(tmp_path: Path) -> None:
    """They meet in one point as well as good ones: no residual shows them."""
    touching = tool_case.touching(np.random.default_rng(0), 6, 5e-5)
    data = {"touching": [written(pose.inv()) for pose in touching]}
    result = call("tool", "--in", save(tmp_path / "tool.json", data))
    assert "the poses are inverted (flange_T_base)?" in result.output
    assert "FAIL  tip from the flange" in result.output
    assert "NOT passed" in result.output
    assert result.exit_code == 3
    assert "inverted" not in call("tool", "--in", save(tmp_path / "t.json", tool_data())).output


def test_a_flange_that_only_turns_touches_nothing(tmp_path: Path) -> None:
    data = tool_data()
    for pose in data["touching"]:
        pose[:3] = data["touching"][0][:3]
    result = call("tool", "--in", save(tmp_path / "tool.json", data))
    assert isinstance(result.exception, PosesNotDiverse)
    assert "only turns" in str(result.exception)


def test_orienting_poses_in_the_other_order_are_named(tmp_path: Path) -> None:
    data = tool_data()
    data["orienting"] = [data["orienting"][index] for index in (0, 2, 1)]
    result = call("tool", "--in", save(tmp_path / "tool.json", data))
    assert "the second and the third of the orienting poses exchanged" in result.output
    assert "FAIL  z of the tool from the way out to its tip" in result.output
    assert "does not fit the others" not in result.output, "the touches are good"
    assert result.exit_code == 3
    good = call("tool", "--in", save(tmp_path / "good.json", tool_data()))
    assert good.exit_code == 0
    assert "ok    z of the tool from the way out to its tip" in good.output


def test_tool(tmp_path: Path) -> None:
    data = tool_data()
    picture = tmp_path / "tool.png"
    result = call("tool", "--in", save(tmp_path / "tool.json", data), "--picture", picture)
    assert result.exit_code == 0, result.output
    assert picture.exists()


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("{", "is not JSON"),
        ("[]", "one object"),
        ("{}", "missing 'poses'"),
        ('{"poses": 3}', "should be a valid array, got 3 (key 'poses')"),
        ('{"setup": "hand-in-eye", "poses": []}', "hand-in-eye"),
        ('{"poses": [{"camera_T_board": [1]}]}', "poses, entry 1: missing 'base_T_flange'"),
        ('{"poses": [{"base_T_flange": [1, 2]}]}', "entry 1: a pose is a 4 x 4 matrix"),
        ('{"poses": []}', "--setup"),
    ],
)
def test_files_that_are_wrong(tmp_path: Path, content: str, reason: str) -> None:
    path = tmp_path / "he.json"
    path.write_text(content)
    result = call("hand-eye", "--in", path)
    assert isinstance(result.exception, FileInvalid)
    assert reason in str(result.exception)


def test_file_that_is_not_there(tmp_path: Path) -> None:
    result = call("tool", "--in", tmp_path / "none.json")
    assert isinstance(result.exception, FileInvalid)
    assert "No such file" in str(result.exception)


def test_stereo_without_images(tmp_path: Path) -> None:
    pattern = tmp_path / "left-*.png"
    result = call("stereo", "--left", pattern, "--right", pattern, "--board", "9x6",
                  "--square-mm", 25, "--out", tmp_path / "o.json")  # fmt: skip
    assert isinstance(result.exception, FileInvalid)
    assert "no file matches" in str(result.exception)


@pytest.mark.parametrize("board", ["9", "9x", "axb", "2x2"])
def test_stereo_with_an_impossible_board(tmp_path: Path, board: str) -> None:
    result = call("stereo", "--left", "x", "--right", "x", "--board", board,
                  "--square-mm", 25, "--out", tmp_path / "o.json")  # fmt: skip
    assert result.exit_code == 2
    assert "board" in result.output


def half_size_head() -> StereoTruth:
    """The nominal head with every second pixel: quick to render."""
    full = api.nominal_head()
    left, right = (
        LensTruth(
            (lens.focal_px[0] / 2, lens.focal_px[1] / 2),
            (lens.centre_px[0] / 2, lens.centre_px[1] / 2),
            lens.distortion,
            lens.blur_px,
            lens.gain,
        )
        for lens in (full.left, full.right)
    )
    return StereoTruth((1224, 1024), left, right, full.right_T_left)


@pytest.fixture(scope="module")
def images(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Twelve rendered pairs of a bowed 9 x 6 board."""
    folder = tmp_path_factory.mktemp("stereo")
    head, rng = half_size_head(), np.random.default_rng(4)
    for number in range(12):
        pose = api.facing_pose(
            shift_m=(*rng.uniform(-0.04, 0.04, 2), rng.uniform(-0.03, 0.06)),
            tilt_deg=(*rng.uniform(-25, 25, 2), rng.uniform(-180, 180)),
        )
        board = SceneChessboard(pose, (9, 6), 0.02, (0.22, 0.16), (5e-5, 3e-5), 1)
        for side, image in zip(("l", "r"), api.render_pair(head, [board], rng=rng), strict=True):
            cv2.imwrite(str(folder / f"{side}-{number:02d}.png"), image)
    return folder


BENT = ("--board-shape", "bent", "--lens", "five")
"""Nothing is left for the data to decide, which takes its time."""


def stereo(images: Path, out: Path, *more: object) -> Result:
    return call("stereo", "--left", images / "l-*.png", "--right", images / "r-*.png",
                "--board", "9x6", "--square-mm", 20, "--out", out, *more)  # fmt: skip


@pytest.mark.parametrize(
    "known",
    [
        BENT,
        # Solves once for each lens and shape that it tries.
        pytest.param((), marks=pytest.mark.figures),
    ],
    ids=["known", "chosen"],
)
def test_stereo_from_images(images: Path, tmp_path: Path, known: tuple[str, ...]) -> None:
    out, picture = tmp_path / "head.json", tmp_path / "head.png"
    result = stereo(images, out, "--picture", picture, *known)
    assert result.exit_code == 0, result.output
    head, truth = read_stereo_head(out), half_size_head()
    assert head.image_size == (1224, 1024)
    assert head.rms_px < 0.08
    off = head.translation_m - truth.right_T_left.translation
    assert np.abs(off).max() < 1e-4
    assert head.covariance is not None
    assert np.sqrt(np.diag(head.covariance)[21:]).max() < 1e-4
    assert head.left.camera_matrix[0, 0] == pytest.approx(truth.left.focal_px[0], abs=2)
    data = json.loads(out.read_text())
    assert len(data["views"]) == 12
    assert data["board_flatness_mm"] < 0.15
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.figures  # solves three times; the checks themselves are tried on the solver
def test_squares_of_another_size_are_noticed_by_what_is_known(images: Path, tmp_path: Path) -> None:
    out, baseline_mm = (
        tmp_path / "head.json",
        1e3 * np.linalg.norm(half_size_head().right_T_left.translation),
    )
    known = stereo(images, out, *BENT, "--baseline-mm", baseline_mm, "--focal-px", 1790)
    assert known.exit_code == 0, known.output
    assert "nothing tells whether squares" not in known.output
    result = stereo(images, out, *BENT, "--square-mm", 25, "--baseline-mm", baseline_mm)
    assert result.exit_code == 3
    assert "FAIL  baseline against the stated one 0.25" in result.output
    silent = stereo(images, out, *BENT, "--square-mm", 25)
    assert silent.exit_code == 0
    assert "nothing tells whether squares of 25 mm are right" in silent.output


@pytest.mark.figures  # looks for boards in 22 images; each is tried on corners and board images
def test_stereo_with_images_of_something_else(images: Path, tmp_path: Path) -> None:
    out = tmp_path / "head.json"
    result = call("stereo", "--left", images / "l-0[0-2].png", "--right", images / "r-0[0-2].png",
                  "--board", "8x6", "--square-mm", 20, "--out", out)  # fmt: skip
    assert isinstance(result.exception, WrongBoard)
    result = call("stereo", "--left", images / "r-0[0-7].png", "--right", images / "l-0[0-7].png",
                  "--board", "9x6", "--square-mm", 20, "--out", out)  # fmt: skip
    assert isinstance(result.exception, CalibrationCamerasSwapped)
    assert not out.exists()


def test_stereo_with_an_image_too_few(images: Path, tmp_path: Path) -> None:
    out = tmp_path / "head.json"
    result = call("stereo", "--left", images / "l-0*.png", "--right", images / "r-*.png",
                  "--board", "9x6", "--square-mm", 20, "--out", out)  # fmt: skip
    assert "10 left but 12 right images" in str(result.exception)
    assert not out.exists()


SAMPLES = Path(__file__).parents[4] / "config" / "samples"


@pytest.mark.parametrize(("name", "width"), [("transfer", 80), ("base-frame", 60)])
def test_on_a_terminal_no_line_is_wider_than_it(name: str, width: int) -> None:
    """Into a file each thing stays one line."""
    arguments = [name, "--in", str(SAMPLES / f"{name}.json")]
    there = {"FORCE_COLOR": "1", "NO_COLOR": "1", "COLUMNS": str(width)}
    lines = CliRunner(env=there).invoke(app, arguments).output.splitlines()
    piped = CliRunner().invoke(app, arguments).output.splitlines()
    assert max(len(line) for line in piped) > width
    assert max(len(line) for line in lines) <= width
    assert " ".join(" ".join(lines).split()) == " ".join(" ".join(piped).split())
