"""Holes of a socket: funnel, bore, the contact at its bottom, and what may block it."""

import numpy as np

from fakes.render.bodies.rays import Rays
from fakes.render.connectors.canvas import ColouredPatch
from fakes.render.connectors.look import ConnectorLook
from fakes.render.connectors.shading import Shading
from fakes.render.optics.canvas import Patch, margin_px
from fakes.render.optics.coverage import coverage
from fakes.render.optics.lattice import Window, window_around
from fakes.render.optics.lens import Array, View
from fakes.render.optics.surface import to_pixels
from fakes.world.connector.drawing import Colour
from fakes.world.connector.scene import GOLD, SceneConnector, SceneContact

_BORE_DEPTHS = 2.5
"""Depth of the bore over its diameter, down to the contact."""
_CONTACT_SHARE = (0.45, 0.85)
"""Inner and outer radius of the contact's end, of the bore's."""
_DIRT: Colour = (0.30, 0.27, 0.22)


def hole_patches(
    view: View,
    connector: SceneConnector,
    contact: SceneContact,
    look: ConnectorLook,
    shading: Shading,
) -> list[ColouredPatch]:
    """Funnel and bore, then the contact at the bottom; empty outside of the image."""
    if not contact.present:
        return []
    drawing, pose = connector.drawing, connector.camera_T_connector
    blur_px = view.lens.blur_px
    angle = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    x, y = contact.centre_m
    rim = np.column_stack(
        [
            x + drawing.hole_m / 2 * np.cos(angle),
            y + drawing.hole_m / 2 * np.sin(angle),
            np.zeros(32),
        ]
    )
    pixels = to_pixels(view, pose, rim)
    window = window_around(view, pixels, margin_px(blur_px), look.sensor.sub_samples)
    if window is None:
        return []
    bottom_m = _BORE_DEPTHS * drawing.bore_m
    rays = Rays.through(view, pose, window, centre_m=contact.centre_m, depth_m=bottom_m)
    rim_cover = 1 - coverage(rays.radius(0.0) - drawing.hole_m / 2)
    bore = rim_cover * (1 - coverage(rays.radius(drawing.funnel_m) - drawing.bore_m / 2))
    funnel = (rim_cover - bore) * _funnel_shade(rays, connector, shading)
    depth = np.minimum(rays.wall_depth(drawing.bore_m / 2), bottom_m)
    wall = bore * look.hole_light * shading.flat() * np.exp(-depth / drawing.bore_m)
    grey = look.exposure * (funnel + wall)
    opening = Patch.from_cells(window, 1 - rim_cover, grey, blur_px)
    patches = [ColouredPatch(opening, drawing.insulator_colour)]
    if contact.blocked:
        plug = bore * look.exposure * 0.8 * shading.flat()
        return [*patches, _over(window, bore, plug, blur_px, _DIRT)]
    inner, outer = (share * drawing.bore_m / 2 for share in _CONTACT_SHARE)
    radius = rays.radius(bottom_m)
    ring = bore * (1 - coverage(radius - outer)) * coverage(radius - inner)
    level = look.exposure * look.hole_light * 0.5 * shading.flat() * contact.shine
    return [*patches, _over(window, ring, ring * level, blur_px, GOLD)]


def _over(
    window: Window, cover: Array, grey: Array, blur_px: float, colour: Colour
) -> ColouredPatch:
    return ColouredPatch(Patch.from_cells(window, 1 - cover, grey, blur_px), colour)


def _funnel_shade(rays: Rays, connector: SceneConnector, shading: Shading) -> Array:
    """A cone that opens towards the camera: its normals point to the axis."""
    drawing = connector.drawing
    x, y = rays.at(drawing.funnel_m / 2)
    length = np.maximum(np.hypot(x, y), 1e-12)
    width_m = (drawing.hole_m - drawing.bore_m) / 2
    slant = np.hypot(width_m, drawing.funnel_m)
    inwards = -drawing.funnel_m / slant
    return shading.at(inwards * x / length, inwards * y / length, width_m / slant)
