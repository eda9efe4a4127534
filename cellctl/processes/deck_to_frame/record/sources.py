"""What a measurement was computed from, so that it can be computed anew from the record."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.errors import CellError
from cellctl.interfaces import StereoPair
from cellctl.interfaces.exposure import ExposureRecord
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.deck_to_frame.poses.part_measurer import PartMeasurement, SeenPair
from cellctl.processes.deck_to_frame.record.keys import FAILED, FRAME

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
