"""Specks of dirt: flat, irregular, dark or bright."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.render.connectors.canvas import ColouredPatch
from fakes.render.connectors.look import ConnectorLook
from fakes.render.optics.canvas import Patch, margin_px
from fakes.render.optics.coverage import coverage
from fakes.render.optics.lattice import window_around
from fakes.render.optics.lens import View
from fakes.render.optics.surface import surface_map, to_pixels
from fakes.world.connector.drawing import Colour
from fakes.world.connector.scene import SceneDirt

_LARGEST = 1.5
"""Radius of the outline at its highest wave, of the speck's."""
_COLOUR: Colour = (1.0, 0.95, 0.88)


def dirt_patch(
    view: View, pose: RigidTransform, speck: SceneDirt, look: ConnectorLook
) -> ColouredPatch | None:
    """One speck in the plane of its own height; None outside of the image."""
    x0, y0, z0 = speck.position_m
    reach = _LARGEST * speck.radius_m
    corners = np.array([[x0 + u * reach, y0 + v * reach, z0] for u in (-1, 1) for v in (-1, 1)])
    blur_px = view.lens.blur_px
    pixels = to_pixels(view, pose, corners)
    window = window_around(view, pixels, margin_px(blur_px), look.sensor.sub_samples)
    if window is None:
        return None
    x, y = surface_map(view, pose, window, z_m=z0)
    angle = np.arctan2(y - y0, x - x0) - speck.turn_rad
    two, three = speck.waves
    radius = speck.radius_m * (1 + two * np.cos(2 * angle) + three * np.cos(3 * angle))
    cover = speck.opacity * (1 - coverage(np.hypot(x - x0, y - y0) - radius))
    level = look.exposure * speck.level
    return ColouredPatch(Patch.of_one_grey(window, 1 - cover, level, blur_px), _COLOUR)
