"""One scale of uncertainty for each image, from the residuals of all its rims.

What the model leaves out of a lens, a lamp or a sensor disturbs all rims of an image. One rim shows
that only roughly, because its residuals have few independent parts; all rims together show it well.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cellctl.vision.rim.stereo_fit import Rim, RimPair

_CHANCE = 1.6
"""The median over three rims stays below this in images that nothing disturbs as a whole."""


def with_image_scales(pairs: Sequence[RimPair]) -> list[RimPair]:
    """These rims with their covariances multiplied by the scales of their images."""
    left = image_scale([pair.left for pair in pairs])
    right = image_scale([pair.right for pair in pairs])
    return [_scaled(pair, left, right) for pair in pairs]


def image_scale(rims: Sequence[Rim]) -> float:
    """Factor on the variances of all rims of an image, at least 1.

    It is how much larger the residuals are than independent errors would make them. It comes on top
    of the widening by a rim's own residuals: residuals show only the part of an error that the fit
    could not absorb, and the rest of the same error has shifted the centres.
    """
    # The median: what disturbs the image shows in most of its rims. A burr or a reflex at one hole
    # is that hole's own, whose covariance has grown by it already.
    misfit = float(np.median([rim.misfit for rim in rims]))
    return misfit if misfit > _CHANCE else 1.0


def _scaled(pair: RimPair, left: float, right: float) -> RimPair:
    root = np.sqrt(np.repeat([left, right], 2))
    return replace(
        pair,
        left=replace(pair.left, covariance_px2=pair.left.covariance_px2 * left),
        right=replace(pair.right, covariance_px2=pair.right.covariance_px2 * right),
        covariance_px2=pair.covariance_px2 * np.outer(root, root),
    )
