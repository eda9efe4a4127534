"""Calibration with rendered grids of circles, of which the images are ellipses and eggs."""

from dataclasses import replace

import numpy as np
import pytest

from cellctl.calibration.boards.board_images import BoardImage, detect_camera_views, detect_views
from cellctl.calibration.boards.projection import camera_vector
from cellctl.calibration.solvers.single_camera.single_camera_calibration import (
    calibrate_single_camera,
)
from cellctl.calibration.solvers.stereo.stereo import calibrate_stereo
from tests.rigs.calibration.circle_boards import GRID, STAGGERED, head, seen_by_both, seen_grid

HEAD = head()
LEFT = np.array([*HEAD.left.focal_px, *HEAD.left.centre_px, *HEAD.left.distortion])

# Both kinds of grid are detected and solved here, but not each by both solvers: to render the
# images of one takes longer than to calibrate from them.


def tilts(rng: np.random.Generator) -> list[tuple[float, ...]]:
    return [(*rng.uniform(-35, 35, 2), rng.uniform(-180, 180)) for _ in range(12)]


@pytest.mark.figures  # the command calibrates from such images as well
def test_a_single_camera() -> None:
    rng = np.random.default_rng(8)
    seen = [seen_grid(HEAD, GRID, tilt, rng) for tilt in tilts(rng)]
    images = [BoardImage(f"view {n}", one.image) for n, one in enumerate(seen)]
    found = detect_camera_views(images, GRID)
    result = calibrate_single_camera(found.views, GRID, found.image_size)
    assert result.passed, result.checks
    errors = camera_vector(result.camera.model) - LEFT
    assert result.sigma_px < 0.012
    assert np.abs(errors[:4] / result.sigma[:4]).max() < 3.5
    assert np.abs(errors[:2]).max() < 0.2


@pytest.mark.figures
def test_a_head_and_what_centres_of_ellipses_would_make_of_it() -> None:
    """Without the correction everything fits as well, and is wrong: offsets look like a pose."""
    board, rng = STAGGERED, np.random.default_rng(8)
    seen = [seen_by_both(HEAD, board, tilt, rng, f"view {n}") for n, tilt in enumerate(tilts(rng))]
    found = detect_views(seen, board)
    result = calibrate_stereo(found.views, board, found.image_size)
    assert result.passed, result.checks
    assert result.sigma_px < 0.012
    truth = HEAD.right_T_left
    off_m = result.head.translation_m - truth.translation
    assert abs(off_m[0]) < 1.2e-5
    assert np.abs(off_m).max() < 5e-5
    turn = result.head.right_T_left.rotation * truth.rotation.inv()
    assert np.degrees(turn.magnitude()) < 0.004
    # Circles of no size have the centres of their ellipses where theirs are.
    assert board.circles is not None
    points = replace(board, circles=replace(board.circles, diameter_m=1e-9))
    uncorrected = calibrate_stereo(found.views, points, found.image_size)
    assert uncorrected.sigma_px < 0.012
    assert abs(uncorrected.head.translation_m[0] - truth.translation[0]) > 2.5e-5
