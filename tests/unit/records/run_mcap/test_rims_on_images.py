"""What a viewer draws over an exported image lies on what the image shows."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cellctl.records import RunStore
from cellctl.records.looks import MeasuredRim
from cellctl.records.run_mcap.export import export_mcap
from tests.unit.records.run_mcap.moved_run import VIEW, open_run
from tests.unit.records.run_mcap.reading import read

WIDTH, HEIGHT = 90, 70
BRIGHT, DARK = 220, 20
FINE = 20
"""Parts into which a pixel is divided, along each side."""
MOST_OFF_PX = 0.1


def rendered(hole: MeasuredRim) -> NDArray[np.uint8]:
    """A dark hole on a bright plate: each pixel has the mean of the light that falls on it."""
    # The first pixel's centre is at (0, 0), so the pixel itself begins half of one before it.
    x, y = np.meshgrid(*((np.arange(n * FINE) + 0.5) / FINE - 0.5 for n in (WIDTH, HEIGHT)))
    x, y = x - hole.ellipse_centre_px[0], y - hole.ellipse_centre_px[1]
    cos, sin = np.cos(hole.angle_rad), np.sin(hole.angle_rad)
    major, minor = hole.semi_axes_px
    inside = ((cos * x + sin * y) / major) ** 2 + ((cos * y - sin * x) / minor) ** 2 < 1.0
    share = inside.reshape(HEIGHT, FINE, WIDTH, FINE).mean(axis=(1, 3))
    pixels: NDArray[np.uint8] = np.rint(BRIGHT + (DARK - BRIGHT) * share).astype(np.uint8)
    return pixels


def darkness(image: Any) -> NDArray[np.float64]:
    """How much of each pixel the hole covers, from the bytes of the export."""
    pixels = np.frombuffer(image.data, np.uint8).reshape(image.height, image.step)
    return (BRIGHT - pixels.astype(float)) / (BRIGHT - DARK)


@pytest.mark.parametrize("centre_px", [(41.3, 30.8), (44.0, 35.5)])
@pytest.mark.parametrize(("semi_axes_px", "angle_rad"), [((18.0, 18.0), 0.0), ((22.0, 13.0), 0.7)])
def test_the_outline_lies_on_the_hole_of_a_rendered_image(
    tmp_path: Path,
    centre_px: tuple[float, float],
    semi_axes_px: tuple[float, float],
    angle_rad: float,
) -> None:
    hole = MeasuredRim("P1", centre_px, None, centre_px, semi_axes_px, angle_rad)
    store = RunStore(tmp_path / "runs")
    run = open_run(store, rendered(hole), (hole,))
    content = read(export_mcap(store, run, tmp_path / "run.mcap").path)
    store.close()
    (image,) = content.of(f"/images/{VIEW}")
    (drawn,) = content.of(f"/images/{VIEW}/annotations")
    outline = np.array([(point.x, point.y) for point in drawn.points[0].points])
    covered = darkness(image)
    # A viewer counts from the corner of the first pixel, whose centre is half a pixel from there.
    columns, rows = np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5
    seen = np.array([covered.sum(0) @ columns, covered.sum(1) @ rows]) / covered.sum()
    assert np.abs(outline.mean(axis=0) - seen).max() < MOST_OFF_PX
    # Its size and its turn, too: the area within it, and how far it reaches along each axis.
    x, y = outline.T
    area = 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    corners = len(outline)
    polygon = 0.5 * corners * np.sin(2.0 * np.pi / corners) / np.pi
    assert area / polygon == pytest.approx(covered.sum(), rel=0.005)
    places = np.array([grid.ravel() for grid in np.meshgrid(columns, rows)])
    spread = np.cov(places, aweights=covered.ravel(), ddof=0)
    # Of a filled ellipse it is half of that of its outline.
    assert np.cov(outline.T, ddof=0) / 2.0 == pytest.approx(spread, rel=0.02, abs=0.5)
