"""Pixels of a stereo head and their derivatives."""

import cv2
import numpy as np

from cellctl.vision.camera.stereo_projection import (
    camera_points,
    pixels,
    pixels_by_point,
    right_camera_m,
)
from tests.unit.vision.plates import table_1_head

HEAD = table_1_head()
POINTS_M = np.random.default_rng(2).uniform([-0.1, -0.08, 0.4], [0.1, 0.08, 0.6], (20, 3))


def test_both_images_agree_with_opencv() -> None:
    left_px, right_px = pixels(HEAD, POINTS_M)
    turn, _ = cv2.Rodrigues(HEAD.rotation)
    for camera, seen_px, rotation, move_m in (
        (HEAD.left, left_px, np.zeros(3), np.zeros(3)),
        (HEAD.right, right_px, turn, HEAD.translation_m),
    ):
        theirs, _ = cv2.projectPoints(
            POINTS_M, rotation, move_m, camera.camera_matrix, camera.distortion
        )
        np.testing.assert_allclose(seen_px, theirs.reshape(-1, 2), atol=1e-9)


def test_derivatives_are_what_pixels_do() -> None:
    step_m = np.array([2e-6, -3e-6, 1e-6])
    ahead, behind = (np.hstack(pixels(HEAD, POINTS_M + way)) for way in (step_m, -step_m))
    change_px = pixels_by_point(HEAD, POINTS_M) @ (2.0 * step_m)
    np.testing.assert_allclose(change_px, ahead - behind, rtol=1e-5)


def test_the_right_camera_is_where_its_own_frame_has_its_origin() -> None:
    _, in_right_m = camera_points(HEAD, right_camera_m(HEAD)[None])
    np.testing.assert_allclose(in_right_m, 0.0, atol=1e-15)
