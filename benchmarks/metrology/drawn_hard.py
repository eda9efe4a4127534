"""Hard conditions to develop on: akin to the held-back ones, and drawn without their code."""

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.metrology.drawn_conditions import Condition, Draw
from benchmarks.metrology.drawn_looks import DARK, PLATE, Array, Look

_INSTANTS = 401
_BRIGHTEST = 330.0
"""Grey level that is more than the sensor can show."""


def _along_a_path(rng: Draw, sub: int, unevenness: float) -> NDArray[np.float32]:
    """A movement of one to four pixels behind a lens in focus, its centroid in the middle.

    ``unevenness`` is the change of the speed during the exposure over twice the mean speed.
    """
    length, way = rng.uniform(1.0, 4.0) * sub, rng.uniform(0.0, np.pi)
    time = (np.arange(_INSTANTS) + 0.5) / _INSTANTS - 0.5
    path = length * (time + unevenness * (time**2 - 1.0 / 12.0))
    half = int(np.ceil(length)) + int(4 * sub)
    edges = np.arange(-half - 0.5, half + 1.0)
    line, _, _ = np.histogram2d(path * np.sin(way), path * np.cos(way), bins=(edges, edges))
    lens = float(rng.uniform(0.7, 1.1)) * sub
    return np.asarray(cv2.GaussianBlur(line / _INSTANTS, (0, 0), lens), dtype=np.float32)


def _moved(rng: Draw, sub: int) -> NDArray[np.float32]:
    """A movement of constant speed."""
    return _along_a_path(rng, sub, 0.0)


def _speeding_up(rng: Draw, sub: int) -> NDArray[np.float32]:
    """A movement that speeds up; truth is the mean position, not that of the mid exposure."""
    return _along_a_path(rng, sub, float(rng.uniform(0.3, 0.9)))


def _dented_once(look: Look, rng: Draw) -> Look:
    """One dent with steep sides in a tenth of the rim, which a person does not mind."""
    where, half_width = rng.uniform(-np.pi, np.pi), rng.uniform(0.2, 0.4)
    depth = rng.uniform(0.03, 0.12)

    def grey(q: Array, m: Array) -> Array:
        turn = _turn(np.arctan2(q[1], q[0]) - where)
        deep = depth * np.maximum(1.0 - (turn / half_width) ** 4, 0.0)
        scale = np.where(np.hypot(*q) < 1.0 + deep, 1.0 / (1.0 + deep), 1.0)
        return look.grey(q * scale, m)

    return replace(look, grey=grey, reach=max(look.reach, 1.3))


def _dented(look: Look, rng: Draw) -> Look:
    """Metal pushed away over one to three arcs of five to twenty degrees."""
    count = int(rng.integers(1, 4))
    where, widths = rng.uniform(-np.pi, np.pi, count), rng.uniform(0.08, 0.35, count)
    depths = rng.uniform(0.02, 0.08, count)

    def grey(q: Array, m: Array) -> Array:
        around = np.arctan2(q[1], q[0])
        deep = sum(
            depth * np.exp(-0.5 * (_turn(around - at) / width) ** 2)
            for at, width, depth in zip(where, widths, depths, strict=True)
        )
        # Up to the dented edge the hole shows what it shows just inside its own rim.
        scale = np.where(np.hypot(*q) < 1.0 + deep, 1.0 / (1.0 + deep), 1.0)
        return look.grey(q * scale, m)

    return replace(look, grey=grey, reach=max(look.reach, 1.25))


def _worn_all_round(look: Look, rng: Draw) -> Look:
    """A rim off its circle by half a percent to one and a half, alike over 15° to 45°.

    The first harmonic, which is a movement of the rim, is among what is drawn.
    """
    order = np.arange(1, 13)[:, None]
    off, alike = rng.uniform(0.005, 0.015), rng.uniform(0.25, 0.8)
    sizes = np.exp(-0.25 * (order * alike) ** 2)
    sizes *= off / np.sqrt((sizes**2).sum())
    waves = rng.normal(0.0, 1.0, (2, len(order), 1)) * sizes

    def grey(q: Array, m: Array) -> Array:
        around = np.arctan2(q[1], q[0])
        turns = order * around.reshape(1, -1)
        deep = (waves[0] * np.cos(turns) + waves[1] * np.sin(turns)).sum(axis=0)
        return look.grey(q / (1.0 + deep.reshape(around.shape)), m)

    return replace(look, grey=grey, reach=max(look.reach, 1.2))


def _glinting(look: Look, rng: Draw) -> Look:
    """Radial reflexes on walls, cones and turns, and a bright stripe on all that is not dark."""
    count = int(rng.integers(1, 4))
    where, widths = rng.uniform(-np.pi, np.pi, count), rng.uniform(0.05, 0.25, count)
    greys = rng.uniform(60.0, 200.0, count)
    way, off, width = rng.uniform(-np.pi, np.pi), rng.uniform(0.5, 1.2), rng.uniform(0.03, 0.1)
    stripe_grey = rng.uniform(20.0, 90.0)

    def grey(q: Array, m: Array) -> Array:
        seen, around = look.grey(q, m), np.arctan2(q[1], q[0])
        lit = np.where(np.isnan(seen), PLATE, seen)
        bare = lit > DARK + 1.0
        for at, wide, more in zip(where, widths, greys, strict=True):
            reflex = more * np.exp(-0.5 * (_turn(around - at) / wide) ** 2)
            lit = lit + np.where(bare & np.isfinite(seen), reflex, 0.0)
        across = (q[0] * np.cos(way) + q[1] * np.sin(way) - off) / width
        lit = lit + np.where(bare, stripe_grey * np.exp(-0.5 * across**2), 0.0)
        return np.minimum(lit, _BRIGHTEST)

    return replace(look, grey=grey, reach=max(look.reach, 1.6))


def _turn(angle: Array) -> Array:
    """The same direction, between -pi and pi."""
    return np.asarray(np.angle(np.exp(1j * angle)))


HARD = {
    "moved": Condition(spread=_moved),
    "moved, speeding up": Condition(spread=_speeding_up),
    "dented in a tenth": Condition(worn=_dented_once),
    "dented": Condition(worn=_dented),
    "worn all round": Condition(worn=_worn_all_round),
    "glints": Condition(worn=_glinting),
}
