"""Pins seen nearly end-on: flat or domed tip, chamfer, wall.

A bent pin leans from its root to its tip. In coordinates that lean with it it is a straight one,
and rays are still straight lines. Depth 0 is the shoulder, where the full section begins: its
outline is what one sees of a pin, so the truth of a contact lies there and not at its very end.
"""

import numpy as np

from fakes.render.bodies.rays import Rays
from fakes.render.connectors.canvas import ColouredPatch
from fakes.render.connectors.look import ConnectorLook
from fakes.render.connectors.shading import Shading
from fakes.render.optics.canvas import Patch, margin_px
from fakes.render.optics.coverage import coverage
from fakes.render.optics.lattice import window_around
from fakes.render.optics.lens import Array, View
from fakes.render.optics.surface import to_pixels
from fakes.world.connector.scene import GOLD, SceneConnector, SceneContact

FLAT_SHARE = 0.6
"""Radius of the flat of a chamfered tip, of the pin's."""
_DOME_SHARE = 0.7
"""Height of a domed tip, of the pin's radius."""
_WALL_FADE_M = 2.5e-3


def pin_patch(
    view: View,
    connector: SceneConnector,
    contact: SceneContact,
    look: ConnectorLook,
    shading: Shading,
) -> ColouredPatch | None:
    """One pin as the camera sees it; None when it is missing or outside of the image."""
    if not contact.present:
        return None
    pose, radius_m = connector.camera_T_connector, connector.drawing.pin_diameter_m / 2
    length_m = connector.drawing.pin_length_m
    outline = np.vstack(
        [
            _circle(contact.centre_m, radius_m, 0.0),
            _circle(contact.root_m, radius_m, -length_m),
        ]
    )
    blur_px = view.lens.blur_px
    pixels = to_pixels(view, pose, outline)
    window = window_around(view, pixels, margin_px(blur_px), look.sensor.sub_samples)
    if window is None:
        return None
    upright = Rays.through(view, pose, window, centre_m=contact.centre_m, depth_m=length_m)
    lean_x, lean_y = (bend / length_m for bend in contact.bend_m)
    rays = Rays(upright.x, upright.y, upright.slope_x + lean_x, upright.slope_y + lean_y)
    tip = _chamfered if connector.tip == "chamfer" else _domed
    inside, shade = tip(rays, radius_m, shading)
    wall = _wall_cover(rays, radius_m, length_m) * (1 - inside)
    wall_shade = _wall_shade(rays, radius_m, length_m, shading) * look.wall_light
    level = look.exposure * contact.shine
    grey = level * (inside * shade + wall * wall_shade)
    return ColouredPatch(Patch.from_cells(window, 1 - inside - wall, grey, blur_px), GOLD)


def _chamfered(rays: Rays, radius_m: float, shading: Shading) -> tuple[Array, Array]:
    """Covered share and brightness there; the chamfer has 45°."""
    flat_m = FLAT_SHARE * radius_m
    height_m = radius_m - flat_m
    flat = 1 - coverage(rays.radius(-height_m) - flat_m)
    whole = np.maximum(flat, 1 - coverage(rays.radius(0.0) - radius_m))
    depth = np.full_like(flat, -height_m)
    for _ in range(2):  # contraction by the slope of the rays, below a tenth
        depth = np.clip(rays.radius(depth) - radius_m, -height_m, 0.0)
    x, y = _outwards(rays, depth)
    cone = shading.at(np.sqrt(0.5) * x, np.sqrt(0.5) * y, np.sqrt(0.5))
    share = flat / np.maximum(whole, 1e-12)
    return whole, share * shading.flat() + (1 - share) * cone


def _domed(rays: Rays, radius_m: float, shading: Shading) -> tuple[Array, Array]:
    """The same for half an ellipsoid."""
    height_m = _DOME_SHARE * radius_m
    whole = 1 - coverage(rays.radius(0.0) - radius_m)
    depth = np.full_like(whole, -height_m)
    for _ in range(4):
        rho = np.minimum(rays.radius(depth) / radius_m, 1.0)
        depth = -height_m * np.sqrt(1 - rho**2)
    x, y = rays.at(depth)
    normal = np.stack([x / radius_m**2, y / radius_m**2, -depth / height_m**2])
    normal /= np.maximum(np.linalg.norm(normal, axis=0), 1e-12)
    return whole, shading.at(*normal)


def _wall_cover(rays: Rays, radius_m: float, length_m: float) -> Array:
    """Share of each cell whose ray passes the cylinder below the tip."""
    steep = rays.slope_x**2 + rays.slope_y**2 + 1e-12
    nearest = -(rays.x * rays.slope_x + rays.y * rays.slope_y) / steep
    depth = np.clip(nearest, 0.0, length_m)
    return 1 - coverage(rays.radius(depth) - radius_m)


def _wall_shade(rays: Rays, radius_m: float, length_m: float, shading: Shading) -> Array:
    """Darker towards the root, where the other pins and the shell take the light."""
    a = rays.slope_x**2 + rays.slope_y**2 + 1e-12
    b = rays.x * rays.slope_x + rays.y * rays.slope_y
    c = rays.x**2 + rays.y**2 - radius_m**2
    # The smaller solution of |p + d s|² = r²: rays come from outside.
    depth = (-b - np.sqrt(np.maximum(b * b - a * c, 0.0))) / a
    depth = np.clip(depth, 0.0, length_m)
    return np.exp(-depth / _WALL_FADE_M) * shading.at(*_outwards(rays, depth), 0.0)


def _outwards(rays: Rays, depth: Array) -> tuple[Array, Array]:
    """Unit vector from the axis to where a ray is."""
    x, y = rays.at(depth)
    length = np.maximum(np.hypot(x, y), 1e-12)
    return x / length, y / length


def _circle(centre_m: tuple[float, float], radius_m: float, z_m: float) -> Array:
    angle = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    x, y = centre_m
    return np.column_stack(
        [x + radius_m * np.cos(angle), y + radius_m * np.sin(angle), np.full(32, z_m)]
    )
