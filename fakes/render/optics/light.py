"""Uneven light: a gradient that belongs to the lamp, a highlight and vignetting of each camera."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.render.optics.canvas import Image
from fakes.render.optics.lattice import expand_single
from fakes.render.optics.lens import Array, View, undistort
from fakes.render.optics.surface import meet_surface
from fakes.render.options import RenderOptions

_HIGHLIGHT_WIDTH_M = 0.12
_DEEPEST = 0.8
"""The gradient levels off at this relative change."""


def light_direction(light_seed: int) -> float:
    """Azimuth in the head frame towards which the light grows, rad."""
    return float(np.random.default_rng([light_seed, 1]).uniform(0, 2 * np.pi))


def light_field(
    view: View, head_T_surface: RigidTransform, light_seed: int, options: RenderOptions
) -> Image:
    """Relative brightness of every pixel on a surface, gain included; shape of the image."""
    azimuth = light_direction(light_seed)
    phase, *highlight = np.random.default_rng([light_seed, 2, view.side == "left"]).uniform(
        -1, 1, 3
    )
    view_T_surface = view.view_T_head * head_T_surface
    surface_T_axis = head_T_surface.inv()
    axis = surface_T_axis.rotation.apply([np.cos(azimuth), np.sin(azimuth), 0.0])[:2]
    width, height = view.size_px
    middle = np.array([(width - 1) / 2, (height - 1) / 2])
    centre = meet_surface(view_T_surface, undistort(view.lens, middle[None]), 0.0)[0]
    # Towards the camera, in the axes of the surface: a mirror throws the light of the lamp, which
    # sits beside the camera, back from where the surface faces it.
    towards = -view_T_surface.rotation.as_matrix()[2]
    mirrored = options.mirror * float(view_T_surface.translation[2]) * towards[:2] / towards[2]
    lamp_centre = -(head_T_surface.rotation.as_matrix().T @ head_T_surface.translation)[:2]

    def relative(pixels: Array) -> Array:
        points = meet_surface(view_T_surface, undistort(view.lens, pixels), 0.0)
        along = (points - lamp_centre) @ axis
        # A plain line would make the light negative at the far end of a large part.
        lamp = 1 + _DEEPEST * np.tanh(options.light_gradient_per_m * along / _DEEPEST)
        lamp += options.light_ripple * np.sin(2 * np.pi * along / options.light_ripple_m)
        # A highlight is a reflection and lies elsewhere for each camera, so no measurement may take
        # the light for the same in both.
        spot = points - centre - mirrored - 0.06 * np.array(highlight)
        lamp += options.gloss * np.exp(-0.5 * (spot[:, 0] / _HIGHLIGHT_WIDTH_M) ** 2)
        lamp += 0.2 * options.gloss * np.cos(spot[:, 1] / _HIGHLIGHT_WIDTH_M + phase)
        radius2 = ((pixels - middle) ** 2).sum(axis=1) / (middle**2).sum()
        return np.asarray((lamp * (1 - options.vignetting * radius2) * view.lens.gain)[:, None])

    return expand_single(view, relative)[0]
