"""Rims that moved during the exposure, and rims of which an arc is not where the circle is."""

import cv2
import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim.blur import Blur
from cellctl.vision.rim.covariance import with_covariance
from cellctl.vision.rim.light import LightModel
from cellctl.vision.rim.shape import RimPixels, RimShape
from cellctl.vision.rim.solver import RimPrior, full_fit, judged_by_arcs, single_image_problem

UNIT_PX = 1.0 / 3600.0
RADIUS_PX, HALF_PX, SUB = 21.5, 29, 8
CENTRE: Array = np.array([0.02, -0.01])
PLATE, WALL, DARK = 180.0, 90.0, 30.0
SHRINK = 1.05
"""Scale of a rim over that of the lower edge of its wall."""


def fine_grid() -> tuple[Array, Array]:
    """Places of all samples from the centre of the rim, px."""
    steps = (np.arange((2 * HALF_PX + 1) * SUB) + 0.5) / SUB - 0.5 - HALF_PX
    x, y = np.meshgrid(steps, steps)
    return x, y


def pixels_of(fine: Array, kernel: Array) -> RimPixels:
    """The band round the rim, blurred, gathered to pixels and with noise."""
    soft = cv2.filter2D(fine, -1, kernel, borderType=cv2.BORDER_REPLICATE)
    size = 2 * HALF_PX + 1
    grey = soft.reshape(size, SUB, size, SUB).mean(axis=(1, 3))
    grey += np.random.default_rng(5).normal(0.0, 1.0, grey.shape)
    y, x = np.mgrid[-HALF_PX : HALF_PX + 1, -HALF_PX : HALF_PX + 1]
    band = np.abs(np.hypot(x, y) - RADIUS_PX) < 6.0
    points = CENTRE[:, None] + np.stack([x[band], y[band]]) * UNIT_PX
    jacobian = np.broadcast_to(np.eye(2)[:, :, None] * UNIT_PX, (2, 2, points.shape[1])).copy()
    return RimPixels(points, jacobian, grey[band], UNIT_PX)


def in_focus(sigma_px: float = 0.9) -> Array:
    line = cv2.getGaussianKernel(6 * SUB + 1, sigma_px * SUB)
    return np.asarray(line @ line.T)


def moved_by(length_px: float) -> Array:
    """A movement of constant speed along x, behind a lens in focus."""
    line = np.zeros((1, 8 * SUB + 1))
    half = round(length_px * SUB / 2.0)
    line[0, 4 * SUB - half : 4 * SUB + half + 1] = 1.0 / (2 * half + 1)
    padded = np.pad(line, 3 * SUB)
    return np.asarray(cv2.filter2D(padded, -1, in_focus(), borderType=cv2.BORDER_CONSTANT))


def off_px(shape: RimShape) -> float:
    """Distance from the true centre."""
    return float(np.linalg.norm(shape.centre - CENTRE)) / UNIT_PX


def test_a_movement_during_the_exposure_does_not_shift_a_rim_with_a_wall() -> None:
    x, y = fine_grid()
    low = CENTRE * (1.0 / SHRINK - 1.0) / UNIT_PX
    below = np.hypot(x - low[0], y - low[1]) < RADIUS_PX / SHRINK
    inside = np.hypot(x, y) < RADIUS_PX
    fine = np.where(inside, np.where(below, DARK, WALL), PLATE)
    pixels = pixels_of(fine, moved_by(4.0))
    start = RimShape(CENTRE, RADIUS_PX * UNIT_PX, Blur(1.0), wall_ratio=0.04)
    problem = single_image_problem(pixels, start, LightModel(), RimPrior(start.radius), None)
    fit = full_fit(problem, start.vector)
    # The movement is seen as what it is: the variance of a line of 4 px along x, beside the lens.
    assert fit.shapes[0].blur.stretch[0] > 0.3
    assert abs(fit.shapes[0].blur.stretch[1]) < 0.05
    assert off_px(fit.shapes[0]) < 0.03


def test_a_dented_arc_does_not_shift_the_rim() -> None:
    x, y = fine_grid()
    dent_px = 1.5 * (np.abs(np.arctan2(y, x) - 0.7) < 0.4)
    fine = np.where(np.hypot(x, y) < RADIUS_PX + dent_px, DARK, PLATE)
    pixels = pixels_of(fine, in_focus())
    start = RimShape(CENTRE, RADIUS_PX * UNIT_PX, Blur(1.0))
    problem = single_image_problem(pixels, start, LightModel(), RimPrior(start.radius), None)
    all_arcs = full_fit(problem, start.vector)
    fit = judged_by_arcs(all_arcs)
    assert off_px(all_arcs.shapes[0]) > 0.05
    assert off_px(fit.shapes[0]) < 0.02
    # An eighth of the rim tells nothing any more, and the covariance knows.
    rated = with_covariance(fit, np.zeros((2, 2)))
    perfect = full_fit(
        single_image_problem(
            pixels_of(np.where(np.hypot(x, y) < RADIUS_PX, DARK, PLATE), in_focus()),
            start, LightModel(), RimPrior(start.radius), None,
        ),
        start.vector,
    )  # fmt: skip
    clean = with_covariance(judged_by_arcs(perfect), np.zeros((2, 2)))
    assert np.trace(rated.covariance[:2, :2]) > 1.1 * np.trace(clean.covariance[:2, :2])


def test_a_clean_rim_is_left_as_it_is() -> None:
    x, y = fine_grid()
    pixels = pixels_of(np.where(np.hypot(x, y) < RADIUS_PX, DARK, PLATE), in_focus())
    start = RimShape(CENTRE, RADIUS_PX * UNIT_PX, Blur(1.0))
    fit = full_fit(
        single_image_problem(pixels, start, LightModel(), RimPrior(start.radius), None),
        start.vector,
    )
    assert judged_by_arcs(fit) is fit
