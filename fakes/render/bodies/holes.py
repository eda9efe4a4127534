"""Holes with depth: the surfaces that are seen inside their rim.

The wall is the cylinder between the face and the plane of the hole's end; each camera sees the
side of the wall that is turned to it.
"""

from typing import Final

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.render.bodies.rays import Rays
from fakes.render.optics.canvas import Patch, margin_px
from fakes.render.optics.coverage import coverage
from fakes.render.optics.lattice import Window, window_around
from fakes.render.optics.lens import Array, View
from fakes.render.optics.surface import surface_map, to_pixels
from fakes.render.options import RenderOptions
from fakes.world.scene import SceneHole, ScenePlate

CHAMFER: Final = 1.12
"""Outer diameter of a thread's chamfer over its bore."""
THREAD_PITCH_M: Final = 0.8e-3
_CREST: Final = 0.84
"""Diameter over the thread's crests, of the bore."""
_TURNS: Final = 7
"""Turns that are drawn; deeper ones cannot be seen."""
_WALL_FADE_M: Final = 7e-3
_THREAD_FADE_M: Final = 3e-3


def outer_diameter(hole: SceneHole) -> float:
    """Diameter of the outermost visible rim, m."""
    if hole.kind == "countersink":
        return hole.countersink_m if hole.countersink_m else 2 * hole.diameter_m
    return CHAMFER * hole.diameter_m if hole.kind == "thread" else hole.diameter_m


def rim_depth(hole: SceneHole, options: RenderOptions) -> float:
    """Depth below the face of the rim that carries the centre, m; a 90° cone leads down to it."""
    if not options.recessed_rims:
        return 0.0
    return (outer_diameter(hole) - hole.diameter_m) / 2


def circle(hole: SceneHole, diameter_m: float, depth_m: float, points: int = 48) -> Array:
    """Points of a rim in the frame of the part, shape (points, 3)."""
    angle = np.linspace(0, 2 * np.pi, points, endpoint=False)
    x = hole.position_m[0] + diameter_m / 2 * np.cos(angle)
    y = hole.position_m[1] + diameter_m / 2 * np.sin(angle)
    return np.column_stack([x, y, np.full(points, -depth_m)])


def hole_patch(
    view: View,
    plate: ScenePlate,
    hole: SceneHole,
    options: RenderOptions,
    *,
    light_azimuth: float,
    blur_px: float,
    below: ScenePlate | None = None,
) -> Patch | None:
    """One hole as this camera sees it, or None when it is outside the image.

    ``light_azimuth`` is in the head frame; ``below`` is the part seen through the hole, if any.
    """
    pose = plate.camera_T_part
    rim = to_pixels(view, pose, circle(hole, outer_diameter(hole), 0.0))
    # Only the neighbourhood of a hole is divided into fine cells, because their number decides the
    # time that a picture takes.
    window = window_around(view, rim, margin_px(blur_px), options.sub_samples)
    if window is None:
        return None
    rays = Rays.through(view, pose, window, centre_m=hole.position_m, depth_m=hole.depth_m)
    azimuth = _azimuth_in_part(pose, light_azimuth)
    visible = 1 - coverage(rays.radius(0.0) - outer_diameter(hole) / 2)
    through = 1 - visible
    grey = np.zeros_like(visible)
    depth_m = rim_depth(hole, options)
    radius_m = hole.diameter_m / 2
    if hole.kind != "pin":
        ring = coverage(rays.radius(depth_m) - radius_m)
        grey += visible * ring * _ring_grey(rays, hole, options, azimuth)
        # Surfaces follow from front to back: each takes its share of what is still visible, and
        # leaves the rest.
        visible = visible * (1 - ring)
    if hole.kind == "thread":
        visible = _thread(rays, hole, options, azimuth, visible=visible, grey=grey)
        radius_m *= _CREST
    wall = coverage(rays.radius(hole.depth_m) - radius_m)
    grey += visible * wall * _wall_grey(rays, radius_m, hole.depth_m, options, azimuth)
    grey += visible * (1 - wall) * _bottom_grey(view, hole, window, options, below)
    return Patch.from_cells(window, through, grey, blur_px)


def _azimuth_in_part(pose: RigidTransform, azimuth: float) -> float:
    x, y, _ = pose.rotation.inv().apply([np.cos(azimuth), np.sin(azimuth), 0.0])
    return float(np.arctan2(y, x))


def _ring_grey(rays: Rays, hole: SceneHole, options: RenderOptions, azimuth: float) -> Array:
    """Countersink or chamfer: a cone in uneven light, with the marks of its cutter."""
    angle = np.arctan2(rays.y, rays.x) - azimuth
    radius = rays.radius(0.0)
    tone = 0.7 * np.cos(angle) + 0.3 * np.cos(2 * angle)
    marks = 0.12 * np.sin(2 * np.pi * radius / 0.31e-3) * (hole.kind == "countersink")
    return np.asarray(options.cone_grey * (1 + options.cone_contrast * (tone + marks)))


def _wall_grey(
    rays: Rays, radius_m: float, depth_m: float, options: RenderOptions, azimuth: float
) -> Array:
    """Bore wall: brightest at the rim and where it faces the light."""
    depth = np.minimum(rays.wall_depth(radius_m), depth_m)
    angle = np.arctan2(rays.y + depth * rays.slope_y, rays.x + depth * rays.slope_x)
    tone = np.exp(-depth / _WALL_FADE_M) * (0.85 - 0.25 * np.cos(angle - azimuth))
    return np.asarray(options.dark_grey + (options.wall_grey - options.dark_grey) * tone)


def _thread(
    rays: Rays,
    hole: SceneHole,
    options: RenderOptions,
    azimuth: float,
    *,
    visible: Array,
    grey: Array,
) -> Array:
    """Add the flanks of the turns to ``grey``; return what part of each cell looks past them.

    The thread is a helix of crests that fades in behind the chamfer, as a tap leaves it.
    """
    angle = np.arctan2(rays.y, rays.x)
    turn = np.mod((angle - hole.thread_begins_rad + np.pi) / (2 * np.pi), 1.0)
    lit = 0.75 - 0.25 * np.cos(angle - azimuth)
    root_m = hole.diameter_m / 2
    for number in range(_TURNS):
        # The depth of the crest grows with the azimuth, as on a helix. Drawn as rings the turns
        # would look alike on all sides, which those of a tapped thread do not.
        depth = np.maximum(THREAD_PITCH_M * (number - 0.5 + turn), 0.0)
        full = np.minimum(depth / (1.5 * THREAD_PITCH_M), 1.0)
        crest_m = root_m * (1 - (1 - _CREST) * full)
        radius = rays.radius(depth)
        flank = coverage(radius - crest_m)
        height = np.clip((root_m - radius) / (root_m * (1 - _CREST)), 0.0, 1.0)
        tone = lit * height * np.exp(-depth / _THREAD_FADE_M)
        level = options.thread_root_grey + (options.thread_grey - options.thread_root_grey) * tone
        grey += visible * flank * level
        visible = visible * (1 - flank)
    return visible


def _bottom_grey(
    view: View, hole: SceneHole, window: Window, options: RenderOptions, below: ScenePlate | None
) -> Array:
    """Bottom of a blind hole, or what lies under a through hole: the other part in deep shadow."""
    bottom = np.full((window.height * window.sub, window.width * window.sub), options.dark_grey)
    if below is None or not hole.through:
        return bottom
    x, y = surface_map(view, below.camera_T_part, window)
    # Little light comes through a hole of this size onto the part below.
    shadowed = 0.22 * options.plate_grey
    bottom += (shadowed - options.dark_grey) * (options.wall_grey > options.dark_grey)
    for other in below.holes:
        offset_x, offset_y = x - other.position_m[0], y - other.position_m[1]
        inside = 1 - coverage(np.hypot(offset_x, offset_y) - other.diameter_m / 2)
        bottom += inside * (options.dark_grey - bottom)
    return bottom
