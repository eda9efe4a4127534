"""The paper's image steps (section 2.2.1), kept as the named baseline ``method="paper"``.

(1) Smoothing, (2) Canny edges, (3) least-squares ellipse, (4) screening by area and perimeter; the
raw centre of the ellipse is triangulated. The paper leaves open which ellipse is which hole; the
search for correspondence of the default method is used for that.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from cellctl.errors.vision import HoleMissing
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.ellipse import Ellipse
from cellctl.vision.camera.stereo_head import CameraModel, StereoHead
from cellctl.vision.camera.triangulation import epipolar_distances_px, joint_covariance, triangulate
from cellctl.vision.features.hole import Hole
from cellctl.vision.features.known_kinds import by_brightness
from cellctl.vision.holes.candidates import Candidate
from cellctl.vision.holes.correspondence import (
    Expectation,
    StereoCandidate,
    assignments,
    pair_candidates,
)
from cellctl.vision.holes.search import WIDE, HeadImages, working_distance_m
from cellctl.vision.measurement import HoleMeasurement, PairMeasurement

CENTRE_SIGMA_PX = 0.03
"""Error of these centres on clean holes: 0.033 px rms in 2400 rendered images of holes. The method
itself states none."""

# The paper gives none of the figures below.
_CANNY = (40.0, 120.0)
_AREA_TOLERANCE, _PERIMETER_TOLERANCE = 0.25, 0.15
_LAYOUT_TOLERANCE_M = 1.0e-3
"""Wider than that of the default method: a visible wall alone shifts these centres by 0.1 mm in
depth."""
_EPIPOLAR_PX = 2.5


@dataclass(frozen=True, slots=True, eq=False)
class _Found(Candidate):
    ellipse: Ellipse


def fitted_ellipses(image: Image) -> list[Ellipse]:
    """Steps 1 to 3: every contour's least-squares ellipse in the raw image."""
    smooth = cv2.GaussianBlur(image, (5, 5), 0)
    edges = cv2.Canny(smooth, *_CANNY)
    contours, _ = cv2.findContours(edges, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
    found = []
    for contour in contours:
        # Five points define an ellipse; contours so short fit one without being a rim.
        if len(contour) < 20:
            continue
        (x, y), (first, second), angle_deg = cv2.fitEllipse(contour)
        if not (np.isfinite([x, y, first, second]).all() and min(first, second) > 0):
            continue
        # OpenCV states the angle of its first axis, whether that is the longer one or not.
        turn = 0.0 if first >= second else 90.0
        axes = (max(first, second) / 2.0, min(first, second) / 2.0)
        found.append(Ellipse(np.array([x, y]), axes, float(np.radians(angle_deg + turn))))
    return found


def measure_pair_by_paper(
    images: HeadImages, holes: Sequence[Hole], expectation: Expectation | None
) -> PairMeasurement:
    """Measure a pair by the paper's steps; raises ``HoleMissing`` when no layout fits."""
    head = images.head
    distance_m = working_distance_m(head)
    depth_m = (WIDE[0] * distance_m, WIDE[1] * distance_m)
    if expectation is not None:
        nominal = np.array([hole.position_m for hole in holes])
        depths = expectation.camera_T_part.apply(nominal)[:, 2]
        reach_m = expectation.radius_m
        depth_m = (float(depths.min()) - reach_m, float(depths.max()) + reach_m)
    ellipses = [fitted_ellipses(image) for image in (images.left, images.right)]
    candidates: list[StereoCandidate] = []
    for bright, group in by_brightness(holes):
        screened = [
            _screened(found, camera, group, depth_m)
            for found, camera in zip(ellipses, (head.left, head.right), strict=True)
        ]
        candidates += pair_candidates(
            head,
            screened[0],
            screened[1],
            bright=bright,
            epipolar_px=_EPIPOLAR_PX,
            depth_m=depth_m,
        )
    candidates = [candidate for candidate in candidates if _right_size(candidate, holes)]
    found = assignments(
        holes,
        candidates,
        tolerance_m=_LAYOUT_TOLERANCE_M,
        expectation=expectation,
    )
    if not found:
        raise HoleMissing("no arrangement of the ellipses that pass the screening fits the drawing")
    pairs = zip(holes, found[0].candidates, strict=True)
    return PairMeasurement(
        "paper", tuple(_hole(head, hole, candidate) for hole, candidate in pairs)
    )


def _screened(
    ellipses: Sequence[Ellipse],
    camera: CameraModel,
    holes: Sequence[Hole],
    depth_m: tuple[float, float],
) -> list[Candidate]:
    """Step 4: area and perimeter as a circle of one of the diameters would have them."""
    focal = float(camera.camera_matrix[0, 0])
    kept: list[Candidate] = []
    for ellipse in ellipses:
        for diameter_m in {hole.diameter_m for hole in holes}:
            near, far = (focal * diameter_m / 2.0 / depth for depth in depth_m)
            area_ok = (
                np.pi * far**2 * (1 - _AREA_TOLERANCE)
                < ellipse.area_px2
                < np.pi * near**2 * (1 + _AREA_TOLERANCE)
            )
            perimeter_ok = (
                2 * np.pi * far * (1 - _PERIMETER_TOLERANCE)
                < ellipse.perimeter_px
                < 2 * np.pi * near * (1 + _PERIMETER_TOLERANCE)
            )
            if area_ok and perimeter_ok:
                radius_px = float(np.sqrt(ellipse.area_px2 / np.pi))
                kept.append(_Found(ellipse.centre_px, radius_px, 1.0, ellipse))
                break
    return kept


def _right_size(candidate: StereoCandidate, holes: Sequence[Hole]) -> bool:
    return any(abs(candidate.diameter_m / hole.diameter_m - 1.0) < 0.12 for hole in holes)


def _hole(head: StereoHead, hole: Hole, candidate: StereoCandidate) -> HoleMeasurement:
    left, right = candidate.left, candidate.right
    if not (isinstance(left, _Found) and isinstance(right, _Found)):
        raise TypeError("candidates of this method carry their ellipse")
    covariance = np.eye(2) * CENTRE_SIGMA_PX**2
    point = triangulate(
        head, left.centre_px, right.centre_px, joint_covariance(covariance, covariance)
    )
    epipolar = epipolar_distances_px(head, left.centre_px[None], right.centre_px[None])
    return HoleMeasurement(
        name=hole.name,
        kind=hole.kind,
        left_px=left.centre_px,
        right_px=right.centre_px,
        left_covariance_px2=covariance,
        right_covariance_px2=covariance,
        position_m=point.position_m,
        covariance_m2=point.covariance_m2,
        left_ellipse=left.ellipse,
        right_ellipse=right.ellipse,
        diameter_m=candidate.diameter_m,
        epipolar_px=float(epipolar[0, 0]),
    )
