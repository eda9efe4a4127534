from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import Array
from cellctl.planning.scene.head_limits import ImageQuality
from cellctl.planning.views.hole_image import KINDS, image_covariances
from cellctl.vision.features.hole import Hole
from tests.unit.planning.views.deck_views import measurement

HEAD = measurement().heads[0].camera
QUALITY = ImageQuality(90.0, 3.0, 0.9)
DISC = Hole("H", "disc", 6e-3, np.zeros(3))


def facing(distance_m: float, tilt_deg: float = 0.0) -> RigidTransform:
    """A part in the middle of both pictures, its z towards the left camera."""
    turn = Rotation.from_euler("xy", [180.0, tilt_deg], degrees=True)
    return RigidTransform.from_components([0.0, 0.0, distance_m], turn)


def covariance(hole: Hole = DISC, *, distance_m: float = 0.5, frames: int = 1) -> Array:
    return np.asarray(image_covariances(HEAD, facing(distance_m), [hole], QUALITY, frames)[0])


def test_a_disc_that_faces_the_camera_has_the_known_bound() -> None:
    focal_px = float(HEAD.left.camera_matrix[0, 0])
    # The bound of docs/metrology.md for a circle, with a pixel's own box and 8 bits.
    edge_px, noise_grey = np.sqrt(0.9**2 + 1.0 / 12.0), np.sqrt(3.0**2 + 1.0 / 12.0)
    radius_px = focal_px * 3e-3 / 0.5
    bound_px = noise_grey / 90.0 * np.sqrt(2.0 * edge_px / (np.sqrt(np.pi) * radius_px))
    sigma_px = np.sqrt(np.diag(covariance()))[:2]
    assert sigma_px == pytest.approx(np.full(2, KINDS["disc"].over_bound * bound_px), rel=0.02)


def test_a_nearer_and_a_larger_hole_is_seen_better() -> None:
    plain = np.trace(covariance())
    assert np.trace(covariance(distance_m=0.35)) < plain
    assert np.trace(covariance(replace(DISC, diameter_m=10e-3))) < plain


def test_what_both_images_share_hardly_changes_the_depth() -> None:
    thread = covariance(replace(DISC, kind="thread"))
    difference = np.array([1.0, 0.0, -1.0, 0.0])
    mean = np.array([0.5, 0.0, 0.5, 0.0])
    independent = KINDS["thread"].over_bound ** 2 / KINDS["disc"].over_bound ** 2 * covariance()
    across = difference @ thread @ difference
    assert across == pytest.approx(difference @ independent @ difference, rel=0.2)
    assert mean @ thread @ mean > 1.5 * (mean @ independent @ mean)


def test_many_frames_leave_what_is_the_same_in_all_of_them() -> None:
    assert np.trace(covariance(frames=1000)) == pytest.approx(
        0.65**2 * np.trace(covariance()), 0.01
    )
