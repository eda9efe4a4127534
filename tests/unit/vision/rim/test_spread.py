"""The spread of an image across an edge."""

import numpy as np
import pytest

from cellctl.vision.rim.spread import edge_density, outside_edge

_Z = np.linspace(-12.0, 12.0, 4801)


@pytest.mark.parametrize("excess", [-1.0, 0.0, 2.5])
def test_the_light_across_an_edge_has_the_stated_excess(excess: float) -> None:
    outside, density = outside_edge(_Z, excess), edge_density(_Z, excess)
    numeric = np.gradient(outside, _Z)
    np.testing.assert_allclose(density, numeric, atol=1e-5)
    moments = [float(np.trapezoid(density * _Z**order, _Z)) for order in (0, 1, 2, 4)]
    np.testing.assert_allclose(moments, [1.0, 0.0, 1.0, 3.0 + excess], atol=1e-6)
    assert outside[0] == pytest.approx(0.0, abs=1e-12)
    assert outside[-1] == pytest.approx(1.0)


def test_a_lens_out_of_focus_spreads_an_edge_nearly_so() -> None:
    """A disc of 2 px radius behind a lens that blurs by 0.5 px, integrated by itself."""
    radius, lens = 2.0, 0.5
    x = np.linspace(-8.0, 8.0, 3201)
    step = x[1] - x[0]
    strip = np.sqrt(np.maximum(radius**2 - x**2, 0.0))
    point = np.convolve(strip, np.exp(-0.5 * (x / lens) ** 2), mode="same")
    point /= point.sum() * step
    edge = np.cumsum(point) * step - 0.5 * point * step
    blur = float(np.sqrt((radius / 2.0) ** 2 + lens**2))
    excess = -((radius / 2.0) ** 4) / blur**4
    normal, series = (outside_edge(x / blur, k) for k in (0.0, excess))
    assert np.abs(series - edge).max() < 0.5 * np.abs(normal - edge).max()
