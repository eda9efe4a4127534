"""Looks for the rim of a round contact near a start, and how it stands out."""

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.antenna_module.vision.contact_fit.circle_fit import Circle, fit_circle
from cellctl.processes.antenna_module.vision.contact_fit.rim_edges import rim_edges
from cellctl.processes.antenna_module.vision.plane import MeasuringPlane


def circle_near(
    image: Image,
    plane: MeasuringPlane,
    start: Array,
    radius_m: float,
    *,
    sigma: float,
    share: float,
    bright: bool,
) -> Circle | None:
    """The rim near a start, its edges searched anew round the centre that was found."""
    px_m = plane.m_per_px(start)
    circle: Circle | None = None
    # The search looks along rays from the centre: with a start that is off, it meets the rim
    # aslant and weights its near side. A second round, from the centre found, is free of that.
    for _ in range(2):
        edges = rim_edges(image, plane, start, radius_m, share=share, bright=bright)
        if edges is None:
            return None
        circle = fit_circle(edges, start, radius_m, radius_sigma_m=sigma * radius_m, px_m=px_m)
        if circle is None or np.linalg.norm(circle.centre_m - start) > radius_m:
            return None
        start = circle.centre_m
    return circle


def contrast_across(
    image: Image, plane: MeasuringPlane, centre_m: Array, diameter_m: float, *, bright: bool
) -> float:
    """Median grey inside less outside, positive as it should be; 0 outside of the image."""
    angle = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    unit = np.column_stack([np.cos(angle), np.sin(angle)]) * diameter_m / 2.0
    levels: list[float] = []
    for share in (0.5, 1.5):
        pixels = np.rint(plane.to_px(centre_m + share * unit)).astype(int)
        height, width = image.shape
        if pixels.min() < 0 or pixels[:, 0].max() >= width or pixels[:, 1].max() >= height:
            return 0.0
        levels.append(float(np.median(image[pixels[:, 1], pixels[:, 0]])))
    difference = levels[0] - levels[1]
    return difference if bright else -difference
