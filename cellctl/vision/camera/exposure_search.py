"""Automatic exposure: the time at which the surface round the holes has a wanted grey.

Found once, while nothing moves, and kept: an exposure that goes on changing by itself would move
the edges that are measured.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.setting_up import SATURATED_GREY, image_figures
from cellctl.vision.holes.candidates import Candidate, find_candidates, outermost

_RING = (1.2, 1.8)
"""The surface round a hole is looked at between these multiples of the hole's radius, outside the
blur of the rim."""
_MOST_SATURATED = 0.005
"""Share of the pixels that may be saturated, for the glints of a machined surface."""
_TOLERANCE_GREY = 8.0
"""The search ends this near to the wanted grey."""
_MOST_CHANGE = 4.0
"""Largest factor by which one step changes the exposure. A dark image says little about the next:
its grey is mostly the black level."""
_NEAR_SATURATION = 1.1
"""The search ends when the shortest exposure that saturates is within this factor of the present
one: there is nothing between them that would be worth another image."""


@dataclass(frozen=True, slots=True)
class ExposureAim:
    """The wanted grey (8 bit) of the surface, and the limits of the exposure (s)."""

    target_grey: float
    least_s: float
    greatest_s: float

    def within(self, exposure_s: float) -> float:
        """The nearest exposure between the limits."""
        return min(max(exposure_s, self.least_s), self.greatest_s)


@dataclass(frozen=True, slots=True)
class Brightness:
    """Light on the surface round the holes. Where no hole is found, ``grey`` is that of the bright
    part of the whole image and ``holes`` is 0."""

    grey: float
    saturated_share: float
    holes: int

    @property
    def saturated(self) -> bool:
        """True when more of the surface is saturated than glints explain."""
        return self.saturated_share > _MOST_SATURATED


@dataclass(frozen=True, slots=True)
class ExposureVerdict:
    """What to do after an exposure: take another one of ``next_s``, or end."""

    next_s: float | None
    shortfall: str = ""
    """Why the search ends without the wanted grey; empty when it has found it or goes on."""


def light_round_holes(image: Image, radii_px: tuple[float, float]) -> Brightness:
    """Look at rings round dark holes with a radius in this range; shape (height, width)."""
    found = outermost(find_candidates(image, radii_px))
    rings = [ring for one in found if (ring := _ring(image, one)).size]
    if not rings:
        whole = image_figures(image)
        return Brightness(whole.bright_grey, whole.saturated_share, 0)
    grey = float(np.median([np.median(ring) for ring in rings]))
    share = float(np.mean(np.concatenate(rings) >= SATURATED_GREY))
    return Brightness(grey, share, len(rings))


def of_all(views: Sequence[Brightness]) -> Brightness:
    """The light of a head from that of its cameras, which share one exposure time.

    The brighter camera decides, because what it has lost in saturation cannot be measured. Holes
    count as seen when each camera sees some.
    """
    return Brightness(
        max(one.grey for one in views),
        max(one.saturated_share for one in views),
        min(one.holes for one in views),
    )


class ExposureSearch:
    """Judges one exposure after the other; whoever exposes bounds their number and their time."""

    def __init__(self, aim: ExposureAim) -> None:
        self._aim = aim
        self._saturated_s = math.inf
        """The shortest exposure that was saturated."""

    def judge(self, exposure_s: float, light: Brightness) -> ExposureVerdict:
        """``exposure_s`` as the camera made it."""
        if light.saturated:
            self._saturated_s = min(self._saturated_s, exposure_s)
            # Grey values at their end do not tell by how much the exposure was too long, so it is
            # halved.
            return self._unless_the_same(exposure_s, exposure_s / 2.0, "it saturates")
        too_dark = self._aim.target_grey - light.grey
        if abs(too_dark) <= _TOLERANCE_GREY:
            return ExposureVerdict(None, "" if light.holes else "no holes of this size are seen")
        change = self._aim.target_grey / max(light.grey, 1.0)
        wanted_s = exposure_s * min(max(change, 1.0 / _MOST_CHANGE), _MOST_CHANGE)
        if wanted_s >= self._saturated_s:
            if self._saturated_s < _NEAR_SATURATION * exposure_s:
                return ExposureVerdict(None, f"it saturates from grey {light.grey:.0f} on")
            # Between an exposure that was too short and one that was too long, in the middle of
            # their ratio.
            wanted_s = math.sqrt(exposure_s * self._saturated_s)
        return self._unless_the_same(exposure_s, wanted_s, f"its grey is {light.grey:.0f}")

    def _unless_the_same(self, exposure_s: float, wanted_s: float, seen: str) -> ExposureVerdict:
        next_s = self._aim.within(wanted_s)
        if math.isclose(next_s, exposure_s, rel_tol=1e-3):
            return ExposureVerdict(
                None, f"{seen} at the limit of the exposure, {exposure_s * 1e3:g} ms"
            )
        return ExposureVerdict(next_s)


def _ring(image: Image, hole: Candidate) -> Image:
    """The pixels of a ring, as far as they lie in the image."""
    x, y = hole.centre_px
    inner, outer = (share * hole.radius_px for share in _RING)
    top, left = (max(0, math.ceil(at - outer)) for at in (y, x))
    part = image[top : math.floor(y + outer) + 1, left : math.floor(x + outer) + 1]
    rows, columns = np.ogrid[top : top + part.shape[0], left : left + part.shape[1]]
    away = np.hypot(rows - y, columns - x)
    return np.asarray(part[(away >= inner) & (away <= outer)])
