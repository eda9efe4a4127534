"""`cellctl calibrate`: the calibrations of Maintenance mode, from files.

Exit code 3 when a result was found but is beyond its limits; it is written all the same.
"""

import glob
import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Protocol

import numpy as np
import typer
from rich.console import Console

from cellctl.calibration.boards.board import BoardShape, CalibrationBoard, Charuco
from cellctl.calibration.boards.board_images import (
    BoardImage,
    BoardImages,
    detect_camera_views,
    detect_views,
)
from cellctl.calibration.checks import Checks
from cellctl.calibration.input_file import read_input
from cellctl.calibration.output_file import write_file
from cellctl.calibration.solvers.base_frame.base_frame import calibrate_base_frame
from cellctl.calibration.solvers.base_frame.base_frame_input import BaseFrameFile
from cellctl.calibration.solvers.base_frame.base_frame_picture import base_frame_picture
from cellctl.calibration.solvers.hand_eye.hand_eye import calibrate_hand_eye
from cellctl.calibration.solvers.hand_eye.hand_eye_input import HandEyeFile
from cellctl.calibration.solvers.hand_eye.hand_eye_picture import hand_eye_picture
from cellctl.calibration.solvers.hand_eye.hand_eye_result import Setup
from cellctl.calibration.solvers.shape_choice import with_chosen_shape
from cellctl.calibration.solvers.single_camera.single_camera_calibration import (
    calibrate_single_camera,
)
from cellctl.calibration.solvers.single_camera.single_camera_picture import single_camera_picture
from cellctl.calibration.solvers.single_camera.single_camera_result import SingleCameraResult
from cellctl.calibration.solvers.stereo.stereo import calibrate_stereo
from cellctl.calibration.solvers.stereo.stereo_limits import KnownGeometry, StereoLimits
from cellctl.calibration.solvers.stereo.stereo_picture import stereo_picture
from cellctl.calibration.solvers.stereo.stereo_result import StereoResult
from cellctl.calibration.solvers.tool.tool import calibrate_tool
from cellctl.calibration.solvers.tool.tool_input import ToolFile
from cellctl.calibration.solvers.tool.tool_picture import tool_picture
from cellctl.calibration.solvers.transfer.board_transfer import calibrate_board_transfer
from cellctl.calibration.solvers.transfer.transfer_input import TransferFile
from cellctl.calibration.solvers.transfer.transfer_picture import transfer_picture
from cellctl.cli.invalidate import invalidate
from cellctl.cli.offline.measure import read_image
from cellctl.cli.seal_calibrations import seal
from cellctl.errors.config import FileInvalid
from cellctl.geometry.pose import MM, pose_to_xyzabc
from cellctl.geometry.uncertain import UncertainPose

NOT_PASSED = 3
"""Exit code when a figure of the result is beyond its limit."""

app = typer.Typer(help="Calibrate from files.", no_args_is_help=True, rich_markup_mode=None)

app.command("invalidate")(invalidate)
app.command("seal")(seal)

InFile = Annotated[Path, typer.Option("--in", help="Input file, see docs/calibration.md.")]
OutFile = Annotated[Path | None, typer.Option("--out", help="Write the result to this JSON file.")]
Picture = Annotated[Path | None, typer.Option(help="Write the evidence as PNG.")]
BoardSize = Annotated[str, typer.Option(help="Inner corners, columns x rows, such as 9x6.")]
SquareSide = Annotated[float, typer.Option(help="Side of a square, mm.", min=1.0, max=500.0)]
KnownBaseline = Annotated[
    float | None, typer.Option(help="Distance of the cameras by the drawing, within 5 %.", min=1.0)
]
KnownDistance = Annotated[
    float | None, typer.Option(help="Typical distance of the board, within 5 %.", min=1.0)
]
KnownFocal = Annotated[
    float | None,
    typer.Option(help="Focal length over size of a pixel, by the data sheets.", min=1.0),
]
Shape = Annotated[
    BoardShape | None,
    typer.Option(help="What may deviate from the drawing of the board; else the data decide."),
]


class CalibrationResult(Protocol):
    """The members that the results of all calibrations have."""

    @property
    def checks(self) -> Checks:
        """Figures against limits."""

    @property
    def passed(self) -> bool:
        """The verdict."""

    def to_record(self) -> dict[str, object]:
        """Plain data."""


@app.command("stereo")
def stereo(
    *,
    left: Annotated[str, typer.Option(help="Left images, a pattern such as 'left-*.png'.")],
    right: Annotated[str, typer.Option(help="Right images, in the same order by name.")],
    board: BoardSize,
    square_mm: SquareSide,
    out: Annotated[Path, typer.Option(help="Write the calibration to this JSON file.")],
    charuco: Annotated[
        str | None, typer.Option(help="Markers of a ChArUco board, such as 5X5_100.")
    ] = None,
    marker_mm: Annotated[float | None, typer.Option(help="Side of a ChArUco marker.")] = None,
    board_shape: Shape = None,
    baseline_mm: KnownBaseline = None,
    distance_mm: KnownDistance = None,
    focal_px: KnownFocal = None,
    picture: Picture = None,
) -> None:
    """Calibrate a stereo head from pairs of images of a chessboard or ChArUco board.

    What is known of the head is compared with the result: the images alone cannot tell the size of
    the squares.
    """
    pattern = _board(board, square_mm, charuco, marker_mm)
    found = detect_views(_pairs(left, right), pattern)
    console = _console()
    _say_left_out(console, found.not_found)
    known = KnownGeometry(_metres(baseline_mm), _metres(distance_mm), focal_px)
    limits = StereoLimits(known=known)

    def calibrated(shape: BoardShape) -> StereoResult:
        return calibrate_stereo(found.views, pattern, found.image_size, shape=shape, limits=limits)

    result = (
        with_chosen_shape(calibrated, lambda one: one.held_out_m)
        if board_shape is None
        else calibrated(board_shape)
    )
    console.print(result.method, markup=False)
    for view in result.views:
        rms = f"{view.left_rms_px:.3f} px left, {view.right_rms_px:.3f} px right"
        console.print(f"  {view.name}: {rms}{_weight(view.shift_sigmas)}", markup=False)
    baseline_mm = float(np.linalg.norm(result.head.translation_m)) / MM
    console.print(f"baseline {baseline_mm:.4f} mm; board flat to {result.flatness_m / MM:.3f} mm")
    unchecked = f"nothing tells whether squares of {square_mm:g} mm are right: give "
    unchecked += "--baseline-mm or --distance-mm"
    warnings = result.warnings if known.tells_scale else (*result.warnings, unchecked)
    _finish(result, warnings, out, picture, lambda: stereo_picture(result))


def _metres(length_mm: float | None) -> float | None:
    return None if length_mm is None else length_mm * MM


def _weight(shift_sigmas: float | None) -> str:
    """What a view counts in the result."""
    if shift_sigmas is None:
        return "  LEFT OUT"
    return f", without it the result moves by {shift_sigmas:.2f} sigma"


@app.command("camera")
def camera(
    *,
    images: Annotated[str, typer.Option(help="Images, a pattern such as 'c2-*.png'.")],
    board: BoardSize,
    square_mm: SquareSide,
    out: Annotated[Path, typer.Option(help="Write the calibration to this JSON file.")],
    board_shape: Shape = None,
    picture: Picture = None,
) -> None:
    """Calibrate a single camera from images of a chessboard."""
    pattern = _board(board, square_mm, None, None)
    named = [BoardImage(path.stem, read_image(path)) for path in _matching(images)]
    found = detect_camera_views(named, pattern)
    console = _console()
    _say_left_out(console, found.not_found)

    def calibrated(shape: BoardShape) -> SingleCameraResult:
        return calibrate_single_camera(found.views, pattern, found.image_size, shape=shape)

    result = (
        with_chosen_shape(calibrated, lambda one: one.held_out_px)
        if board_shape is None
        else calibrated(board_shape)
    )
    console.print(result.method, markup=False)
    for view in result.views:
        weight = _weight(view.shift_sigmas)
        console.print(f"  {view.name}: {view.rms_px:.3f} px{weight}", markup=False)
    matrix, sigma = result.camera.model.camera_matrix, result.sigma
    for name, value, one in (
        ("focal length", (matrix[0, 0], matrix[1, 1]), sigma[:2]),
        ("principal point", (matrix[0, 2], matrix[1, 2]), sigma[2:4]),
    ):
        console.print(
            f"{name} {value[0]:.2f}, {value[1]:.2f} px, sigma {one[0]:.2f}, {one[1]:.2f} px"
        )
    console.print(f"board flat to {result.flatness_m / MM:.4f} mm; id {result.camera.id}")
    _finish(result, result.warnings, out, picture, lambda: single_camera_picture(result))


@app.command("hand-eye")
def hand_eye(
    file: InFile,
    setup: Annotated[Setup | None, typer.Option(help="Overrides the setup in the file.")] = None,
    out: OutFile = None,
    picture: Picture = None,
) -> None:
    """Camera on the flange (AX = XB) or beside the robot (CG = GD), from poses."""
    data = read_input(file, HandEyeFile)
    chosen = setup or data.setup
    if chosen is None:
        raise FileInvalid(f"{file}: missing 'setup'; give --setup eye-in-hand or eye-to-hand")
    result = replace(
        calibrate_hand_eye(data.stops(), chosen, noise=data.robot_noise()),
        camera_id=data.camera_id,
    )
    console = _console()
    for name, (distance_m, angle_rad) in result.residuals.items():
        mark = "  LEFT OUT" if name in result.rejected else ""
        residual = f"{distance_m / MM:.3f} mm, {np.degrees(angle_rad):.4f}°"
        console.print(f"  {name}: {residual}{mark}", markup=False)
    in_hand = chosen is Setup.EYE_IN_HAND
    _show("flange_T_camera" if in_hand else "base_T_camera", result.camera)
    _show("base_T_board" if in_hand else "flange_T_board", result.board)
    _finish(result, result.warnings, out, picture, lambda: hand_eye_picture(result))


@app.command("base-frame")
def base_frame(file: InFile, out: OutFile = None, picture: Picture = None) -> None:
    """Base of the robot in the large-field head, from turning A1 and A2."""
    data = read_input(file, BaseFrameFile)
    a1_stops, a2_stops = ([entry.stop() for entry in axis] for axis in (data.a1, data.a2))
    result = calibrate_base_frame(a1_stops, a2_stops, data.arm())
    _show("C_T_B", result.c_T_base)
    _finish(result, result.warnings, out, picture, lambda: base_frame_picture(result))


@app.command("transfer")
def transfer(file: InFile, out: OutFile = None, picture: Picture = None) -> None:
    """Heads I and II in the base by the target board (equations 1 to 3)."""
    data = read_input(file, TransferFile)
    before_head_1, before_head_2 = (data.placements(one) for one in (data.head_1, data.head_2))
    result = calibrate_board_transfer(data.base(), before_head_1, before_head_2)
    _show("B_T_C1", result.base_T_c1)
    _show("B_T_C2", result.base_T_c2)
    _show("C1_T_C2", result.c1_T_c2)
    _finish(result, result.warnings, out, picture, lambda: transfer_picture(result))


@app.command("tool")
def tool(file: InFile, out: OutFile = None, picture: Picture = None) -> None:
    """Tool on the flange: four-point method, and three-point method if the file has it."""
    data = read_input(file, ToolFile)
    result = calibrate_tool(data.touching, data.orienting or (), touch_sigma_m=data.touch_sigma_m)
    _show("flange_T_tool", result.flange_T_tool)
    _finish(result, (), out, picture, lambda: tool_picture(result))


def _board(
    corners: str, square_mm: float, charuco: str | None, marker_mm: float | None
) -> CalibrationBoard:
    try:
        columns, rows = (int(part) for part in corners.lower().split("x"))
        markers = None
        if charuco is not None:
            if marker_mm is None or not 0 < marker_mm < square_mm:
                raise ValueError("--charuco needs --marker-mm below --square-mm")  # noqa: TRY301
            markers = Charuco(charuco.upper().removeprefix("DICT_"), marker_mm * MM)
        return CalibrationBoard(columns, rows, square_mm * MM, markers)
    except ValueError as error:
        raise typer.BadParameter(f"board {corners!r}: {error}") from error


def _pairs(left: str, right: str) -> list[BoardImages]:
    names = [_matching(pattern) for pattern in (left, right)]
    # One missing image would shift every later pair by one.
    if len(names[0]) != len(names[1]):
        raise FileInvalid(f"{len(names[0])} left but {len(names[1])} right images")
    return [
        BoardImages(one.stem, read_image(one), read_image(other))
        for one, other in zip(*names, strict=True)
    ]


def _matching(pattern: str) -> list[Path]:
    # Expanded here, not by the shell: one option takes one value, and lists must be in one order.
    found = sorted(glob.glob(pattern))
    if not found:
        raise FileInvalid(f"no file matches {pattern}")
    return [Path(one) for one in found]


def _say_left_out(console: Console, not_found: Sequence[str]) -> None:
    if not_found:
        console.print(f"board not found, left out: {', '.join(not_found)}", markup=False)


def _console() -> Console:
    return Console(soft_wrap=True, highlight=False)


def _show(name: str, pose: UncertainPose) -> None:
    x, y, z, a, b, c = pose_to_xyzabc(pose.pose)
    sigma = pose.sigma
    _console().print(
        f"{name}: X {x:.4f}, Y {y:.4f}, Z {z:.4f} mm, A {a:.5f}, B {b:.5f}, C {c:.5f}°; "
        f"sigma {sigma[:3].max() / MM:.4f} mm, {np.degrees(sigma[3:].max()):.5f}°",
        markup=False,
    )


def _finish(
    result: CalibrationResult,
    warnings: tuple[str, ...],
    out: Path | None,
    picture: Path | None,
    draw: Callable[[], bytes],
) -> None:
    """Print the checks, write the files, and leave with the verdict as exit code."""
    console = _console()
    for check in result.checks:
        console.print(f"  {'ok  ' if check.passed else 'FAIL'}  {check}", markup=False)
    for warning in warnings:
        console.print(f"  warning: {warning}", markup=False)
    # Also when it did not pass: the figures show why, and the exit code keeps a script from using
    # it.
    if out is not None:
        write_file(out, json.dumps(result.to_record(), indent=2).encode() + b"\n")
    if picture is not None:
        write_file(picture, draw())
    console.print("passed" if result.passed else "NOT passed")
    if not result.passed:
        raise typer.Exit(NOT_PASSED)
