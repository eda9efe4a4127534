"""Find round features in a stereo pair: in the whole images, or near a predicted pose."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.lens import project
from cellctl.vision.camera.stereo_head import CameraModel, StereoHead
from cellctl.vision.features.hole import Hole
from cellctl.vision.features.known_kinds import by_brightness, kind_of
from cellctl.vision.holes.candidates import Candidate, find_candidates
from cellctl.vision.holes.correspondence import Expectation, StereoCandidate, pair_candidates
from cellctl.vision.holes.discs import bright_discs

NEAR, WIDE = (0.8, 1.3), (0.45, 2.2)
"""Ranges of distance for the whole-image search, in parts of the head's working distance."""

_EPIPOLAR_PX = 7.0
"""Distance from the epipolar line: candidates are found at quarter scale, to one or two pixels of
the full image."""
_RADIUS_MARGIN = 0.12
"""Relative margin of the radii that are voted for: voting finds a radius to a tenth."""
_SMALLEST_PX = 3.0
"""Smaller circles have too few edge pixels to vote."""


@dataclass(frozen=True, slots=True, eq=False)
class HeadImages:
    """Two images of one exposure and the head that took them."""

    head: StereoHead
    left: Image
    right: Image


def working_distance_m(head: StereoHead) -> float:
    """Distance at which the optical axes come closest; five baselines when they hardly converge."""
    axis = head.rotation.T @ np.array([0.0, 0.0, 1.0])
    origin = -head.rotation.T @ head.translation_m
    sine2 = 1.0 - axis[2] ** 2
    baseline = float(np.linalg.norm(head.translation_m))
    along = (origin[2] - axis[2] * float(axis @ origin)) / max(float(sine2), 1e-6)
    # Axes that are nearly parallel come closest at a distance that small errors of the calibration
    # decide.
    return float(along) if 1.5 * baseline < along < 12.0 * baseline else 5.0 * baseline


@dataclass(frozen=True, slots=True, eq=False)
class RoundFeatures:
    """Round features in the whole images of a pair, by their brightness, at plausible distances."""

    images: HeadImages
    depth_m: tuple[float, float]
    left: Mapping[bool, Sequence[Candidate]]
    """Under True the bright ones; only what the drawing has is searched for."""
    right: Mapping[bool, Sequence[Candidate]]

    def pairs(self) -> list[StereoCandidate]:
        """Those that both cameras saw."""
        return [
            pair
            for bright, left in self.left.items()
            for pair in pair_candidates(
                self.images.head,
                left,
                self.right[bright],
                bright=bright,
                epipolar_px=_EPIPOLAR_PX,
                depth_m=self.depth_m,
            )
        ]

    def exchanged(self) -> "RoundFeatures":
        """What would have been found with left and right image exchanged."""
        return replace(self, left=self.right, right=self.left)

    def turned(self, *, left: bool, right: bool) -> "RoundFeatures":
        """What would have been found with these images turned by 180°."""
        return replace(
            self,
            left=_turned(self.left, self.images.left) if left else self.left,
            right=_turned(self.right, self.images.right) if right else self.right,
        )


class WholeImageSearch:
    """Looks for the round features of a drawing in whole images, once for each reach."""

    def __init__(self, images: HeadImages, holes: Sequence[Hole]) -> None:
        self.images, self.holes = images, holes
        self._found: dict[tuple[float, float], RoundFeatures] = {}

    def features(self, reach: tuple[float, float]) -> RoundFeatures:
        """Features at this range of distances, in parts of the head's working distance."""
        if reach not in self._found:
            self._found[reach] = self._search(reach)
        return self._found[reach]

    def _search(self, reach: tuple[float, float]) -> RoundFeatures:
        images, head = self.images, self.images.head
        distance_m = working_distance_m(head)
        depth_m = (reach[0] * distance_m, reach[1] * distance_m)
        left, right = (
            {
                bright: _round(image, _radii(camera, group, depth_m), bright=bright)
                for bright, group in by_brightness(self.holes)
            }
            for image, camera in ((images.left, head.left), (images.right, head.right))
        )
        return RoundFeatures(images, depth_m, left, right)


def search_windows(
    images: HeadImages, holes: Sequence[Hole], expectation: Expectation
) -> list[StereoCandidate]:
    """Round features within a window round each hole's predicted place."""
    head, camera_T_part, radius_m = images.head, expectation.camera_T_part, expectation.radius_m
    right_T_part = head.right_T_left * camera_T_part
    candidates: list[StereoCandidate] = []
    for bright, group in by_brightness(holes):
        found = [
            _in_windows(image, camera, group, Expectation(pose, radius_m))
            for image, camera, pose in (
                (images.left, head.left, camera_T_part),
                (images.right, head.right, right_T_part),
            )
        ]
        depths = camera_T_part.apply(np.array([hole.position_m for hole in group]))[:, 2]
        depth_m = (float(depths.min()) - radius_m, float(depths.max()) + radius_m)
        candidates += pair_candidates(
            head, found[0], found[1], bright=bright, epipolar_px=_EPIPOLAR_PX, depth_m=depth_m
        )
    return candidates


def _turned(
    groups: Mapping[bool, Sequence[Candidate]], image: Image
) -> dict[bool, list[Candidate]]:
    last_px = np.array(image.shape[::-1]) - 1.0
    return {
        bright: [replace(item, centre_px=last_px - item.centre_px) for item in group]
        for bright, group in groups.items()
    }


def _radii(
    camera: CameraModel, holes: Sequence[Hole], depth_m: tuple[float, float]
) -> tuple[float, float]:
    focal = float(camera.camera_matrix[0, 0])
    radii_m = [hole.diameter_m / 2.0 for hole in holes]
    smallest, largest = focal * min(radii_m) / depth_m[1], focal * max(radii_m) / depth_m[0]
    return max(smallest, _SMALLEST_PX) * (1.0 - _RADIUS_MARGIN / 2), max(largest, 4.0)


def _in_windows(
    image: Image, camera: CameraModel, holes: Sequence[Hole], expectation: Expectation
) -> list[Candidate]:
    found: list[Candidate] = []
    points = expectation.camera_T_part.apply(np.array([hole.position_m for hole in holes]))
    for hole, point in zip(holes, points, strict=True):
        if point[2] <= 0:
            continue
        radius_px = float(camera.camera_matrix[0, 0]) * hole.diameter_m / 2.0 / point[2]
        middle = project(camera, point[None])[0]
        reach_px = float(camera.camera_matrix[0, 0]) * expectation.radius_m / point[2]
        window, origin = _window(image, middle, reach_px + 1.3 * radius_px)
        if window is None:
            continue
        radii_px = (radius_px * (1.0 - _RADIUS_MARGIN), radius_px * (1.0 + _RADIUS_MARGIN))
        # Windows of neighbouring holes overlap: a feature that two of them show is kept once.
        for item in _round(window, radii_px, bright=kind_of(hole).bright, limit=12):
            centre = item.centre_px + origin
            if not any(_same(centre, item.radius_px, other) for other in found):
                found.append(Candidate(centre, item.radius_px, item.support))
    return found


def _round(
    image: Image, radii_px: tuple[float, float], *, bright: bool, limit: int = 60
) -> list[Candidate]:
    if bright:
        return bright_discs(image, radii_px)[:limit]
    return find_candidates(image, radii_px, limit=limit)


def _window(image: Image, middle: Array, half_px: float) -> tuple[Image | None, Array]:
    height, width = image.shape
    x0, y0 = (int(max(value - half_px, 0)) for value in middle)
    x1, y1 = int(min(middle[0] + half_px, width)), int(min(middle[1] + half_px, height))
    if x1 - x0 < 16 or y1 - y0 < 16:
        return None, np.zeros(2)
    return image[y0:y1, x0:x1], np.array([x0, y0], dtype=float)


def _same(centre: Array, radius_px: float, other: Candidate) -> bool:
    near = float(np.linalg.norm(centre - other.centre_px)) < 3.0
    return near and abs(radius_px - other.radius_px) < 0.2 * radius_px
