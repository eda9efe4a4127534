"""What light, wear, lens and sensor do to an image of holes, each as a condition of its own.

The conditions stand in two halves. The first half may be used to develop the measurement; nothing
is ever tuned on the second, the held-back one, whose figures are the ones that count.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.metrology.drawn_looks import DARK, PLATE, Array, Look
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.depth import eight_bits
from tests.rigs.metrology.views import NOISE_GREY

Draw = np.random.Generator


def _gauss(blur_px: float, sub: int) -> NDArray[np.float32]:
    """A Gaussian, as an image of ``sub`` samples to a pixel."""
    half = int(np.ceil(4.0 * blur_px * sub))
    line = cv2.getGaussianKernel(2 * half + 1, blur_px * sub)
    return np.asarray(line @ line.T, dtype=np.float32)


def gaussian_spread(rng: Draw, sub: int) -> NDArray[np.float32]:
    """A lens in focus."""
    return _gauss(float(rng.uniform(0.8, 1.2)), sub)


def same_looks(look: Look, _: Draw) -> Look:
    """A hole as it is drawn."""
    return look


def same_light(image: Array, _: Draw) -> Array:
    """Even light on a clean sensor."""
    return image


def linear_sensor(image: Array, rng: Draw) -> Image:
    """Noise and rounding, 8 bits."""
    return _rounded(_noisy(image, rng))


@dataclass(frozen=True, slots=True)
class Condition:
    """One condition: what it does at each stage between a hole and its image."""

    tilt_deg: tuple[float, float] = (0.0, 0.0)
    """Further tilt of the plate, least and most."""
    worn: Callable[[Look, Draw], Look] = same_looks
    """What becomes of a hole's surfaces and of the light on them."""
    spread: Callable[[Draw, int], NDArray[np.float32]] = gaussian_spread
    """Point spread, an image of so many samples to a pixel."""
    light: Callable[[Array, Draw], Array] = same_light
    """Whole image: what falls on the sensor."""
    sensor: Callable[[Array, Draw], Image] = linear_sensor
    """Light to grey values."""


def _noisy(image: Array, rng: Draw) -> Array:
    return np.asarray(image + rng.normal(0.0, NOISE_GREY, image.shape))


def _rounded(image: Array) -> Image:
    return np.asarray(np.clip(np.rint(image), 0, 255), dtype=np.uint8)


def _lit_from_one_side(look: Look, rng: Draw) -> Look:
    """Walls and cones in full light on one side and in their own shadow on the other."""
    phase = float(rng.uniform(-np.pi, np.pi))

    def grey(q: Array, m: Array) -> Array:
        seen = look.grey(q, m)
        # The side that is lit lies across from the lamp; where the sun sets there is a kink.
        lit = 0.45 + 0.75 * np.maximum(np.cos(np.arctan2(q[1], q[0]) - phase), 0.0)
        return np.asarray(DARK + (seen - DARK) * lit)

    return replace(look, grey=grey)


def _falling_off(image: Array, rng: Draw) -> Array:
    """The plate gets darker away from the lamp: by up to 40 % across the image."""
    height, width = image.shape
    direction = rng.uniform(-np.pi, np.pi)
    y, x = np.ogrid[-1.0 : 1.0 : height * 1j, -1.0 : 1.0 : width * 1j]
    return np.asarray(image * (1.0 + 0.2 * (np.cos(direction) * x + np.sin(direction) * y)))


def _streaked(look: Look, rng: Draw) -> Look:
    """Two glints that run over plate and hole, up to a fifth of a radius wide."""
    angles = rng.uniform(-np.pi, np.pi, 2)
    places, widths = rng.uniform(-1.3, 1.3, 2), rng.uniform(0.05, 0.2, 2)
    heights = rng.uniform(25.0, 75.0, 2)

    def grey(q: Array, m: Array) -> Array:
        seen = look.grey(q, m)
        seen = np.where(np.isnan(seen), PLATE, seen)
        # The floor of a bore lies in the dark, and shows no glint.
        shine = np.where(seen <= DARK, 0.0, 1.0)
        for angle, place, width, height in zip(angles, places, widths, heights, strict=True):
            off = np.cos(angle) * q[0] + np.sin(angle) * q[1] - place
            seen = seen + height * shine * np.exp(-0.5 * (off / width) ** 2)
        return np.asarray(seen)

    return replace(look, grey=grey)


def _defocused(rng: Draw, sub: int) -> NDArray[np.float32]:
    """A disc of confusion, behind an otherwise sharp lens."""
    radius = float(rng.uniform(1.2, 2.4)) * sub
    half = int(np.ceil(radius)) + 1
    y, x = np.mgrid[-half : half + 1, -half : half + 1]
    disc = np.clip(radius + 0.5 - np.hypot(x, y), 0.0, 1.0).astype(np.float32)
    return _convolved(disc / disc.sum(), _gauss(0.5, sub))


def _moved(rng: Draw, sub: int) -> NDArray[np.float32]:
    """A camera that moved by 1 to 3 px while it looked."""
    length, angle = float(rng.uniform(1.0, 3.0)) * sub, float(rng.uniform(0.0, np.pi))
    half = int(np.ceil(length / 2.0)) + 1
    line = np.zeros((2 * half + 1, 2 * half + 1), np.float32)
    way = np.linspace(-0.5, 0.5, 8 * sub) * length
    columns, rows = half + np.cos(angle) * way, half + np.sin(angle) * way
    # Each point of the way is shared out to its four neighbours, so that its middle stays exact.
    left, above = np.floor(columns).astype(int), np.floor(rows).astype(int)
    for right, below in ((0, 0), (0, 1), (1, 0), (1, 1)):
        share = np.abs(1 - right - (columns - left)) * np.abs(1 - below - (rows - above))
        np.add.at(line, (above + below, left + right), share)
    return _convolved(line / line.sum(), _gauss(0.8, sub))


def _haloed(rng: Draw, sub: int) -> NDArray[np.float32]:
    """A sharp core in a wide halo, as of a lens with spherical aberration or a fingerprint."""
    share, wide_px = float(rng.uniform(0.15, 0.35)), float(rng.uniform(2.0, 3.0))
    halo, core = _gauss(wide_px, sub), _gauss(0.7, sub)
    margin = (len(halo) - len(core)) // 2
    return np.asarray(share * halo + (1.0 - share) * np.pad(core, margin), dtype=np.float32)


def _convolved(one: NDArray[np.float32], other: NDArray[np.float32]) -> NDArray[np.float32]:
    padded = np.pad(one, len(other) // 2)
    return np.asarray(cv2.filter2D(padded, -1, other, borderType=cv2.BORDER_CONSTANT))


def _gamma(image: Array, rng: Draw) -> Image:
    """A camera that encodes its grey values for a screen."""
    linear = np.clip(_noisy(image, rng) / 255.0, 0.0, 1.0)
    return _rounded(255.0 * linear ** float(rng.uniform(0.45, 0.7)))


def _deep(image: Array, rng: Draw) -> Image:
    """8, 10 or 12 bits in low light: the noise of reading, gain 1, and the bits that are left."""
    bits = int(rng.choice([8, 10, 12]))
    counts = np.clip(np.rint(0.35 * _noisy(image, rng) * 2.0 ** (bits - 8)), 0, 2.0**bits - 1)
    return eight_bits(counts.astype(np.uint16), bits)


def _jpeg(image: Array, rng: Draw) -> Image:
    """Stored with losses, quality 75 to 92."""
    quality = int(rng.integers(75, 93))
    _, packed = cv2.imencode(
        ".jpg", _rounded(_noisy(image, rng)), [cv2.IMWRITE_JPEG_QUALITY, quality]
    )
    return np.asarray(cv2.imdecode(packed, cv2.IMREAD_GRAYSCALE), dtype=np.uint8)


def _vignetted(image: Array, rng: Draw) -> Array:
    """The fourth power of the cosine of a short lens: down to 45 % in the corners."""
    height, width = image.shape
    y, x = np.ogrid[-1.0 : 1.0 : height * 1j, -1.0 : 1.0 : width * 1j]
    corner = float(rng.uniform(0.45, 0.7))
    slope = corner**-0.5 - 1.0
    return np.asarray(image / (1.0 + slope * (x * x + y * y) / 2.0) ** 2)


def _dusty(image: Array, rng: Draw) -> Array:
    """Soft shadows of dust on the sensor's window, thirty to a megapixel."""
    height, width = image.shape
    shadow = np.zeros_like(image)
    for _ in range(int(30e-6 * image.size)):
        x, y = int(rng.integers(width)), int(rng.integers(height))
        shadow[y, x] += float(rng.uniform(0.05, 0.3)) * 2.0 * np.pi * 4.0**2
    return np.asarray(image * (1.0 - np.minimum(cv2.GaussianBlur(shadow, (0, 0), 4.0), 0.5)))


def _worn(look: Look, rng: Draw) -> Look:
    """A rim that is ragged, with three nicks: its circle stays where it was drilled."""
    orders = np.arange(3, 24)
    waves = rng.normal(0.0, 0.0012, (2, len(orders)))
    at, wide = rng.uniform(-np.pi, np.pi, 3), rng.uniform(0.04, 0.12, 3)
    deep = rng.uniform(0.01, 0.04, 3)

    def grey(q: Array, m: Array) -> Array:
        azimuth = np.arctan2(q[1], q[0])
        off = np.zeros_like(azimuth)
        for order, (cosine, sine) in zip(orders, waves.T, strict=True):
            off += cosine * np.cos(order * azimuth) + sine * np.sin(order * azimuth)
        for place, width, depth in zip(at, wide, deep, strict=True):
            turn = np.angle(np.exp(1j * (azimuth - place)))
            off += depth * np.exp(-0.5 * (turn / width) ** 2)
        return np.asarray(look.grey(q / (1.0 + off), m))

    return replace(look, grey=grey)


DEVELOPED = {
    "none": Condition(),
    "light from one side": Condition(worn=_lit_from_one_side, light=_falling_off),
    "defocus": Condition(spread=_defocused),
    "gamma": Condition(sensor=_gamma),
    "vignetting": Condition(light=_vignetted),
    "dust": Condition(light=_dusty),
    "oblique, to 40°": Condition(tilt_deg=(15.0, 30.0)),
}
"""May be looked at while the measurement is developed."""

HELD_BACK = {
    "specular streaks": Condition(worn=_streaked),
    "motion blur": Condition(spread=_moved),
    "halo": Condition(spread=_haloed),
    "8 to 12 bits, dim": Condition(sensor=_deep),
    "JPEG": Condition(sensor=_jpeg),
    "worn edges": Condition(worn=_worn),
}
"""Conditions that are only measured; nothing was developed on them."""
