"""``cellctl calibrate stereo`` and ``cellctl calibrate camera``: from images of a board."""

import glob
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console

from cellctl.calibration.boards.board_images import (
    BoardImage,
    BoardImages,
    detect_camera_views,
    detect_views,
)
from cellctl.calibration.boards.board_shape import BoardShape
from cellctl.calibration.boards.lens_model import LensModel
from cellctl.calibration.solvers.lens_choice import chosen_lens
from cellctl.calibration.solvers.shape_choice import R, with_chosen_shape
from cellctl.calibration.solvers.single_camera.single_camera_calibration import (
    calibrate_single_camera,
)
from cellctl.calibration.solvers.single_camera.single_camera_picture import single_camera_picture
from cellctl.calibration.solvers.single_camera.single_camera_result import SingleCameraResult
from cellctl.calibration.solvers.stereo.stereo import calibrate_stereo
from cellctl.calibration.solvers.stereo.stereo_limits import KnownGeometry, StereoLimits
from cellctl.calibration.solvers.stereo.stereo_picture import stereo_picture
from cellctl.calibration.solvers.stereo.stereo_result import StereoResult
from cellctl.cli.offline.board_options import (
    Asymmetric,
    BoardSize,
    CharucoMarkers,
    CircleDiameter,
    KnownBoardFile,
    MarkerSide,
    SquareSide,
    board_of,
    read_known_board,
)
from cellctl.cli.offline.calibration_output import Picture, finish
from cellctl.cli.offline.measure import read_image
from cellctl.errors.config import FileInvalid
from cellctl.geometry.pose import MM
from cellctl.terminal.consoles import console_of_lines, print_hanging

Shape = Annotated[
    BoardShape | None,
    typer.Option(help="What may deviate from the drawing of the board; else the data decide."),
]
Lens = Annotated[LensModel | None, typer.Option(help="Terms of the lens; else the data decide.")]
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


def stereo(
    *,
    left: Annotated[str, typer.Option(help="Left images, a pattern such as 'left-*.png'.")],
    right: Annotated[str, typer.Option(help="Right images, in the same order by name.")],
    board: BoardSize,
    square_mm: SquareSide,
    out: Annotated[Path, typer.Option(help="Write the calibration to this JSON file.")],
    charuco: CharucoMarkers = None,
    marker_mm: MarkerSide = None,
    circle_mm: CircleDiameter = None,
    asymmetric: Asymmetric = False,
    board_shape: Shape = None,
    known_board: KnownBoardFile = None,
    lens: Lens = None,
    baseline_mm: KnownBaseline = None,
    distance_mm: KnownDistance = None,
    focal_px: KnownFocal = None,
    picture: Picture = None,
) -> None:
    """Calibrate a stereo head from pairs of images of a chessboard, ChArUco board or circle grid.

    What is known of the head is compared with the result: the images alone cannot tell the size of
    the squares.
    """
    pattern = board_of(board, square_mm, charuco, marker_mm, circle_mm, asymmetric=asymmetric)
    earlier = None if known_board is None else read_known_board(known_board)
    found = detect_views(_pairs(left, right), pattern)
    console = console_of_lines()
    _say_left_out(console, found.not_found)
    known = KnownGeometry(_metres(baseline_mm), _metres(distance_mm), focal_px)
    limits = StereoLimits(known=known)

    @cache
    def calibrated(shape: BoardShape, model: LensModel) -> StereoResult:
        return calibrate_stereo(
            found.views,
            pattern,
            found.image_size,
            shape=shape,
            known=earlier,
            lens=model,
            limits=limits,
        )

    result = _chosen(calibrated, lambda one: one.held_out_m, board_shape, lens)
    print_hanging(console, result.method, 2)
    for view in result.views:
        rms = f"{view.left_rms_px:.3f} px left, {view.right_rms_px:.3f} px right"
        print_hanging(console, f"  {view.name}: {rms}{_weight(view.shift_sigmas)}", 4)
    baseline_mm = float(np.linalg.norm(result.head.translation_m)) / MM
    console.print(f"baseline {baseline_mm:.4f} mm; board flat to {result.flatness_m / MM:.3f} mm")
    unchecked = f"nothing tells whether squares of {square_mm:g} mm are right: give "
    unchecked += "--baseline-mm or --distance-mm"
    warnings = result.warnings if known.tells_scale else (*result.warnings, unchecked)
    finish(result, warnings, out, picture, lambda: stereo_picture(result))


def camera(
    *,
    images: Annotated[str, typer.Option(help="Images, a pattern such as 'c2-*.png'.")],
    board: BoardSize,
    square_mm: SquareSide,
    out: Annotated[Path, typer.Option(help="Write the calibration to this JSON file.")],
    charuco: CharucoMarkers = None,
    marker_mm: MarkerSide = None,
    circle_mm: CircleDiameter = None,
    asymmetric: Asymmetric = False,
    board_shape: Shape = None,
    known_board: KnownBoardFile = None,
    lens: Lens = None,
    picture: Picture = None,
) -> None:
    """Calibrate a single camera from images of a chessboard, ChArUco board or circle grid."""
    pattern = board_of(board, square_mm, charuco, marker_mm, circle_mm, asymmetric=asymmetric)
    earlier = None if known_board is None else read_known_board(known_board)
    paths = _matching(images)
    _require_one_camera(paths)
    named = [BoardImage(path.stem, read_image(path)) for path in paths]
    found = detect_camera_views(named, pattern)
    console = console_of_lines()
    _say_left_out(console, found.not_found)

    @cache
    def calibrated(shape: BoardShape, model: LensModel) -> SingleCameraResult:
        return calibrate_single_camera(
            found.views, pattern, found.image_size, shape=shape, known=earlier, lens=model
        )

    result = _chosen(calibrated, lambda one: one.held_out_px, board_shape, lens)
    print_hanging(console, result.method, 2)
    for view in result.views:
        weight = _weight(view.shift_sigmas)
        print_hanging(console, f"  {view.name}: {view.rms_px:.3f} px{weight}", 4)
    matrix, sigma = result.camera.model.camera_matrix, result.sigma
    for name, value, one in (
        ("focal length", (matrix[0, 0], matrix[1, 1]), sigma[:2]),
        ("principal point", (matrix[0, 2], matrix[1, 2]), sigma[2:4]),
    ):
        console.print(
            f"{name} {value[0]:.2f}, {value[1]:.2f} px, sigma {one[0]:.2f}, {one[1]:.2f} px"
        )
    identity = f"board flat to {result.flatness_m / MM:.4f} mm; id {result.camera.id}"
    print_hanging(console, identity, 2)
    finish(result, result.warnings, out, picture, lambda: single_camera_picture(result))


def _chosen(
    calibrate: Callable[[BoardShape, LensModel], R],
    held_out: Callable[[R], float | None],
    shape: BoardShape | None,
    lens: LensModel | None,
) -> R:
    """The calibration with shape and lens as they were given, else as the data ask for."""
    why = ""
    if lens is None:
        bent = shape or BoardShape.BENT
        lens, why = chosen_lens(lambda model: calibrate(bent, model), held_out)
        why = f"; {why}"
    model = lens
    result = (
        with_chosen_shape(lambda one: calibrate(one, model), held_out)
        if shape is None
        else calibrate(shape, model)
    )
    return replace(result, method=f"{result.method}{why}")


def _metres(length_mm: float | None) -> float | None:
    return None if length_mm is None else length_mm * MM


def _weight(shift_sigmas: float | None) -> str:
    """What a view counts in the result."""
    if shift_sigmas is None:
        return "  LEFT OUT"
    return f", without it the result moves by {shift_sigmas:.2f} sigma"


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
    if folders := [one for one in found if Path(one).is_dir()]:
        raise FileInvalid(
            f"{folders[0]} is a folder: give a pattern of the images in it, such as "
            f"'{folders[0]}/*.png', in quotes"
        )
    return [Path(one) for one in found]


def _require_one_camera(paths: Sequence[Path]) -> None:
    """Images that are named as left and right ones are of two cameras."""
    left = {path.stem.lower().replace("left", "", 1): path for path in paths if _says(path, "left")}
    for path in paths:
        other = left.get(path.stem.lower().replace("right", "", 1))
        if other is not None and _says(path, "right"):
            raise FileInvalid(
                f"{other.name} and {path.name} are named as of two cameras: narrow --images to "
                "those of one, or rename them if left and right are places of the board"
            )


def _says(path: Path, side: str) -> bool:
    return side in path.stem.lower()


def _say_left_out(console: Console, not_found: Sequence[str]) -> None:
    if not_found:
        print_hanging(console, f"board not found, left out: {'; '.join(not_found)}", 2)
