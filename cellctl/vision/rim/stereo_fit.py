"""The rim of one hole, measured in both images of a head: the entry to this package."""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.camera.ellipse import Ellipse, ellipse_of_circle
from cellctl.vision.camera.triangulation import joint_covariance
from cellctl.vision.features.hole import Hole
from cellctl.vision.rim.covariance import RatedFit, with_covariance
from cellctl.vision.rim.fit_input import RimFitInput, fit_input
from cellctl.vision.rim.roi import RADIUS_TOLERANCE, LocatedRim, RimRoi
from cellctl.vision.rim.selection import (
    SIGNIFICANT_GAIN,
    ScoreTests,
    SelectedFit,
    fit_single_image,
    fit_two_edges,
)
from cellctl.vision.rim.shape import RimShape
from cellctl.vision.rim.solver import RimFit
from cellctl.vision.rim.spread import ImageSpread

_LEAST_RING_PX = 2.0
"""Width that the band of pixels allows for a ring, however narrow it is thought to be."""
_FLOOR_PX = 5e-4
"""Lens model and pixel response limit every centre to about this."""
_MIN_CONTRAST_GREY = 8.0
"""Least step of the grey between inside and outside of a rim."""
_MAX_MOVE_PX = 2.5
"""A fit that ends farther than this from the located edges has found something else."""
_RINGED_RADIUS_TOLERANCE = 0.035
"""Largest relative difference from the nominal size when two edges were fitted: beyond it the
edges are exchanged."""
_MAX_SIGMA_PX = 0.2
"""Largest standard deviation of a centre that is reported at all."""


@dataclass(frozen=True, slots=True, eq=False)
class Rim:
    """A rim measured in one image."""

    point_px: Array
    """Raw pixel onto which the centre of the circle projects, shape (2,)."""
    covariance_px2: Array
    """Shape (2, 2)."""
    ellipse: Ellipse
    """The rim in the raw image, for pictures."""
    size_ratio: float
    """Measured over nominal diameter, if the plane's distance is right."""
    blur_px: float
    misfit: float
    """As in ``RatedFit``."""
    left_out: float = 0.0
    """Share of the rim that is off its circle and has left the fit."""


@dataclass(frozen=True, slots=True, eq=False)
class RimPair:
    """One rim in both images."""

    left: Rim
    right: Rim
    covariance_px2: Array
    """Joint covariance of both points, left first, shape (4, 4)."""
    singles: tuple[RimFit, RimFit]
    """Fits of each image by itself: they show its spread."""
    one_edge: bool
    """Whether these fits are the result: a second edge looks like a spread."""


class StereoEvidence:
    """The evidence of fits with one edge, as ``RimEvidence`` describes it."""

    def __init__(
        self, given: tuple[RimFitInput, RimFitInput], fits: tuple[SelectedFit, SelectedFit]
    ) -> None:
        self._given, self._fits = given, [selected.fit for selected in fits]

    @property
    def hole(self) -> Hole:
        """The hole as the drawing gives it."""
        return self._given[0].roi.hole

    @property
    def clear_px(self) -> tuple[float, float]:
        """Distance to the next edge outside the rim, left and right; infinite when none is near."""
        return self._given[0].clear_px, self._given[1].clear_px

    def in_radii(self, length_px: float, image: int = 0) -> float:
        """A length in one image (0 left, 1 right) over the radius of the rim there."""
        given = self._given[image]
        return length_px * given.patch.unit_px / given.radius

    def arcs_left_out(self) -> bool:
        """Whether arcs that are off the circle have left the fit of an image."""
        return any(fit.solution.noise.left_out.any() for fit in self._fits)

    def both_converged(self) -> bool:
        """Whether the fits of both images settled."""
        return all(fit.converged for fit in self._fits)

    def ring_gains(self) -> tuple[float, float]:
        """Fall of chi square, left and right, if a narrow ring of another grey were modelled."""
        left, right = (ScoreTests(fit).ring_gain() for fit in self._fits)
        return left, right

    def ring_seen(self) -> bool:
        """Whether a narrow ring explains more than chance in at least one image."""
        return max(self.ring_gains()) > SIGNIFICANT_GAIN

    def uneven_inside(self) -> bool:
        """Whether the inside is uneven by more than chance in at least one image."""
        return any(ScoreTests(fit).uneven_inside() for fit in self._fits)


def measure_rims(
    rois: tuple[RimRoi, RimRoi],
    located: tuple[LocatedRim, LocatedRim],
    blur_px: tuple[float, float] | None,
    spreads: tuple[ImageSpread, ImageSpread],
) -> RimPair:
    """Measure a located rim, left image first; its plane must be known to about a degree.

    ``blur_px`` is the blur of other rims in these images, where there are any. Raises
    ``HoleMissing`` when a fit is no measurement of this rim.
    """
    kind = rois[0].kind
    given = _fit_inputs(rois, located, spreads, kind.first_ring_px)
    fits = fit_single_image(given[0]), fit_single_image(given[1])
    # Both single fits come first even where a second edge is likely: they are the evidence by which
    # the kind decides, and for a rim with one edge they are already the result.
    second = kind.second_edge(StereoEvidence(given, fits))
    if second is None:
        return _from_single_fits(given, fits)
    ring_px = max(_LEAST_RING_PX, second.width * given[0].radius / given[0].patch.unit_px)
    given = _fit_inputs(rois, located, spreads, ring_px)
    return _from_joint_fit(given, fit_two_edges(given, second, blur_px, _wall_ratio(fits)), fits)


def _wall_ratio(fits: tuple[SelectedFit, SelectedFit]) -> float | None:
    """The deeper of the walls that single fits have found; None where they found none."""
    ratios = (selected.fit.shapes[0].wall_ratio for selected in fits)
    return max((ratio for ratio in ratios if ratio), default=None)


def refuse_too_uncertain(rois: tuple[RimRoi, RimRoi], rims: RimPair) -> None:
    """Raise ``HoleMissing`` when the grey values leave a centre open.

    That happens where there is no contrast between the rim and what lies beside it.
    """
    for roi, rim in zip(rois, (rims.left, rims.right), strict=True):
        sigma_px = float(np.sqrt(np.linalg.eigvalsh(rim.covariance_px2)[-1]))
        if sigma_px > _MAX_SIGMA_PX:
            raise roi.refusal(
                f"centre known to {sigma_px:.2f} px only, allowed {_MAX_SIGMA_PX:.2f} px"
            )


def _fit_inputs(
    rois: tuple[RimRoi, RimRoi],
    located: tuple[LocatedRim, LocatedRim],
    spreads: tuple[ImageSpread, ImageSpread],
    ring_px: float | None,
) -> tuple[RimFitInput, RimFitInput]:
    left, right = (
        fit_input(roi, place, spread, ring_px)
        for roi, place, spread in zip(rois, located, spreads, strict=True)
    )
    return left, right


def _from_single_fits(
    given: tuple[RimFitInput, RimFitInput], fits: tuple[SelectedFit, SelectedFit]
) -> RimPair:
    """Fits of each image by itself: the errors of both points are independent."""
    left, right = (
        _rim(one, with_covariance(chosen.fit, chosen.spread), 0, RADIUS_TOLERANCE)
        for one, chosen in zip(given, fits, strict=True)
    )
    joint = joint_covariance(left.covariance_px2, right.covariance_px2)
    return RimPair(left, right, joint, _fits(fits), one_edge=True)


def _fits(selected: tuple[SelectedFit, SelectedFit]) -> tuple[RimFit, RimFit]:
    left, right = selected
    return left.fit, right.fit


def _from_joint_fit(
    given: tuple[RimFitInput, RimFitInput],
    chosen: SelectedFit,
    singles: tuple[SelectedFit, SelectedFit],
) -> RimPair:
    """One fit of both images: what they share makes the errors of both points hang together."""
    rated = with_covariance(chosen.fit, chosen.spread)
    left, right = (
        _rim(one, rated, index, _RINGED_RADIUS_TOLERANCE) for index, one in enumerate(given)
    )
    jacobian = np.zeros((4, 4))
    for index, (one, shape) in enumerate(zip(given, rated.shapes, strict=True)):
        part = slice(2 * index, 2 * index + 2)
        jacobian[part, part] = one.patch.px_by_point(shape.centre)
    joint = jacobian @ rated.covariance[:4, :4] @ jacobian.T + np.eye(4) * _FLOOR_PX**2
    return RimPair(left, right, joint, _fits(singles), one_edge=False)


def _rim(given: RimFitInput, rated: RatedFit, index: int, size_tolerance: float) -> Rim:
    """The rim in one image, in raw pixels, from a fit; ``index`` is that of its view."""
    shape, part = rated.shapes[index], slice(2 * index, 2 * index + 2)
    _refuse_no_rim(given, rated, shape, size_tolerance)
    jacobian = given.patch.px_by_point(shape.centre)
    point_px = given.patch.to_px(shape.centre[None])[0]
    covariance_px2 = jacobian @ rated.covariance[part, part] @ jacobian.T
    return Rim(
        point_px=point_px,
        covariance_px2=covariance_px2 + np.eye(2) * _FLOOR_PX**2,
        ellipse=ellipse_of_circle(point_px, jacobian * shape.radius),
        size_ratio=shape.radius / given.roi.nominal_radius,
        blur_px=shape.blur_px,
        misfit=rated.misfit,
        left_out=rated.fit.solution.noise.share_left_out,
    )


def _refuse_no_rim(
    given: RimFitInput, rated: RatedFit, shape: RimShape, size_tolerance: float
) -> None:
    """Raise ``HoleMissing`` when a fit is no measurement of the rim."""
    moved_px = float(np.linalg.norm(shape.centre - given.centre)) / given.patch.unit_px
    off_size = abs(shape.radius / given.roi.nominal_radius - 1.0)
    if not rated.fit.converged:
        raise given.roi.refusal("fit of the rim did not settle")
    if abs(rated.contrast_grey) < _MIN_CONTRAST_GREY:
        raise given.roi.refusal("too little contrast at the rim")
    if moved_px > _MAX_MOVE_PX or off_size > size_tolerance:
        raise given.roi.refusal("fitted rim does not have the nominal size and place")
