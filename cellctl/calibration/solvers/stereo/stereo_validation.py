"""Tests whether a calibration holds for views that it has not seen, in millimetres.

The views are split into two halves; each half calibrates alone and measures the boards of the
other half. A low reprojection error says nothing about this (reference: cross-validation diff).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.calibration.boards.board import BoardView, Ids
from cellctl.calibration.boards.projection import camera_model
from cellctl.calibration.solvers.stereo.bundle import BundleState
from cellctl.geometry.pose import Array
from cellctl.vision.camera.lens import undistort


@dataclass(frozen=True, slots=True)
class CrossValidation:
    """Figures of two half calibrations."""

    held_out_m: float
    """Rms distance of measured to known board corners, boards of the other half, board by board
    fitted as rigid bodies."""
    difference_m: float
    """Rms distance between the points that the two halves measure, common motion removed."""
    difference_rotation_rad: float
    """Largest turn of a single board between the halves against the common motion."""


def cross_validate(
    halves: tuple[BundleState, BundleState],
    views: tuple[Sequence[BoardView], Sequence[BoardView]],
    board_m: Array,
) -> CrossValidation:
    """Compare two half calibrations; ``board_m`` is the best known shape of the board."""
    squares, count = 0.0, 0
    measured: list[tuple[Array, Array]] = []
    for half, own in zip(halves, (1, 0), strict=True):
        for view in views[own]:
            ids, points = triangulate_view(half, view)
            # Board by board: where the board stood is not known, its shape is.
            moved = rigid_fit(board_m[ids], points)
            squares += float(((moved - points) ** 2).sum())
            count += len(ids)
    for view in (*views[0], *views[1]):
        measured.append(
            (triangulate_view(halves[0], view)[1], triangulate_view(halves[1], view)[1])
        )
    first = np.concatenate([pair[0] for pair in measured])
    second = np.concatenate([pair[1] for pair in measured])
    # A motion common to all points is a choice of the camera frame, no error of measurement.
    rotation, shift = _motion(first, second)
    turns = [
        float((Rotation.from_matrix(_motion(a, b)[0] @ rotation.T)).magnitude())
        for a, b in measured
    ]
    off = first @ rotation.T + shift - second
    return CrossValidation(
        float(np.sqrt(squares / max(count, 1))),
        float(np.sqrt((off**2).sum(axis=1).mean())),
        max(turns),
    )


def triangulate_view(state: BundleState, view: BoardView) -> tuple[Ids, Array]:
    """Ids and positions (n, 3) in the left camera of the corners that both cameras see."""
    ids, in_left, in_right = np.intersect1d(
        view.left.ids, view.right.ids, assume_unique=True, return_indices=True
    )
    left = undistort(camera_model(state.left), view.left.pixels[in_left])
    right = undistort(camera_model(state.right), view.right.pixels[in_right])
    return np.asarray(ids, dtype=np.int64), intersect_rays(
        left, right, state.rotation, state.translation_m
    )


def intersect_rays(left: Array, right: Array, rotation: Array, translation_m: Array) -> Array:
    """Least-squares points, shape (n, 3), from normalised image points of both cameras."""
    one = np.ones(len(left))
    zero = np.zeros(len(left))
    rows_left = [np.stack([one, zero, -left[:, 0]], 1), np.stack([zero, one, -left[:, 1]], 1)]
    rows_right = [
        rotation[0] - right[:, :1] * rotation[2],
        rotation[1] - right[:, 1:] * rotation[2],
    ]
    matrix = np.stack([*rows_left, *rows_right], axis=1)
    knowns = np.zeros((len(left), 4))
    knowns[:, 2] = right[:, 0] * translation_m[2] - translation_m[0]
    knowns[:, 3] = right[:, 1] * translation_m[2] - translation_m[1]
    normal = matrix.transpose(0, 2, 1) @ matrix
    right_side = np.einsum("nki,nk->ni", matrix, knowns)
    return np.asarray(np.linalg.solve(normal, right_side[:, :, None])[:, :, 0])


def rigid_fit(source: Array, target: Array) -> Array:
    """``source`` moved onto ``target`` by the best rigid motion."""
    rotation, shift = _motion(source, target)
    return np.asarray(source @ rotation.T + shift)


def _motion(source: Array, target: Array) -> tuple[Array, Array]:
    middle_s, middle_t = source.mean(axis=0), target.mean(axis=0)
    rotation = Rotation.align_vectors(target - middle_t, source - middle_s)[0].as_matrix()
    return rotation, middle_t - rotation @ middle_s
