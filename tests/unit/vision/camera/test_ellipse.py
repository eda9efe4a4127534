"""The image of a circle: against points of the circle."""

import numpy as np

from cellctl.vision.camera.ellipse import ellipse_of_circle
from cellctl.vision.camera.lens import project
from cellctl.vision.camera.plane_patch import plane_basis
from tests.unit.vision.plates import table_1_head

HEAD = table_1_head()


def test_the_ellipse_of_a_circle_lies_on_its_image() -> None:
    normal = np.array([0.3, -0.2, 0.93]) / np.linalg.norm([0.3, -0.2, 0.93])
    centre, radius_m = np.array([0.03, -0.05, 0.5]), 3e-3
    basis = plane_basis(normal)
    unit_px = 1e-6 * basis
    at, across, along = project(HEAD.left, centre + np.vstack([np.zeros(3), unit_px]))
    jacobian = np.column_stack([across - at, along - at]) / 1e-6 * radius_m
    drawn = ellipse_of_circle(at, jacobian).points(60)
    turns = np.linspace(0, 2 * np.pi, 2000)
    rim = centre + radius_m * (np.column_stack([np.cos(turns), np.sin(turns)]) @ basis)
    gaps = np.linalg.norm(project(HEAD.left, rim)[None] - drawn[:, None], axis=2).min(axis=1)
    assert gaps.max() < 0.15
