"""Finds and measures a pattern of equal round features: the contacts of a connector, or marks."""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.antenna_module.vision.contact_fit.circle_fit import Circle
from cellctl.processes.antenna_module.vision.contact_fit.circle_search import (
    circle_near,
    contrast_across,
)
from cellctl.processes.antenna_module.vision.contact_fit.spots import Spots, find_spots
from cellctl.processes.antenna_module.vision.contact_fit.tip_fit import fit_tip
from cellctl.processes.antenna_module.vision.matching import Placement, placements, rotation
from cellctl.processes.antenna_module.vision.planar_fit import PlanarFit, fit_planar
from cellctl.processes.antenna_module.vision.plane import MeasuringPlane

_COARSE, _FINE = 0.45, 0.28
"""Range of the search for edges, of the radius: first round a spot, then round a circle."""
_PRIOR = 0.10
"""Standard deviation of the drawing's radius, of itself: light and blur move all edges."""
_ALIKE = 0.04
"""The same of the radius that most contacts of this image have: they are made and lit alike."""
_COMMON_PX = 0.007
"""Standard deviation of what light and walls move all features of an image together, per axis: with
noise averaged away, this is left on rendered pins."""
_SUPPORT = 0.6
"""Share of all directions with an edge from which a circle counts as complete."""
_LOST = 4.0
"""Scatter of a circle's edges over that of the others: more is another thing than its rim."""
_STRENGTH = 0.35
"""An edge weaker than this share of the others is not that of a clean contact."""


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """What is looked for; m."""

    names: tuple[str, ...]
    positions_m: Array
    """Shape (n, 2), in the drawing."""
    diameter_m: float
    true_position_m: float
    reach_m: float
    """How far off its place a feature is still taken for this one."""
    bright: bool
    chamfer_m: float = 0.0
    """Chamfer of the tip of a pin: the flat is smaller than the rim by this, and as much nearer."""
    length_m: float = 0.0
    """What stands out of the ground."""

    def with_diameter(self, diameter_m: float) -> "Pattern":
        """The same arrangement of larger or smaller features."""
        return replace(self, diameter_m=diameter_m)


@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """Spots of the right size, and the placements of the pattern on them, best first."""

    spots: Spots
    spots_m: Array
    placements: tuple[Placement, ...]
    mirrored: tuple[Placement, ...]
    """Those of the pattern in a mirror."""


@dataclass(frozen=True, slots=True, eq=False)
class Feature:
    """One feature that was looked for at its place."""

    name: str
    circle: Circle | None
    """The circle that was fitted; None when no circle of this size is there."""
    contrast: float
    """Grey levels inside less outside, positive as the feature should be."""
    clean: bool
    """The circle is complete, and its edges are as strong as those of the others."""


@dataclass(frozen=True, slots=True, eq=False)
class PatternFit:
    """A pattern in its plane."""

    fit: PlanarFit
    features: tuple[Feature, ...]


def find_pattern(
    image: Image,
    plane: MeasuringPlane,
    pattern: Pattern,
    *,
    least: int,
    chiral: bool = False,
) -> Candidates:
    """Spots and placements; ``least`` features must be on spots for a placement to count.

    ``chiral``: the pattern differs from its mirror image, which is then looked for as well.
    """
    height, width = image.shape
    middle = plane.from_px(np.array([[width / 2.0, height / 2.0]]))[0]
    radius_px = pattern.diameter_m / 2.0 / plane.m_per_px(middle)
    spots = find_spots(image, radius_px, bright=pattern.bright, typical=len(pattern.names))
    if len(spots.px) < least:
        return Candidates(spots, np.empty((0, 2)), (), ())
    spots_m = plane.from_px(spots.px)
    found = placements(pattern.positions_m, spots_m, least=least, reach_m=pattern.reach_m)
    if not chiral:
        return Candidates(spots, spots_m, tuple(found), ())
    mirrored = placements(
        pattern.positions_m * [-1.0, 1.0], spots_m, least=least, reach_m=pattern.reach_m
    )
    return Candidates(spots, spots_m, tuple(found), tuple(mirrored))


def fit_pattern(
    image: Image, plane: MeasuringPlane, pattern: Pattern, placement: Placement, spots_m: Array
) -> PatternFit | None:
    """Measure every feature near its place; None when too few of them are clean."""
    placed = pattern.positions_m @ rotation(placement.yaw_rad).T + placement.shift_m
    starts = np.where(placement.spot[:, None] >= 0, spots_m[placement.spot], placed)
    radius_m = pattern.diameter_m / 2.0
    search = partial(circle_near, image, plane, bright=pattern.bright)
    coarse = [search(start, radius_m, sigma=_PRIOR, share=_COARSE) for start in starts]
    radii = [c.radius_m for c in coarse if c is not None and c.support > _SUPPORT]
    if len(radii) < 3:
        return None
    # All contacts are made on one machine and lit by one ring. The radius that they show here is a
    # better guess for each of them than the drawing, which knows neither light nor blur.
    alike_m = float(np.median(radii))
    begins = [
        start if circle is None else circle.centre_m
        for start, circle in zip(starts, coarse, strict=True)
    ]
    fine = [search(begin, alike_m, sigma=_ALIKE, share=_FINE) for begin in begins]
    fine = _found_again(image, plane, pattern, fine, alike_m)
    if pattern.chamfer_m > 0:
        fine = [_tip(image, plane, pattern, circle) for circle in fine]
    features = _features(image, plane, pattern, fine, starts)
    points = np.full((len(features), 2), np.nan)
    covariances = np.tile(np.eye(2), (len(features), 1, 1))
    for index, feature in enumerate(features):
        if feature.clean and feature.circle is not None:
            points[index] = feature.circle.centre_m
            covariances[index] = feature.circle.covariance_m2
    fit = fit_planar(pattern.positions_m, points, covariances, pattern.true_position_m)
    if fit is None:
        return None
    fit = _with_common_light(fit, _COMMON_PX * plane.m_per_px(fit.shift_m))
    return PatternFit(_with_all_residuals(fit, features, pattern), features)


def _found_again(
    image: Image,
    plane: MeasuringPlane,
    pattern: Pattern,
    circles: list[Circle | None],
    radius_m: float,
) -> list[Circle | None]:
    """Circles whose edges scatter far more than the others', anew from where the others put them.

    A search that began beside its contact has met other edges than the rim.
    """
    scatters = [circle.scatter_m for circle in circles if circle is not None]
    lost = [c is not None and c.scatter_m > _LOST * float(np.median(scatters)) for c in circles]
    points = np.array(
        [
            [np.nan] * 2 if c is None or away else c.centre_m
            for c, away in zip(circles, lost, strict=True)
        ]
    )
    equal = np.tile(np.eye(2) * pattern.true_position_m**2, (len(points), 1, 1))
    fit = fit_planar(pattern.positions_m, points, equal, pattern.true_position_m)
    if fit is None or not any(lost):
        return circles
    placed = pattern.positions_m @ rotation(fit.yaw_rad).T + fit.shift_m
    search = partial(circle_near, image, plane, sigma=_ALIKE, share=_FINE, bright=pattern.bright)
    return [
        search(start=place, radius_m=radius_m) if away else circle
        for circle, place, away in zip(circles, placed, lost, strict=True)
    ]


def surplus(
    image: Image,
    plane: MeasuringPlane,
    pattern: Pattern,
    candidates: Candidates,
    outline_m: tuple[float, float],
) -> int:
    """Clean features of the right size within the outline that the drawing does not have."""
    best = candidates.placements[0]
    turn = rotation(best.yaw_rad)
    places = (candidates.spots_m - best.shift_m) @ turn
    inside = np.all(np.abs(places) < np.array(outline_m) / 2.0, axis=1)
    matched = best.spot[best.spot >= 0]
    # One contact may be seen as two spots, whose middles lie within it.
    apart = np.linalg.norm(candidates.spots_m[:, None] - candidates.spots_m[matched], axis=2)
    inside &= apart.min(axis=1) > pattern.diameter_m / 2.0
    # Scratches and reflections are weaker than contacts; a contact too many is as strong.
    typical = float(np.median(candidates.spots.contrast[matched]))
    inside &= candidates.spots.contrast > 0.5 * typical
    count = 0
    for place in candidates.spots_m[inside]:
        radius_m = pattern.diameter_m / 2.0
        circle = circle_near(
            image, plane, place, radius_m, sigma=_PRIOR, share=_FINE, bright=pattern.bright
        )
        count += circle is not None and circle.support > 0.8
    return count


def _tip(
    image: Image, plane: MeasuringPlane, pattern: Pattern, circle: Circle | None
) -> Circle | None:
    if circle is None:
        return None
    flat_radius = 1.0 - 2.0 * pattern.chamfer_m / pattern.diameter_m
    tip = fit_tip(
        image,
        plane,
        circle,
        flat_radius=flat_radius,
        depth_m=pattern.chamfer_m,
        length_m=pattern.length_m,
    )
    return circle if tip is None else tip


def _features(
    image: Image,
    plane: MeasuringPlane,
    pattern: Pattern,
    circles: list[Circle | None],
    starts: Array,
) -> tuple[Feature, ...]:
    slopes = [circle.slope_grey for circle in circles if circle is not None]
    typical = float(np.median(slopes)) if slopes else 0.0
    return tuple(
        Feature(
            name,
            circle,
            contrast_across(
                image,
                plane,
                start if circle is None else circle.centre_m,
                pattern.diameter_m,
                bright=pattern.bright,
            ),
            circle is not None
            and circle.support >= _SUPPORT
            and circle.slope_grey >= _STRENGTH * typical,
        )
        for name, circle, start in zip(pattern.names, circles, starts, strict=True)
    )


def _with_common_light(fit: PlanarFit, sigma_m: float) -> PlanarFit:
    """The fit with the error added that moves all features together, which the fit of one against
    another cannot see."""
    common = np.diag([sigma_m**2, sigma_m**2, 0.0])
    return replace(fit, covariance=fit.covariance + common)


def _with_all_residuals(
    fit: PlanarFit, features: tuple[Feature, ...], pattern: Pattern
) -> PlanarFit:
    """Residuals also of circles that the fit did not use: where a dirty contact seems to be."""
    residuals = fit.residuals_m.copy()
    turn = rotation(fit.yaw_rad)
    for index, feature in enumerate(features):
        if feature.circle is not None:
            placed = turn @ pattern.positions_m[index] + fit.shift_m
            residuals[index] = (feature.circle.centre_m - placed) @ turn
    return replace(fit, residuals_m=residuals)
