"""``python -m benchmarks.metrology_ablation``: what each term of the rim model is worth.

One term at a time is switched off, and the same images are measured again: holes of many looks
from the second renderer, and machined parts from that of the fake cell. A term that changes nothing
here has no place in the model (docs/metrology.md). Each term is judged on the looks that it is made
for; a line "all" gives the complete model on the same images.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # Threads only slow the small solves down.

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

BORES = ("disc", "lit wall", "bright wall", "fading wall", "faint wall", "broken edge")
CONES = ("flat cone", "bright cone", "narrow cone", "true cone")
THREADS = ("turns", "chamfered turns")
PARTS = ("deck", "frame")
EVERYWHERE = (*BORES, *CONES, *THREADS, *PARTS)
RINGS = ("broken edge", "narrow cone", "true cone", *THREADS, *PARTS)

Replacement = tuple[Any, str, Any]
"""A module or class, the name of something in it, and what takes its place."""


@dataclass(frozen=True, slots=True)
class Term:
    """One term of the model and how to do without it."""

    name: str
    groups: tuple[str, ...]
    without: tuple[Replacement, ...]


def _nothing(*_: object, **__: object) -> None:
    return None


def _no_covariance(rows: int | None = None) -> Callable[..., Any]:
    def zero(*arguments: Any) -> Any:
        size = len(arguments[rows]) if rows is not None else 2 * len(arguments[0].views) + 1
        return np.zeros((size, size))

    return zero


def _first_terms(function: Callable[..., Any], keep: Sequence[int]) -> Callable[..., Any]:
    """A function of terms and their priors, less some of the terms."""

    def fewer(*arguments: Any) -> Any:
        terms, sigma = function(*arguments)
        kept = [index for index in keep if index < len(terms)]
        return terms[kept], sigma[kept]

    return fewer


def _no_wall(_: object, ratios: Sequence[float]) -> tuple[float, float]:
    return ratios[0], 0.0


def _no(_: object) -> bool:
    return False


TERMS: tuple[Term, ...] = ()
