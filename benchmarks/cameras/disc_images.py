"""Discs as a sensor sees them: exact edges, shot and read noise, 12 or 8 bit."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.special import ndtr

Array = NDArray[np.float64]

SIZE_PX = 44
RADIUS_PX = 14.0
BLUR_PX = 1.0
FULL_SCALE = 4095


@dataclass(frozen=True, slots=True)
class Sensor:
    """Electrons at full scale and of the read noise, as EMVA 1288 states them."""

    name: str
    full_well_e: float
    read_noise_e: float


@dataclass(frozen=True, slots=True)
class Light:
    """Levels of the disc and of what is round it, shares of full scale."""

    name: str
    inside: float
    outside: float


def drawn(centre_px: Array, light: Light) -> Array:
    """A blurred disc without noise, shares of full scale; a straight edge is blurred exactly."""
    return _model(np.array([*centre_px, RADIUS_PX, BLUR_PX, light.inside, light.outside]))


def exposed(ideal: Array, sensor: Sensor, rng: np.random.Generator) -> NDArray[np.uint16]:
    """One exposure of 12 bit."""
    electrons = rng.poisson(ideal * sensor.full_well_e) + rng.normal(
        0.0, sensor.read_noise_e, ideal.shape
    )
    counts = np.rint(electrons / sensor.full_well_e * FULL_SCALE)
    return np.clip(counts, 0, FULL_SCALE).astype(np.uint16)


def eight_bit(deep: NDArray[np.uint16]) -> NDArray[np.uint8]:
    """The upper eight bits, as cameras send them in Mono8."""
    return (deep >> 4).astype(np.uint8)


def centre_px(image: Array, light: Light) -> Array:
    """Centre by least squares over all pixels with every level free; ``image`` in any unit."""
    scale = float(image.max())
    shares = image / scale
    middle = (SIZE_PX - 1) / 2
    levels = sorted((light.inside, light.outside))
    low, high = np.quantile(shares, (0.1, 0.9))
    start_inside, start_outside = (low, high) if light.inside == levels[0] else (high, low)
    start = np.array([middle, middle, RADIUS_PX, BLUR_PX, start_inside, start_outside])

    def residuals(parameters: Array) -> Array:
        return np.asarray(_model(parameters) - shares).ravel()

    fit = least_squares(residuals, start, x_scale=[1, 1, 1, 1, 0.1, 0.1])
    return np.asarray(fit.x[:2])


def _model(parameters: Array) -> Array:
    x, y, radius, blur, inside, outside = parameters
    rows, columns = np.mgrid[0:SIZE_PX, 0:SIZE_PX]
    beyond = np.hypot(columns - x, rows - y) - radius
    return np.asarray(inside + (outside - inside) * ndtr(beyond / max(blur, 0.05)))
