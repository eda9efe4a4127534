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
from cellctl.planning.scene.head_limits import ImageQuality
from cellctl.planning.views.hole_image import image_covariances
from cellctl.vision.camera.perturbed_head import perturbed_heads
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.camera.stereo_projection import pixels, pixels_by_point
from cellctl.vision.camera.triangulation import triangulate
from cellctl.vision.features.hole import Hole
from cellctl.vision.registration.measured_points import MeasuredPoints
from cellctl.vision.registration.relative_pose import relative_covariance, relative_pose
from cellctl.vision.registration.rigid_fit import by_pose

SOURCES = ("images", "holes off their drawing", "heads against each other", "sway")
CALIBRATION = "calibration of the heads"
_MORE = 1e-3
"""Relative increase of one variance, by which its share in the whole is found."""


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
    covariance = _covariance(placement, first, last, between, statement.sway_m)
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
    image_px2: Array,
) -> tuple[Array, Array]:
    """Holes triangulated from where they will be seen, (n, 3), with their covariances, (n, 3, 3).

    ``image_px2``: of both images of each hole, shape (n, 4, 4).
    """
    # Two exact pixels lead back to the point from which they come, so only the covariance of
    # `triangulate` is left to compute: of all holes at once, because a search asks for thousands.
    places_m = camera_T_part.apply([hole.position_m for hole in holes])
    by_point = pixels_by_point(head, places_m)
    normal = by_point.swapaxes(1, 2) @ np.linalg.inv(image_px2) @ by_point
    return np.asarray(places_m), np.asarray(np.linalg.inv(normal))


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
    c1_T_cell = placement.cell_T_cameras[0].inv()
    across = (c1_T_cell * cell_T_part).rotation.as_matrix()[:, :2]
    # Of each head: places, covariances, derivatives by the error of c1_T_c2; all in C1.
    rows: list[tuple[Array, Array, Array]] = []
    seen: list[Hole] = []
    for number, stated in enumerate(statement.heads):
        holes = part.seen[stated.name]
        if not holes:
            continue
        camera_T_part = placement.cell_T_cameras[number].inv() * cell_T_part
        quality = placement.qualities[number]
        image_px2 = (
            images
            * placement.image_variance
            * image_covariances(stated.camera, camera_T_part, holes, quality, placement.frames)
        )
        places, spreads = hole_points(stated.camera, camera_T_part, holes, image_px2)
        if heads is not None:
            places = _seen_through(stated.camera, heads[number], places, image_px2)
        seen += holes
        if number == 0:
            rows.append((places, spreads, np.zeros((len(holes), 3, 6))))
            continue
        c1_T_c2 = (c1_T_cell * placement.cell_T_cameras[number]).as_matrix()
        turn, turned = c1_T_c2[:3, :3], places @ c1_T_c2[:3, :3].T
        rows.append((turned + c1_T_c2[:3, 3], turn @ spreads @ turn.T, by_pose(turned)))
    measured, covariances, by_transfer = (np.concatenate(one) for one in zip(*rows, strict=True))
    squares = np.array([drawing * hole.position_sigma_m**2 for hole in seen])
    return MeasuredPoints(
        tuple(hole.name for hole in seen),
        np.array([hole.position_m for hole in seen]),
        measured,
        covariances + squares[:, None, None] * (across @ across.T),
        by_transfer,
        placement.frames,
    )


def _seen_through(
    true: StereoHead, believed: StereoHead, places_m: Array, image_px2: Array
) -> Array:
    """Where holes are taken to be by a head that is calibrated wrongly, shape (n, 3)."""
    left_px, right_px = pixels(true, places_m)
    return np.array(
        [
            triangulate(believed, left, right, covariance).position_m
            for left, right, covariance in zip(left_px, right_px, image_px2, strict=True)
        ]
    )


def _covariance(
    placement: ViewGeometry,
    first: MeasuredPoints,
    last: MeasuredPoints,
    between: Array,
    sway_m: float,
) -> Array:
    """The covariance for points that lie exactly where the parts have them."""
    return relative_covariance(first, last, *_c1_T_parts(placement), between, sway_m=sway_m)


def _solved(placement: ViewGeometry, first: MeasuredPoints, last: MeasuredPoints) -> RigidTransform:
    """The pose that the measurement makes of points."""
    between = placement.measurement.between_heads
    found = relative_pose(first, last, *_c1_T_parts(placement), between)
    return found.part_1_T_part_2.pose


def _c1_T_parts(placement: ViewGeometry) -> tuple[RigidTransform, RigidTransform]:
    c1_T_cell = placement.cell_T_cameras[0].inv()
    return c1_T_cell * placement.cell_T_parts[0], c1_T_cell * placement.cell_T_parts[-1]


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
        return np.diag(_covariance(placement, first, last, between * heads, 0.0))

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
    exact = _solved(placement, first, last)
    added = np.zeros((6, 6))
    for number, stated in enumerate(statement.heads):
        for other in perturbed_heads(stated.camera):
            heads = [one.camera for one in statement.heads]
            heads[number] = other
            seen = [_points(placement, index, heads) for index in (0, -1)]
            change = np.concatenate(pose_error(exact, _solved(placement, seen[0], seen[1])))
            added += np.outer(change, change)
    return added


def part_in_cell(part: StatedPart, bases: Mapping[str, RigidTransform]) -> RigidTransform:
    """``cell_T_part`` of a stated part; ``bases`` are ``cell_T_base`` by robot."""
    return bases[part.robot] * part.base_T_part
