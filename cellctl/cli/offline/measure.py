"""``cellctl measure``: measure the holes of one stereo pair of image files."""

import json
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import cv2
import numpy as np
import typer

from cellctl.calibration.output_file import write_file
from cellctl.errors.config import FileInvalid, OutputNotWritten
from cellctl.errors.vision import (
    DrawingMirrored,
    HoleAmbiguous,
    HoleMissing,
    ImageFileInvalid,
    TooFewHoles,
    VisionError,
)
from cellctl.geometry.pose import MM
from cellctl.interfaces.stereo_camera import Image
from cellctl.terminal.consoles import print_refusal, print_warning
from cellctl.vision.camera.image_file import read_unchanged
from cellctl.vision.camera.stereo_head import StereoHead, read_stereo_head
from cellctl.vision.diameters import other_diameters
from cellctl.vision.features.feature_file import FeatureFile, read_features
from cellctl.vision.features.hole import Hole
from cellctl.vision.holes.mirrored import has_mirror_image, mirrored, require_seen_face
from cellctl.vision.measure import measure_pair
from cellctl.vision.measurement import Method, PairMeasurement
from cellctl.vision.picture import annotate
from cellctl.vision.registration.part_pose import PartPose, part_pose
from cellctl.vision.registration.rigid_fit import on_a_line

_OTHER_SIZES = {2.0: "twice", 0.5: "half"}
"""Diameters over the drawn ones, as a radius in place of a diameter makes them."""
EXIT_REFUSED = 1
EXIT_NOT_FOUND = 3


def measure(  # noqa: PLR0917 - the options of the command
    calibration: Annotated[Path, typer.Option(help="Stereo calibration (JSON).")],
    features: Annotated[Path, typer.Option(help="Feature file (TOML).")],
    left: Annotated[Path, typer.Option(help="Left image file, 8 bit.")],
    right: Annotated[Path, typer.Option(help="Right image file, 8 bit.")],
    out: Annotated[Path | None, typer.Option(help="Write the result here, not to stdout.")] = None,
    method: Annotated[str, typer.Option(help="default or paper.")] = "default",
    picture: Annotated[Path | None, typer.Option(help="Write an annotated picture (PNG).")] = None,
    head: Annotated[int, typer.Option(help="Only holes of head 1 or 2; 0 for all.")] = 0,
) -> None:
    """Measure the named holes of a feature file in a stereo pair.

    Exit code 3 when a hole is missing or ambiguous, 1 for any other reason to refuse.
    """
    try:
        with warnings.catch_warnings(record=True, action="always") as notes:
            stereo_head = read_stereo_head(calibration)
        for note in notes:
            print_warning(str(note.message))
        holes = _holes(read_features(features), head)
        images = read_image(left), read_image(right)
        result = _measured(images, stereo_head, holes, _method(method))
        _require_drawn_diameters(features, result, holes)
        text = json.dumps(measurement_to_json(result, _pose(result, holes)), indent=2) + "\n"
        if picture is not None:
            write_file(picture, _picture(images, result))
        if out is not None:
            write_file(out, text.encode())
    # An exit code of its own: a script that scans many images must tell "not in the picture" from a
    # wrong file.
    except (HoleMissing, HoleAmbiguous, TooFewHoles) as fault:
        print_refusal(fault)
        raise typer.Exit(EXIT_NOT_FOUND) from fault
    except (VisionError, FileInvalid, OutputNotWritten) as fault:
        print_refusal(fault)
        raise typer.Exit(EXIT_REFUSED) from fault
    if out is None:
        typer.echo(text, nl=False)


def _measured(
    images: tuple[Image, Image], head: StereoHead, holes: tuple[Hole, ...], method: Method
) -> PairMeasurement:
    """The holes of a pair; where they are not found, whether its images were exchanged, or its
    drawing is mirrored or has radii in place of diameters."""
    if np.array_equal(*images):
        raise ImageFileInvalid("left and right are the same image")
    try:
        result = measure_pair(*images, head, holes, method=method)
    except VisionError as fault:
        if _are_found(images[::-1], head, holes, method):
            raise ImageFileInvalid(
                "left and right are exchanged: the other way round all holes are found"
            ) from fault
        if has_mirror_image(holes) and _are_found(images, head, mirrored(holes), method):
            raise DrawingMirrored(
                "all holes are found with x of the other sign, and as drawn they are not "
                f"({fault.detail})"
            ) from fault
        for size, words in _OTHER_SIZES.items():
            if _are_found(images, head, tuple(_resized(hole, size) for hole in holes), method):
                raise FileInvalid(
                    f"all holes are found {words} as wide as drawn, and as drawn they are not "
                    f"({fault.detail}): is diameter_mm the radius, or twice the diameter?"
                ) from fault
        raise
    require_seen_face(holes, result.positions_m)
    return result


def _resized(hole: Hole, size: float) -> Hole:
    countersink_m = None if hole.countersink_m is None else size * hole.countersink_m
    return replace(hole, diameter_m=size * hole.diameter_m, countersink_m=countersink_m)


def _are_found(
    images: tuple[Image, ...], head: StereoHead, holes: tuple[Hole, ...], method: Method
) -> bool:
    left, right = images
    try:
        measure_pair(left, right, head, holes, method=method)
    except VisionError:
        return False
    return True


def _require_drawn_diameters(
    features: Path, result: PairMeasurement, holes: tuple[Hole, ...]
) -> None:
    if hint := other_diameters(result, holes):
        raise FileInvalid(f"{features}: {hint}")


def read_image(path: Path) -> Image:
    """An 8 bit grey image from a file; raises ``ImageFileInvalid``."""
    image = read_unchanged(path)
    # Many programs save grey images with three equal channels. Images of more than 8 bit are
    # refused: to scale them would be a guess about their range.
    if image.ndim == 3 and image.dtype == np.uint8:
        image = cv2.cvtColor(
            image, cv2.COLOR_BGR2GRAY if image.shape[2] == 3 else cv2.COLOR_BGRA2GRAY
        )
    if image.ndim != 2 or image.dtype != np.uint8:
        raise ImageFileInvalid(f"{path}: needs 8 bit grey values, has {image.dtype}")
    return np.asarray(image, dtype=np.uint8)


def measurement_to_json(result: PairMeasurement, pose: PartPose | None) -> dict[str, Any]:
    """The result as plain data: pixels, mm, mm², and for the pose mm and rad."""
    data: dict[str, Any] = {
        "method": result.method,
        "holes": {
            hole.name: {
                "kind": hole.kind,
                "left_px": hole.left_px.tolist(),
                "right_px": hole.right_px.tolist(),
                "left_covariance_px2": hole.left_covariance_px2.tolist(),
                "right_covariance_px2": hole.right_covariance_px2.tolist(),
                "position_mm": (hole.position_m / MM).tolist(),
                "covariance_mm2": (hole.covariance_m2 / MM**2).tolist(),
                "diameter_mm": hole.diameter_m / MM,
                "epipolar_px": hole.epipolar_px,
                "left_out": hole.left_out,
            }
            for hole in result.holes
        },
        "camera_T_part": None,
        "covariance": None,
    }
    if pose is None:
        return data
    matrix = np.array(pose.pose.pose.as_matrix())
    matrix[:3, 3] /= MM
    units = np.array([MM, MM, MM, 1.0, 1.0, 1.0])
    data["camera_T_part"] = matrix.tolist()
    data["covariance"] = (pose.pose.covariance / np.outer(units, units)).tolist()
    data["covariance_order"] = ["x_mm", "y_mm", "z_mm", "rx_rad", "ry_rad", "rz_rad"]
    data["residuals_mm"] = {
        name: (residual / MM).tolist()
        for name, residual in zip(pose.names, pose.residuals_m, strict=True)
    }
    data["outliers"] = list(pose.outliers)
    data["misfit"] = {"chi2": pose.misfit.chi2, "freedom": pose.misfit.freedom}
    return data


def _holes(features: FeatureFile, head: int) -> tuple[Hole, ...]:
    if head == 0:
        return features.holes
    if head not in {1, 2}:
        raise typer.BadParameter("--head is 1 or 2")
    holes = features.seen_by(1 if head == 1 else 2)
    if not holes:
        raise typer.BadParameter(f"the feature file has no list head_{head}")
    return holes


def _method(name: str) -> Method:
    if name == "default":
        return "default"
    if name == "paper":
        return "paper"
    raise typer.BadParameter("--method is default or paper")


def _pose(result: PairMeasurement, holes: tuple[Hole, ...]) -> PartPose | None:
    """The part's pose, by registration whatever the image method; None for holes on a line."""
    if on_a_line(np.array([hole.position_m for hole in holes])):
        return None
    # Wide limits: the user of this command wants to see the residuals, which a fault would hide.
    limit_m = 2.0 * MM if result.method == "paper" else 0.5 * MM
    return part_pose(result, None, None, holes, residual_limit_m=limit_m)


def _picture(images: tuple[Image, Image], result: PairMeasurement) -> bytes:
    both = np.hstack([annotate(images[0], result, "left"), annotate(images[1], result, "right")])
    done, data = cv2.imencode(".png", both)
    if not done:
        raise ImageFileInvalid("the picture could not be encoded as PNG")
    return data.tobytes()
