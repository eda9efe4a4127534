"""Detection and measurement on analytic images of this folder's own renderer."""

from collections.abc import Callable

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.vision import (
    CamerasSwapped,
    CameraUpsideDown,
    HoleAmbiguous,
    HoleMissing,
    ImageBlack,
    ImageBlurred,
    ImageSaturated,
    ImageSizeMismatch,
    ResidualsTooLarge,
    VisionError,
)
from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.features.hole import Hole
from cellctl.vision.measure import measure_pair
from cellctl.vision.measurement import Method
from cellctl.vision.picture import INSET_PX, annotate
from cellctl.vision.registration.average import average
from tests.unit.vision.plates import (
    Light,
    Pair,
    cut_head,
    holes_triangle,
    plate_facing,
    render_pair,
    table_1_head,
)

HEAD = cut_head()
HOLES = holes_triangle(("pin", "thread", "countersink"))
POSE = plate_facing(3.0, -2.0, 2.0)
TRUTH = POSE.apply(np.array([hole.position_m for hole in HOLES]))


LIGHT = Light(wall=0.35, depth_m=3e-3, texture=3.0, gradient_per_px=0.01)


@pytest.fixture(scope="module")
def pair() -> Pair:
    return render_pair(HEAD, POSE, HOLES, LIGHT, seed=1)


@pytest.fixture(scope="module")
def square_pair() -> Pair:
    """Four equal holes on a square: no layout tells them apart."""
    return render_pair(HEAD, POSE, square(), Light(), seed=2)


def square() -> tuple[Hole, ...]:
    corners = ((-40, -40), (40, -40), (40, 40), (-40, 40))
    return tuple(
        Hole(f"S{index}", "pin", 6 * MM, np.array([x, y, 0.0]) * MM)
        for index, (x, y) in enumerate(corners)
    )


def errors_m(
    pair: Pair, pose: RigidTransform | None, method: Method = "default", head: StereoHead = HEAD
) -> Array:
    result = measure_pair(*pair, head, HOLES, camera_T_part=pose, method=method)
    assert result.names == ("P1", "P2", "P3")
    return result.positions_m - TRUTH


def test_whole_image_and_window_give_the_same_holes(pair: Pair) -> None:
    anywhere, near = errors_m(pair, None), errors_m(pair, POSE)
    assert np.abs(anywhere).max() < 60e-6
    assert np.abs(anywhere - near).max() < 5e-6


@pytest.mark.figures  # five megapixels, of which two thirds show nothing
def test_the_same_holes_are_found_in_images_of_a_whole_sensor() -> None:
    head = table_1_head()
    pair = render_pair(head, POSE, HOLES, LIGHT, seed=1)
    anywhere, near = errors_m(pair, None, head=head), errors_m(pair, POSE, head=head)
    assert np.abs(anywhere).max() < 60e-6
    assert np.abs(anywhere - near).max() < 5e-6


@pytest.mark.parametrize(
    "off", [[6, 0, 0, 0, 0, 0], [-4, 4, 1, 0.5, 0, 0], [3, -4, -2, -0.5, 0.2, -0.2]]
)
def test_a_predicted_pose_may_be_off(pair: Pair, off: list[float]) -> None:
    predicted = POSE * pose_from_xyzabc(off)
    assert np.abs(errors_m(pair, predicted)).max() < 60e-6


def test_a_hole_outside_its_window_is_missing(pair: Pair) -> None:
    with pytest.raises(HoleMissing):
        measure_pair(*pair, HEAD, HOLES, camera_T_part=POSE * pose_from_xyzabc([20, 0, 0, 0, 0, 0]))


def test_the_papers_steps_stay_selectable(pair: Pair) -> None:
    result = measure_pair(*pair, HEAD, HOLES[:1] + HOLES[2:], camera_T_part=POSE, method="paper")
    assert result.method == "paper"
    assert np.abs(result.positions_m - TRUTH[[0, 2]]).max() < 1e-3


@pytest.mark.figures  # the metrology benchmark measures a disc as well
def test_white_discs_are_measured_alike() -> None:
    discs = holes_triangle(("disc", "disc", "disc"))
    images = render_pair(HEAD, POSE, discs, Light(), seed=3)
    result = measure_pair(*images, HEAD, discs, camera_T_part=POSE)
    truth = POSE.apply(np.array([disc.position_m for disc in discs]))
    assert np.abs(result.positions_m - truth).max() < 8e-6
    assert all(abs(hole.diameter_m / 20e-3 - 1) < 1e-3 for hole in result.holes)


@pytest.mark.parametrize("diameter_mm", [pytest.param(12, marks=pytest.mark.long), 6])
def test_missing_holes_are_named_not_guessed(pair: Pair, diameter_mm: float) -> None:
    missing = Hole("P9", "pin", diameter_mm * MM, np.array([0.03, 0.03, 0.0]))
    with pytest.raises(HoleMissing, match="P9"):
        measure_pair(*pair, HEAD, (*HOLES, missing))


def test_a_symmetric_layout_is_ambiguous_unless_a_pose_is_known(square_pair: Pair) -> None:
    with pytest.raises(HoleAmbiguous, match="S"):
        measure_pair(*square_pair, HEAD, square())
    result = measure_pair(*square_pair, HEAD, square(), camera_T_part=POSE)
    truth = POSE.apply(np.array([hole.position_m for hole in square()]))
    assert np.abs(result.positions_m - truth).max() < 15e-6


def test_a_single_hole_among_equals_is_ambiguous(square_pair: Pair) -> None:
    with pytest.raises(HoleAmbiguous):
        measure_pair(*square_pair, HEAD, square()[:1])


def test_a_drawing_that_is_nearly_right_is_refused(pair: Pair) -> None:
    moved = (
        HOLES[0],
        Hole("P2", "thread", 5 * MM, HOLES[1].position_m + np.array([0, 1.5 * MM, 0])),
        HOLES[2],
    )
    with pytest.raises(ResidualsTooLarge, match="drawing"):
        measure_pair(*pair, HEAD, moved)


def test_exchanged_and_turned_images_are_recognised(pair: Pair) -> None:
    left, right = pair
    with pytest.raises(CamerasSwapped):
        measure_pair(right, left, HEAD, HOLES)
    with pytest.raises(CameraUpsideDown, match="right"):
        measure_pair(left, np.ascontiguousarray(right[::-1, ::-1]), HEAD, HOLES)


@pytest.mark.parametrize(
    ("spoil", "fault"),
    [
        (lambda image: np.full_like(image, 4), ImageBlack),
        (lambda image: np.full_like(image, 255), ImageSaturated),
        (lambda image: np.full_like(image, 120), ImageBlurred),
        (lambda image: image[:-1], ImageSizeMismatch),
        (lambda image: image.astype(np.uint16), ImageSizeMismatch),
    ],
)
def test_images_that_cannot_be_measured(
    pair: Pair, spoil: Callable[[Image], Image], fault: type[VisionError]
) -> None:
    left, right = pair
    with pytest.raises(fault, match="right"):
        measure_pair(left, spoil(right), HEAD, HOLES)


def test_an_image_out_of_focus_is_called_that(pair: Pair) -> None:
    left, right = pair
    soft = np.asarray(cv2.GaussianBlur(right, (0, 0), 3.5), dtype=np.uint8)
    with pytest.raises(ImageBlurred, match=r"right: the rim of P\d is blurred"):
        measure_pair(left, soft, HEAD, HOLES, camera_T_part=POSE)


def test_averages_shrink_the_random_part_only(pair: Pair) -> None:
    single = measure_pair(*pair, HEAD, HOLES, camera_T_part=POSE)
    mean = average([single] * 9)
    assert mean.frames == 9
    ratio = np.sqrt(mean.covariances_m2[0, 2, 2] / single.covariances_m2[0, 2, 2])
    assert 0.6 < ratio < 0.75
    with pytest.raises(ValueError, match="nothing"):
        average([])


def test_pictures_show_what_was_found(pair: Pair) -> None:
    result = measure_pair(*pair, HEAD, HOLES, camera_T_part=POSE)
    picture = annotate(pair[0], result, "left")
    height, width = pair[0].shape
    assert picture.shape == (height + INSET_PX, width, 3)
    assert picture[height:, :INSET_PX].any(), "each hole is shown enlarged below the image"
    changed = (picture[:height] != pair[0][:, :, None]).any(axis=2)
    assert changed.mean() < 0.02, "and nothing lies over the image"
    for hole in result.holes:
        x, y = np.rint(hole.left_px).astype(int)
        assert changed[y - 30 : y + 30, x - 30 : x + 30].any()
