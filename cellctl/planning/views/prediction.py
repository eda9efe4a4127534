"""The pose that counts, as certain as it will be, before anything is measured.

Holes get the covariance that ``hole_image`` predicts, and the estimator of the measurement itself
(``vision.registration.relative_pose``) says how certain the pose is that it makes of them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.stated.views import StatedMeasurement, StatedPart
from cellctl.geometry.pose import Array, pose_error
from cellctl.geometry.uncertain import UncertainPose, skew
from cellctl.planning.scene.head_limits import ImageQuality
from cellctl.planning.views.hole_image import image_covariance, pixels
from cellctl.vision.camera.perturbed_head import perturbed_heads
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.camera.triangulation import triangulate
from cellctl.vision.features.hole import Hole
from cellctl.vision.registration.measured_points import MeasuredPoints
from cellctl.vision.registration.relative_pose import relative_pose

SOURCES = ("images", "holes off their drawing", "heads against each other", "sway")
CALIBRATION = "calibration of the heads"
_MORE = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class ViewGeometry:
    """Where both heads and the parts are, and what the images are like."""

    measurement: StatedMeasurement
    cell_T_parts: tuple[RigidTransform, ...]
    cell_T_cameras: tuple[RigidTransform, RigidTransform]
    """Left cameras of both heads."""
    qualities: tuple[ImageQuality, ImageQuality]
    frames: int
    image_variance: float = 1.0
    """Factor on that of all image points: half of it for twice as many heads."""

    @property
    def c1_T_c2(self) -> RigidTransform:
        """The second head's left camera in the first one's."""
        return self.cell_T_cameras[0].inv() * self.cell_T_cameras[1]


@dataclass(frozen=True, slots=True, eq=False)
class PredictedPose:
    """How certain the pose that counts will be."""

    covariance: Array
    """Shape (6, 6), without what the calibration of the heads is off: that stays the same from
    measurement to measurement."""
    calibration: Array
    """What the calibrations of both heads add, (6, 6)."""
    thresholds: Array
    by_source: Mapping[str, Array] = field(default_factory=dict)
    """Parts of the variances, (6,) each, which add up to those of ``covariance``."""

    @property
    def sigma(self) -> Array:
        """Standard deviations x, y, z (m), rx, ry, rz (rad), shape (6,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def shares(self) -> Array:
        """Standard deviations over thresholds, shape (6,)."""
        return self.sigma / self.thresholds

    @property
    def worst(self) -> float:
        """The greatest of ``shares``."""
        return float(self.shares.max())


def predicted_pose(placement: ViewGeometry, *, explain: bool = False) -> PredictedPose:
    """The pose of the last part in the first one, in the axes of the first.

    ``explain`` adds the calibrations of the heads and the share of each source, which takes a
    hundred times as long.
    """
    statement = placement.measurement
    first, last = (_points(placement, index) for index in (0, -1))
    between = statement.between_heads
    covariance = _solved(placement, first, last, between, statement.sway_m).covariance
    plain = PredictedPose(covariance, np.zeros((6, 6)), statement.thresholds)
    if not explain:
        return plain
    return replace(
        plain,
        calibration=_by_calibration(placement, first, last),
        by_source=_by_source(placement, covariance),
    )


def hole_points(
    head: StereoHead,
    camera_T_part: RigidTransform,
    holes: Sequence[Hole],
    image_px2: Sequence[Array],
) -> tuple[Array, Array]:
    """Holes triangulated from where they will be seen, (n, 3), with their covariances, (n, 3, 3).

    ``image_px2``: of both images of each hole, shape (4, 4).
    """
    left_px, right_px = pixels(head, camera_T_part.apply([hole.position_m for hole in holes]))
    found = [
        triangulate(head, left, right, covariance)
        for left, right, covariance in zip(left_px, right_px, image_px2, strict=True)
    ]
    return (
        np.array([one.position_m for one in found]).reshape(-1, 3),
        np.array([one.covariance_m2 for one in found]).reshape(-1, 3, 3),
    )


def _points(
    placement: ViewGeometry,
    index: int,
    heads: Sequence[StereoHead] | None = None,
    *,
    images: float = 1.0,
    drawing: float = 1.0,
) -> MeasuredPoints:
    """A part's holes as both heads will measure them; ``images`` and ``drawing`` are factors on
    variances. ``heads``: through which they are triangulated, else those that see them."""
    statement = placement.measurement
    part, cell_T_part = statement.parts[index], placement.cell_T_parts[index]
    c1_T_c2 = placement.c1_T_c2
    rows: list[tuple[Hole, Array, Array, Array]] = []
    for number, stated in enumerate(statement.heads):
        holes = part.seen[stated.name]
        if not holes:
            continue
        camera_T_part = placement.cell_T_cameras[number].inv() * cell_T_part
        quality = placement.qualities[number]
        image_px2 = [
            images
            * placement.image_variance
            * image_covariance(stated.camera, camera_T_part, hole, quality, placement.frames)
            for hole in holes
        ]
        places, spreads = hole_points(stated.camera, camera_T_part, holes, image_px2)
        if heads is not None:
            places = _seen_through(stated.camera, heads[number], places, image_px2)
        for hole, place, spread in zip(holes, places, spreads, strict=True):
            if number == 0:
                rows.append((hole, place, spread, np.zeros((3, 6))))
                continue
            turn = c1_T_c2.rotation.as_matrix()
            turned = turn @ place
            by_transfer = np.hstack([np.eye(3), -skew(turned)])
            rows.append((hole, turned + c1_T_c2.translation, turn @ spread @ turn.T, by_transfer))
    across = (placement.cell_T_cameras[0].inv() * cell_T_part).rotation.as_matrix()[:, :2]
    off = [drawing * hole.position_sigma_m**2 * across @ across.T for hole, *_ in rows]
    return MeasuredPoints(
        tuple(hole.name for hole, *_ in rows),
        np.array([hole.position_m for hole, *_ in rows]),
        np.array([place for _, place, _, _ in rows]),
        np.array([spread + one for (_, _, spread, _), one in zip(rows, off, strict=True)]),
        np.array([by_transfer for *_, by_transfer in rows]),
        placement.frames,
    )


def _seen_through(
    true: StereoHead, believed: StereoHead, places_m: Array, image_px2: Sequence[Array]
) -> Array:
    """Where holes are taken to be by a head that is calibrated wrongly, shape (n, 3)."""
    left_px, right_px = pixels(true, places_m)
    return np.array(
        [
            triangulate(believed, left, right, covariance).position_m
            for left, right, covariance in zip(left_px, right_px, image_px2, strict=True)
        ]
    )


def _solved(
    placement: ViewGeometry,
    first: MeasuredPoints,
    last: MeasuredPoints,
    between: Array,
    sway_m: float,
) -> UncertainPose:
    c1_T_cell = placement.cell_T_cameras[0].inv()
    poses = [c1_T_cell * placement.cell_T_parts[index] for index in (0, -1)]
    found = relative_pose(first, last, poses[0], poses[1], between, sway_m=sway_m)
    return found.part_1_T_part_2


def _by_source(placement: ViewGeometry, covariance: Array) -> Mapping[str, Array]:
    """Each source of error is made a little greater, and the variances tell its part.

    Without sway the weights are the best there are, so that to first order they do not matter, and
    the parts add up. What the sway adds is left.
    """
    between = placement.measurement.between_heads

    def variances(images: float = 1.0, drawing: float = 1.0, heads: float = 1.0) -> Array:
        first, last = (
            _points(placement, index, images=images, drawing=drawing) for index in (0, -1)
        )
        return np.diag(_solved(placement, first, last, between * heads, 0.0).covariance)

    still, more = variances(), 1.0 + _MORE
    parts = {
        SOURCES[0]: (variances(images=more) - still) / _MORE,
        SOURCES[1]: (variances(drawing=more) - still) / _MORE,
        SOURCES[2]: (variances(heads=more) - still) / _MORE,
    }
    parts[SOURCES[3]] = np.diag(covariance) - still
    return parts


def _by_calibration(placement: ViewGeometry, first: MeasuredPoints, last: MeasuredPoints) -> Array:
    """What the stated covariance of each head's calibration makes of the pose, shape (6, 6)."""
    statement = placement.measurement
    exact = _solved(placement, first, last, statement.between_heads, 0.0).pose
    added = np.zeros((6, 6))
    for number, stated in enumerate(statement.heads):
        for other in perturbed_heads(stated.camera):
            heads = [one.camera for one in statement.heads]
            heads[number] = other
            seen = [_points(placement, index, heads) for index in (0, -1)]
            pose = _solved(placement, seen[0], seen[1], statement.between_heads, 0.0).pose
            change = np.concatenate(pose_error(exact, pose))
            added += np.outer(change, change)
    return added


def part_in_cell(part: StatedPart, bases: Mapping[str, RigidTransform]) -> RigidTransform:
    """``cell_T_part`` of a stated part; ``bases`` are ``cell_T_base`` by robot."""
    return bases[part.robot] * part.base_T_part
