"""A patch of pixels as points of a plane: exact over a hole."""

import numpy as np

from cellctl.vision.camera.lens import project
from cellctl.vision.camera.plane_patch import plane_basis, plane_patch, to_plane
from tests.unit.vision.plates import plate_facing, table_1_head

HEAD = table_1_head()


def test_plane_patch_is_exact_over_a_hole_and_a_circle_is_a_circle_there() -> None:
    camera_T_part = plate_facing(30.0, -40.0, 8.0)
    normal = -camera_T_part.rotation.apply([0.0, 0.0, 1.0])
    centre = camera_T_part.apply([0.02, 0.03, 0.0])
    angles = np.linspace(0, 2 * np.pi, 50)
    ring = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(50)]) * 3e-3
    pixels = project(HEAD.left, camera_T_part.apply(ring + np.array([0.02, 0.03, 0.0])))
    middle = project(HEAD.left, centre[None])[0]
    patch = plane_patch(HEAD.left, normal, plane_basis(normal), middle, 40.0)
    points, jacobian = patch.from_px(pixels[:, 0], pixels[:, 1])
    exact = to_plane(HEAD.left, pixels, normal, patch.basis).T
    assert np.abs(points - exact).max() / patch.unit_px < 1e-5
    distance = float(normal @ centre)
    flat = patch.basis @ centre / distance
    radii = np.linalg.norm(points - flat[:, None], axis=0) * distance
    assert np.abs(radii - 3e-3).max() < 1e-9
    moved, _ = patch.from_px(pixels[:1, 0] + 0.01, pixels[:1, 1])
    assert np.allclose((moved - points[:, :1])[:, 0] / 0.01, jacobian[:, 0, 0], rtol=1e-3)
    assert np.abs(patch.to_px(points.T) - pixels).max() < 1e-5
