"""The image of a circle: against published figures and points of the circle."""

import numpy as np
import pytest

from cellctl.vision.camera.ellipse import conic_of_circle, eccentricity, ellipse_of_circle
from cellctl.vision.camera.lens import project
from cellctl.vision.camera.plane_patch import plane_basis
from tests.unit.vision.plates import table_1_head

HEAD = table_1_head()


@pytest.mark.parametrize(
    ("diameter_mm", "expected_px"), [(5.0, 0.0148), (6.0, 0.0213), (10.0, 0.0593), (20.0, 0.237)]
)
def test_eccentricity_of_a_frontal_plate(diameter_mm: float, expected_px: float) -> None:
    """Published figures for f 3580 px, 500 mm, 10° between axis and plate."""
    normal = np.array([np.sin(np.radians(10)), 0.0, np.cos(np.radians(10))])
    offset = eccentricity(np.array([0.0, 0.0, 0.5077]), normal, diameter_mm / 2000) * 3580
    assert np.hypot(*offset) == pytest.approx(expected_px, rel=0.05)


def test_the_conic_of_a_circle_holds_its_image() -> None:
    normal = np.array([0.2, -0.1, 0.97])
    normal /= np.linalg.norm(normal)
    centre = np.array([0.03, -0.05, 0.5])
    basis = plane_basis(normal)
    angles = np.linspace(0, 2 * np.pi, 20)
    ring = centre + 3e-3 * (np.column_stack([np.cos(angles), np.sin(angles)]) @ basis)
    rays = ring / ring[:, 2:]
    conic = conic_of_circle(centre, normal, 3e-3)
    assert np.abs(np.einsum("ni,ij,nj->n", rays, conic, rays)).max() < 1e-12
    middle, scale = rays[:, :2].mean(axis=0), 3e-3 / 0.5
    x, y = ((rays[:, :2] - middle) / scale).T
    design = np.column_stack([x * x, x * y, y * y, x, y])
    a, b, c, d, e = np.linalg.lstsq(design, np.ones(len(x)), rcond=None)[0]
    seen = middle - scale * np.linalg.solve([[2 * a, b], [b, 2 * c]], [d, e])
    predicted = centre[:2] / centre[2] + eccentricity(centre, normal, 3e-3)
    assert np.allclose(seen, predicted, atol=1e-9)


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
