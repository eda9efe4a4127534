"""What a measurement was computed from, so that it can be computed anew from the record."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.clock import utc_at
from cellctl.errors import CellError
from cellctl.geometry.pose import Array
from cellctl.interfaces import StereoPair
from cellctl.interfaces.exposure import ExposureRecord
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.deck_to_frame.poses.part_measurer import PartMeasurement, SeenPair
from cellctl.processes.deck_to_frame.record.keys import FAILED, FRAME
from cellctl.records.looks import MeasuredRim, TakenImage
from cellctl.vision.measurement import HoleMeasurement, Side

SIDES: tuple[Side, Side] = ("left", "right")
IMAGES_PER_FRAME = 4
"""Left and right of head I, left and right of head II."""


def raw_images(name: str, shots: Sequence[tuple[StereoPair, StereoPair]]) -> dict[str, Image]:
    """The images of a measurement by the names of their files, ``IMAGES_PER_FRAME`` a frame."""
    return {
        f"raw/{name}-frame-{frame}-head-{head}-{side}.pgm.zst": image
        for frame, pairs in enumerate(shots, start=1)
        for head, pair in enumerate(pairs, start=1)
        for side, image in (("left", pair.left), ("right", pair.right))
    }


def seen_images(name: str, seen: Sequence[SeenPair]) -> dict[str, Image]:
    """The images of a measurement that failed, by the names that ``raw_images`` would give them."""
    return {
        f"raw/{name}-frame-{one.frame}-head-{one.head}-{side}.pgm.zst": image
        for one in seen
        for side, image in (("left", one.pair.left), ("right", one.pair.right))
    }


def seen_exposures(name: str, seen: Sequence[SeenPair]) -> dict[str, ExposureRecord | None]:
    """How these images were exposed, by the same names."""
    records = (record for one in seen for record in one.pair.exposures or (None, None))
    return dict(zip(seen_images(name, seen), records, strict=True))


def seen_taken(name: str, seen: Sequence[SeenPair]) -> dict[str, TakenImage]:
    """When these images were taken and by which camera, by the same names."""
    images = (
        TakenImage(name, view_name(one.head, side), utc_at(one.pair.time_s))
        for one in seen
        for side in SIDES
    )
    return dict(zip(seen_images(name, seen), images, strict=True))


def failed_from(
    part: str, predicted: RigidTransform, fault: CellError, images: list[str]
) -> dict[str, Any]:
    """Part, prediction, images and fault of a measurement that failed."""
    return {
        "key": FAILED,
        "part": part,
        "c1_T_part_predicted": predicted.as_matrix().tolist(),
        "fault": fault.number,
        "text": str(fault),
        "images": images,
    }


def exposures(
    name: str, shots: Sequence[tuple[StereoPair, StereoPair]]
) -> dict[str, ExposureRecord | None]:
    """How these images were exposed, by the same names; None where the driver does not know."""
    records = (
        record for pairs in shots for pair in pairs for record in pair.exposures or (None, None)
    )
    return dict(zip(raw_images(name, shots), records, strict=True))


def taken(name: str, shots: Sequence[tuple[StereoPair, StereoPair]]) -> dict[str, TakenImage]:
    """When these images were taken and by which camera, by the names of their files."""
    views = [(head, side) for head in (1, 2) for side in SIDES]
    images = (
        TakenImage(name, view_name(head, side), utc_at(pairs[head - 1].time_s))
        for pairs in shots
        for head, side in views
    )
    return dict(zip(raw_images(name, shots), images, strict=True))


def view_name(head: int, side: str) -> str:
    """Name of the view of one camera of a head, as in the names of files."""
    return f"head-{head}-{side}"


def rims(measured: PartMeasurement) -> dict[str, tuple[MeasuredRim, ...]]:
    """What was found in the images of a measurement, by view, with the residuals of its pose."""
    distances_m = np.linalg.norm(measured.pose.residuals_m, axis=1).tolist()
    residuals_um = {
        name: distance_m * 1e6
        for name, distance_m in zip(measured.pose.names, distances_m, strict=True)
    }
    return {
        view_name(head, side): tuple(
            _rim(hole, side, residuals_um.get(hole.name), measured.pose.outliers)
            for hole in pair.holes
        )
        for head, pair in enumerate(measured.heads, start=1)
        for side in SIDES
    }


def _rim(
    hole: HoleMeasurement, side: Side, residual_um: float | None, outliers: Sequence[str]
) -> MeasuredRim:
    left = side == "left"
    ellipse = hole.left_ellipse if left else hole.right_ellipse
    centre = hole.left_px if left else hole.right_px
    covariance = hole.left_covariance_px2 if left else hole.right_covariance_px2
    return MeasuredRim(
        name=hole.name,
        centre_px=_pair(centre),
        sigma_px=_pair(np.sqrt(np.diag(covariance))),
        ellipse_centre_px=_pair(ellipse.centre_px),
        semi_axes_px=_pair(np.array(ellipse.semi_axes_px)),
        angle_rad=float(ellipse.angle_rad),
        residual_um=residual_um,
        used=hole.name not in outliers,
    )


def _pair(values: Array) -> tuple[float, float]:
    return float(values[0]), float(values[1])


def measured_from(
    kind: str, measured: PartMeasurement, predicted: RigidTransform, images: list[str]
) -> dict[str, Any]:
    """Key of the recorded result, part, prediction and images of one measurement.

    ``predicted`` is ``c1_T_part`` near which the holes were looked for. It is a matrix in metres
    with all digits: angles would round it.
    """
    return {
        "key": kind,
        "part": FRAME if kind == FRAME else "deck",
        "c1_T_part_predicted": predicted.as_matrix().tolist(),
        "result": measured.c1_T_part.as_matrix().tolist(),
        "covariance": np.asarray(measured.pose.pose.covariance).tolist(),
        "images": images,
    }


def predicted_pose(source: Mapping[str, Any]) -> RigidTransform:
    """``c1_T_part`` near which the holes were looked for."""
    return RigidTransform.from_matrix(np.array(source["c1_T_part_predicted"], float))
