"""``python -m benchmarks.metrology_ablation``: what each term of the rim model is worth.

One term at a time is switched off and the same images are measured again: holes of many looks,
drawn by the second renderer, and machined parts, rendered as in the fake cell. Each term is judged
on the images that it is made for. What was tried and removed for want of an effect is listed in
docs/metrology.md; a term that changes nothing here should follow.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # Threads only slow the small solves down.

import argparse
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from typing import Any
from unittest.mock import patch

import cv2
import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.drawn_scenes import Scene, drawn_scene
from benchmarks.metrology import MACHINED_GREY
from benchmarks.metrology_figures import HoleErrors
from benchmarks.metrology_looks import measure
from benchmarks.metrology_scenes import parts
from cellctl.vision.features.countersink import Countersink
from cellctl.vision.features.pin import Pin
from cellctl.vision.features.thread import Thread
from cellctl.vision.rim import covariance, fit_input, light, noise, problem, selection, shape, solver
from fakes.render import api

WALLS = ("lit wall", "bright wall", "fading wall", "faint wall")
CONES = ("flat cone", "bright cone", "narrow cone", "true cone")
THREADS = ("turns", "chamfered turns")
RINGS = ("broken edge", "narrow cone", *THREADS, "frame")
EVERYTHING = ("disc", *WALLS, *CONES, "broken edge", *THREADS, "deck", "frame")

Replacement = tuple[Any, str, Any]
"""A module or class, the name of something in it, and what takes its place."""


@dataclass(frozen=True, slots=True)
class Term:
    """One term of the model, and how to do without it."""

    name: str
    images: tuple[str, ...]
    """Looks, and the parts ``deck`` and ``frame``."""
    without: tuple[Replacement, ...]


def _always(value: object) -> Callable[..., Any]:
    return lambda *_: value


def _without_rows(function: Callable[..., Any], *gone: slice) -> Callable[..., Any]:
    """Terms of the light and their priors, less the rows ``gone``."""

    def fewer(*arguments: Any) -> Any:
        terms, sigma = function(*arguments)
        kept = np.ones(len(terms), dtype=bool)
        for rows in gone:
            kept[rows] = False
        return terms[kept], sigma[kept]

    return fewer


def _first_harmonic(points: Any, of: Any) -> Any:
    return _AROUND(points, of)[:3]


def _unshared(*arguments: Any) -> Any:
    return [replace(surface, ring=False) for surface in _SURFACES(*arguments)]


def _turns_less(*gone: slice) -> Callable[..., Any]:
    """The inside of a rim with fewer terms for the turns of a thread."""
    fewer = _without_rows(light._inside, *gone)  # noqa: SLF001
    full = light._inside  # noqa: SLF001

    def inside(points: Any, of: Any, model: Any) -> Any:
        return (fewer if model.turns_grey else full)(points, of, model)

    return inside


_AROUND, _SURFACES = light._around, problem.surfaces  # noqa: SLF001


def _no_spread(fit: Any, spread: Any) -> Any:
    return _RATED(fit, np.zeros_like(spread))


_RATED = covariance.with_covariance

TERMS: tuple[Term, ...] = ()
