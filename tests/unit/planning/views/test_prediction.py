"""The predicted pose against the estimator on drawn measurements, and its parts."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array, pose_error
from cellctl.geometry.uncertain import UncertainPose, perturbed
from cellctl.planning.views.hole_image import image_covariances
from cellctl.planning.views.plan_viewpoints import taught_placement
from cellctl.planning.views.prediction import (
    SOURCES,
    PredictedPose,
    ViewGeometry,
    hole_points,
    predicted_pose,
)
from cellctl.vision.camera.ellipse import Ellipse
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.camera.stereo_projection import pixels
from cellctl.vision.camera.triangulation import triangulate
from cellctl.vision.features.hole import Hole
from cellctl.vision.measurement import HoleMeasurement, PairMeasurement
from cellctl.vision.registration.part_pose import part_pose
from cellctl.vision.registration.relative_pose import relative_pose
from tests.unit.planning.views.deck_views import SCENE, measurement

PLACEMENT = taught_placement(SCENE, measurement())
DRAWS = 150


def drawn_part(
    placement: ViewGeometry, index: int, moved: RigidTransform, rng: np.random.Generator
) -> tuple[PairMeasurement, PairMeasurement]:
    """A part as both heads would measure it: holes off their drawing, noise in both images."""
    part, heads = placement.measurement.parts[index], []
    for number, stated in enumerate(placement.measurement.heads):
        camera_T_part = placement.cell_T_cameras[number].inv() * placement.cell_T_parts[index]
        quality, found = placement.qualities[number], []
        for hole in part.seen[stated.name]:
            (spread,) = image_covariances(
                stated.camera, camera_T_part, [hole], quality, placement.frames
            )
            off_m = rng.normal(0.0, hole.position_sigma_m, 3) * [1.0, 1.0, 0.0]
            true_m = camera_T_part.apply(hole.position_m + off_m)
            if number:
                true_m = moved.apply(true_m)
            seen = np.concatenate([one[0] for one in pixels(stated.camera, true_m[None])])
            found.append(
                measured(stated.camera, hole, rng.multivariate_normal(seen, spread), spread)
            )
        heads.append(PairMeasurement("default", tuple(found), placement.frames))
    return heads[0], heads[1]


def measured(head: StereoHead, hole: Hole, seen_px: Array, spread_px2: Array) -> HoleMeasurement:
    point = triangulate(head, seen_px[:2], seen_px[2:], spread_px2)
    rim = Ellipse(seen_px[:2], (20.0, 20.0), 0.0)
    return HoleMeasurement(
        name=hole.name,
        kind=hole.kind,
        left_px=seen_px[:2],
        right_px=seen_px[2:],
        left_covariance_px2=spread_px2[:2, :2],
        right_covariance_px2=spread_px2[2:, 2:],
        position_m=point.position_m,
        covariance_m2=point.covariance_m2,
        left_ellipse=rim,
        right_ellipse=rim,
        diameter_m=hole.diameter_m,
        epipolar_px=0.0,
    )


@pytest.mark.figures
def test_drawn_measurements_scatter_as_predicted() -> None:
    rng = np.random.default_rng(5)
    still = replace(PLACEMENT, measurement=replace(PLACEMENT.measurement, sway_m=0.0))
    statement = still.measurement
    predicted = predicted_pose(still)
    truth = still.cell_T_parts[0].inv() * still.cell_T_parts[-1]
    off = []
    for _ in range(DRAWS):
        drift = rng.multivariate_normal(np.zeros(6), statement.between_heads)
        # What c1_T_c2 is off shows in the points of the second head.
        moved = still.c1_T_c2.inv() * perturbed(still.c1_T_c2, drift)
        parts = []
        for index in (0, -1):
            heads = drawn_part(still, index, moved, rng)
            between = UncertainPose(still.c1_T_c2, statement.between_heads)
            holes = [hole for seen in statement.parts[index].seen.values() for hole in seen]
            parts.append(part_pose(heads[0], heads[1], between, holes))
        found = relative_pose(
            parts[0].points,
            parts[1].points,
            parts[0].pose.pose,
            parts[1].pose.pose,
            statement.between_heads,
        )
        off.append(np.concatenate(pose_error(truth, found.part_1_T_part_2.pose)))
    ratio = np.sqrt(np.mean(np.square(off), axis=0)) / predicted.sigma
    # Of 150 draws a standard deviation is known to 6 %.
    assert (ratio > 0.8).all(), ratio
    assert (ratio < 1.25).all(), ratio


def test_points_are_as_certain_as_their_triangulation_says() -> None:
    """All holes at once, without triangulating: the search asks for thousands of them."""
    for index, part in enumerate(PLACEMENT.measurement.parts):
        for number, stated in enumerate(PLACEMENT.measurement.heads):
            head, holes = stated.camera, part.seen[stated.name]
            camera_T_part = PLACEMENT.cell_T_cameras[number].inv() * PLACEMENT.cell_T_parts[index]
            spreads = image_covariances(head, camera_T_part, holes, PLACEMENT.qualities[number], 2)
            places, covariances = hole_points(head, camera_T_part, holes, spreads)
            for row, seen_px in enumerate(zip(*pixels(head, places), strict=True)):
                point = triangulate(head, *seen_px, spreads[row])
                assert point.position_m == pytest.approx(places[row], abs=1e-9)
                assert covariances[row] == pytest.approx(point.covariance_m2, rel=1e-6)


@cache
def explained() -> PredictedPose:
    return predicted_pose(PLACEMENT, explain=True)


def test_the_sources_add_up_to_the_whole() -> None:
    predicted = explained()
    assert set(predicted.by_source) == set(SOURCES)
    total = sum(predicted.by_source.values())
    assert total == pytest.approx(np.diag(predicted.covariance), rel=0.01)
    assert all(
        (part > -1e-3 * np.diag(predicted.covariance)).all()
        for part in predicted.by_source.values()
    )


def test_about_x_depends_on_the_images_and_z_on_the_calibration() -> None:
    predicted = explained()
    assert np.argmax(predicted.shares) == 3
    assert predicted.by_source["images"][3] > 0.5 * predicted.covariance[3, 3]
    assert 0.0 < predicted.calibration[2, 2] < predicted.covariance[2, 2]
