"""Maps between pixels and surfaces: where a ray meets a surface, where a point is seen."""

from collections.abc import Callable
from typing import Final

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.render.optics.lattice import (
    NODES_WINDOW,
    Picture,
    Window,
    expand,
    expand_single,
    nodes_of,
)
from fakes.render.optics.lens import Array, View, project, undistort

_GRAZING: Final = 0.1
"""Least cosine between ray and face, roughly."""

Height = Callable[[Array, Array], Array]
"""Height of a surface over its x, y."""


def surface_map(
    view: View,
    head_T_surface: RigidTransform,
    window: Window,
    *,
    z_m: float | Height = 0.0,
    nodes: int = NODES_WINDOW,
) -> tuple[Array, Array]:
    """Surface coordinates x, y (m) seen by each cell centre, each of shape (rows, columns)."""
    view_T_surface = view.view_T_head * head_T_surface

    def coordinates(pixels: Array) -> Array:
        return meet_surface(view_T_surface, undistort(view.lens, pixels), z_m)

    x, y = expand(window, coordinates, nodes=nodes)
    return x, y


def face_map(view: View, head_T_surface: RigidTransform) -> tuple[Picture, Picture]:
    """Surface x, y of every pixel of the image in single precision: 1e-3 px, half the time."""
    view_T_surface = view.view_T_head * head_T_surface

    def coordinates(pixels: Array) -> Array:
        return meet_surface(view_T_surface, undistort(view.lens, pixels), 0.0)

    x, y = expand_single(view, coordinates)
    return x, y


def is_seen(view: View, head_T_surface: RigidTransform) -> bool:
    """True when every ray of the image meets the plane of a face from its front, not grazing."""
    view_T_surface = view.view_T_head * head_T_surface
    rotation = view_T_surface.rotation.as_matrix()
    rays = undistort(view.lens, nodes_of(Window.full(view), 4, edge=True))
    down = np.column_stack([rays, np.ones(len(rays))]) @ rotation[:, 2]
    in_front = float(-rotation[:, 2] @ view_T_surface.translation) > 0
    return in_front and float(down.max()) < -_GRAZING


def meet_surface(view_T_surface: RigidTransform, rays: Array, z_m: float | Height) -> Array:
    """Surface x, y (m) where rays (N, 2, normalised) meet z = ``z_m``; shape (N, 2)."""
    rotation = view_T_surface.rotation.as_matrix()
    # In the frame of the surface the plane is z = constant, so meeting it is one division.
    directions = np.column_stack([rays, np.ones(len(rays))]) @ rotation
    origin = -rotation.T @ view_T_surface.translation
    if origin[2] <= 0 or directions[:, 2].max() >= 0:
        raise ValueError("a surface is not seen from its front over the whole image")
    slope = directions[:, :2] / directions[:, 2:]
    if not callable(z_m):
        return np.asarray(origin[:2] + (z_m - origin[2]) * slope)
    height = np.zeros(len(rays))
    for _ in range(8):  # contraction by bow slope times ray slope, about 1e-3 each time
        points = origin[:2] + (height - origin[2])[:, None] * slope
        height = z_m(points[:, 0], points[:, 1])
    return np.asarray(origin[:2] + (height - origin[2])[:, None] * slope)


def to_pixels(view: View, head_T_surface: RigidTransform, points_m: Array) -> Array:
    """Pixels of points given in a surface's frame, shape (N, 3) to (N, 2)."""
    return project(view.lens, (view.view_T_head * head_T_surface).apply(points_m))
