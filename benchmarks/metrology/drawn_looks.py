"""Looks of a hole, as functions of the ray that meets it: what a pixel sees inside a circle.

Nothing here is shared with the cell's renderer: where one renderer's habits help a measurement,
the other's should not. All lengths in radii of the rim. A ray meets the plane of the rim at ``q``
(2, n) and moves by ``m`` (2, n) in it while it goes one radius deeper.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Grey = Callable[[Array, Array], Array]
"""Grey values for ``q`` and ``m``; not a number where the plate is seen."""

PLATE, DARK = 180.0, 30.0


@dataclass(frozen=True, slots=True)
class Look:
    """A kind of hole with the look of one example."""

    kind: str
    step: float
    """Typical difference of grey across the rim."""
    grey: Grey
    reach: float = 1.0
    """Outermost radius that is not plate."""


def disc(_: np.random.Generator) -> Look:
    """An even dark disc."""
    return Look("pin", PLATE - DARK, _bore(0.0, DARK, 0.0, 0.0))


def lit_wall(rng: np.random.Generator) -> Look:
    """A bore whose wall is lit from one side, over an even floor."""
    return Look("pin", PLATE - 90.0, _bore(rng.uniform(2.0, 5.0), 90.0, 0.5, _phase(rng)))


def bright_wall(rng: np.random.Generator) -> Look:
    """A wall nearly as bright as the plate."""
    return Look("pin", PLATE - 135.0, _bore(rng.uniform(1.0, 4.0), 135.0, 0.2, _phase(rng)))


def fading_wall(rng: np.random.Generator) -> Look:
    """A deep bore into which light falls ever less."""
    return Look("pin", PLATE - 110.0, _bore(12.0, 110.0, 0.3, _phase(rng), fade=1.6))


def faint_wall(rng: np.random.Generator) -> Look:
    """A wall hardly brighter than the floor, mostly on one side."""
    return Look("pin", PLATE - 45.0, _bore(rng.uniform(0.3, 3.0), 45.0, 0.3, _phase(rng), fade=1.0))


def flat_cone(rng: np.random.Generator) -> Look:
    """A countersink drawn as a flat ring darker than the plate, brighter on one side."""
    return _ringed(rng.uniform(1.5, 2.1), 110.0, 0.3, _phase(rng))


def bright_cone(rng: np.random.Generator) -> Look:
    """A countersink brighter than the plate."""
    return _ringed(rng.uniform(1.5, 2.1), 215.0, 0.1, _phase(rng))


def near_cone(rng: np.random.Generator) -> Look:
    """A countersink so narrow that its outer edge comes into the band of pixels round the rim."""
    return _ringed(rng.uniform(1.25, 1.45), 110.0, 0.3, _phase(rng))


def narrow_cone(rng: np.random.Generator) -> Look:
    """A countersink a few pixels wide."""
    return _ringed(1.2, 105.0, 0.2, _phase(rng))


def true_cone(rng: np.random.Generator) -> Look:
    """A cone of 90° above the rim, lit from one side."""
    return _coned("countersink", rng.uniform(1.4, 2.0), 150.0, 0.35, _phase(rng))


def broken_edge(rng: np.random.Generator) -> Look:
    """A bore deburred by a tenth of its radius or less: a cone of 90° that shines."""
    return _coned("pin", rng.uniform(1.05, 1.1), 215.0, 0.12, _phase(rng))


def turns(rng: np.random.Generator) -> Look:
    """A thread drawn as concentric rings."""
    return Look("thread", PLATE - 45.0, _turns(rng))


def chamfered_turns(rng: np.random.Generator) -> Look:
    """The same with a flat chamfer."""
    inside, ring = _turns(rng), _ringed(1.12, 120.0, 0.15, _phase(rng))

    def grey(q: Array, m: Array) -> Array:
        return np.where(np.hypot(*q) < 1.0, inside(q, m), ring.grey(q, m))

    return Look("thread", 120.0 - 45.0, grey, ring.reach)


LOOKS: dict[str, Callable[[np.random.Generator], Look]] = {
    "disc": disc,
    "lit wall": lit_wall,
    "bright wall": bright_wall,
    "fading wall": fading_wall,
    "flat cone": flat_cone,
    "bright cone": bright_cone,
    "narrow cone": narrow_cone,
    "true cone": true_cone,
    "turns": turns,
    "chamfered turns": chamfered_turns,
    "broken edge": broken_edge,
    "faint wall": faint_wall,
    "near cone": near_cone,
}
"""A look's place is part of its seed: new ones come last."""


def _phase(rng: np.random.Generator) -> float:
    return float(rng.uniform(-np.pi, np.pi))


def _bore(depth: float, wall: float, uneven: float, phase: float, fade: float = np.inf) -> Grey:
    def grey(q: Array, m: Array) -> Array:
        a, b = (m**2).sum(axis=0) + 1e-12, (q * m).sum(axis=0)
        c = np.minimum((q**2).sum(axis=0) - 1.0, 0.0)
        deep = (np.sqrt(b * b - a * c) - b) / a
        x, y = q + m * deep
        lit = wall * (1.0 + uneven * np.cos(np.arctan2(y, x) - phase))
        lit = DARK + (lit - DARK) * np.exp(-deep / fade)
        return np.where(np.hypot(*q) < 1.0, np.where(deep < depth, lit, DARK), np.nan)

    return grey


def _ringed(outer: float, ring: float, uneven: float, phase: float) -> Look:
    def grey(q: Array, _: Array) -> Array:
        radius = np.hypot(*q)
        lit = ring * (1.0 + uneven * np.cos(np.arctan2(q[1], q[0]) - phase))
        return np.where(radius < 1.0, DARK, np.where(radius < outer, lit, np.nan))

    return Look("countersink", ring - DARK, grey, outer)


def _coned(kind: str, outer: float, cone: float, uneven: float, phase: float) -> Look:
    height = outer - 1.0

    def grey(q: Array, m: Array) -> Array:
        # |q - m t| = 1 + t where the ray, followed upwards by t, leaves the cone.
        a = (m**2).sum(axis=0) - 1.0
        b = (q * m).sum(axis=0) + 1.0
        c = (q**2).sum(axis=0) - 1.0
        t = (b - np.sqrt(np.maximum(b * b - a * c, 0.0))) / a
        x, y = q - m * t
        lit = cone * (1.0 + uneven * np.cos(np.arctan2(y, x) - phase))
        inside = np.hypot(*(q - m * height)) < outer
        return np.where(inside, np.where(c < 0.0, DARK, lit), np.nan)

    return Look(kind, cone - DARK, grey, outer + height)


def _turns(rng: np.random.Generator) -> Grey:
    count, core = int(rng.integers(5, 8)), 0.55

    def grey(q: Array, _: Array) -> Array:
        radius = np.hypot(*q)
        turn = np.where(np.floor(radius * count) % 2 == (count - 1) % 2, 45.0, 100.0)
        return np.where(radius < core, DARK, np.where(radius < 1.0, turn, np.nan))

    return grey
