"""``python -m benchmarks.metrology.ablation``: what each term of the rim model is worth.

One term at a time is switched off and the same images are measured again: holes of many looks,
drawn by the second renderer, and machined parts, rendered as in the fake cell. Each term is judged
on the images that it is made for. What was tried and removed for want of an effect is listed in
docs/metrology.md; a term that changes nothing here should follow.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # Threads only slow the small solves down.

import argparse
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from typing import Any, Literal
from unittest.mock import patch

import cv2
import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.metrology.accuracy import MACHINED_GREY
from benchmarks.metrology.deck_over_frame import STEP_GREY, looks_of
from benchmarks.metrology.drawn_hard import HARD
from benchmarks.metrology.drawn_scenes import Scene, drawn_scene
from benchmarks.metrology.fake_station import SCENARIO
from benchmarks.metrology.figures import HoleErrors
from benchmarks.metrology.looks import measure
from benchmarks.metrology.loop import Setting
from cellctl.vision import measure as pair_measure
from cellctl.vision.features.countersink import Countersink
from cellctl.vision.features.pin import Pin
from cellctl.vision.features.thread import Thread
from cellctl.vision.rim import (
    covariance,
    fit_input,
    light,
    noise,
    problem,
    selection,
    shape,
    solver,
    stereo_fit,
)
from fakes.render import api
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from tests.rigs.metrology.scenes import parts

PARTS: dict[str, Literal["deck", "frame"]] = {"deck": "deck", "frame": "frame"}
HANGING = "deck over frame"
WALLS = ("lit wall", "bright wall", "fading wall", "faint wall")
CONES = ("flat cone", "bright cone", "near cone", "narrow cone", "true cone")
THREADS = ("turns", "chamfered turns", "frame")
DENTED = ("dented", "dented in a tenth", "worn all round")
RINGS = ("broken edge", "narrow cone", *THREADS)
EVERYTHING = ("disc", *WALLS, *CONES, "deck", *RINGS)

Replacement = tuple[Any, str, Any]
"""A module or class, the name of something in it, and what takes its place."""
Function = Callable[..., Any]


@dataclass(frozen=True, slots=True)
class Term:
    """One term of the model, and how to do without it."""

    name: str
    images: tuple[str, ...]
    """Looks, hard conditions, the parts ``deck`` and ``frame``, and the deck over the frame."""
    without: tuple[Replacement, ...]


def always(value: object) -> Function:
    """A function that gives the same whatever it is asked."""
    return lambda *_: value


def less(name: str, *gone: slice, only_if: Callable[[Any], bool] | None = None) -> Replacement:
    """The terms of one surface's light without some rows; ``only_if`` judges the light model."""
    full: Function = getattr(light, name)

    def fewer(*arguments: Any) -> Any:
        terms, sigma = full(*arguments)
        if only_if is not None and not only_if(arguments[-1]):
            return terms, sigma
        kept = np.ones(len(terms), dtype=bool)
        for rows in gone:
            kept[rows] = False
        return terms[kept], sigma[kept]

    return light, name, fewer


def changed(module: Any, name: str, change: Callable[[Function], Function]) -> Replacement:
    """A function of a module, changed."""
    return module, name, change(getattr(module, name))


def no_covariance(of_problem: Any, *_: object) -> Any:
    """A covariance of zeros for centres and radius, in a problem of one or two views."""
    size = 2 * len(of_problem.views) + 1
    return np.zeros((size, size))


TERMS = (
    Term("lay of the face", ("deck", "frame"), ((fit_input, "surface_lay", always(None)),)),
    Term(
        "gradient of the face",
        ("disc", "deck", "frame"),
        (less("_plate", slice(1, 3), only_if=lambda model: not model.cone),),
    ),
    Term(
        "wall of a bore",
        (*WALLS, "deck"),
        ((Pin, "may_show_wall", False), (Countersink, "may_show_wall", False)),
    ),
    Term("wall: another rate of fading", (*WALLS, "deck"), (less("_wall", slice(3, 6)),)),
    Term("wall: light of its own in the deep", (*WALLS, "deck"), (less("_wall", slice(6, 9)),)),
    Term(
        "wall: tried from several depths",
        (*WALLS, "deck"),
        ((selection, "_WALL_DEPTHS_M", (4e-3,)),),
    ),
    Term(
        "grey at the middle of what a pixel sees",
        EVERYTHING,
        ((light, "_middle", lambda pixels, *_: pixels.points),),
    ),
    Term(
        "bore: any light inside",
        (*WALLS, "disc", "deck", HANGING),
        ((selection, "_of_uneven_inside", lambda _, walled: walled),),
    ),
    Term("half level of a bent edge", ("disc", *WALLS), ((shape, "_bend_px", always(0.0)),)),
    Term("movement and focus of the image", EVERYTHING, ((pair_measure, "_SPREAD_ROUNDS", 0),)),
    Term(
        "cone: radial slope",
        (*CONES, "deck"),
        (less("_plate", slice(5, 6), only_if=lambda model: model.cone),),
    ),
    Term(
        "cone and ring: second harmonic",
        (*CONES, "deck", *RINGS),
        (changed(light, "_around", lambda full: lambda *given: full(*given)[:3]),),
    ),
    Term(
        "cone: clear of its outer edge",
        CONES,
        ((fit_input, "clearance_px", always(np.full(1, np.inf))),),
    ),
    Term("cone: second edge when narrow", CONES, ((Countersink, "second_edge", always(None)),)),
    Term(
        "bore: broken edge", ("disc", *WALLS, "broken edge"), ((Pin, "second_edge", always(None)),)
    ),
    Term("thread: chamfer and turns", THREADS, ((Thread, "second_edge", always(None)),)),
    Term("ring as a cone", RINGS, ((selection, "_RING_SLOPES", (0.0,)),)),
    Term("ring as flat", RINGS, ((selection, "_RING_SLOPES", (1.0,)),)),
    Term(
        "ring shared by both cameras",
        RINGS,
        (
            changed(
                problem,
                "surfaces",
                lambda full: lambda *given: [replace(one, ring=False) for one in full(*given)],
            ),
        ),
    ),
    Term(
        "blur known from other rims",
        RINGS,
        (
            changed(
                stereo_fit,
                "fit_two_edges",
                lambda full: (
                    lambda given, second, _, wall_ratio: full(given, second, None, wall_ratio)
                ),
            ),
        ),
    ),
    Term(
        "turns: third harmonic",
        THREADS,
        (
            less(
                "_inside", slice(5, 7), slice(12, 14), only_if=lambda model: model.uneven_grey > 0.0
            ),
        ),
    ),
    Term(
        "turns: curved with the depth",
        THREADS,
        (less("_inside", slice(14, 19), only_if=lambda model: model.uneven_grey > 0.0),),
    ),
    Term("outliers weigh less", ("lit wall", "turns", "deck"), ((noise, "_HUBER", 1e9),)),
    Term(
        "arcs off the circle leave",
        ("dented", "glints", *WALLS, "deck", HANGING),
        ((selection, "_LEAST_LEFT_OUT", 1.0),),
    ),
    Term("arcs: a wall is seen", DENTED, ((solver.RimFit, "crescent_px", np.inf),)),
    Term("arcs: the rest is a circle", DENTED, ((selection, "rest_waves", always(value=False)),)),
    Term("covariance: doubt of the rest", DENTED, ((covariance, "_doubt_of_rest", always(1.0)),)),
    Term("lower edge must settle", (*WALLS, "deck"), ((solver, "_LOWER_EDGE", 0.0),)),
    Term(
        "covariance: alike over arcs",
        (*WALLS, "deck"),
        ((covariance, "arc_covariance", lambda scores, _: np.zeros((len(scores),) * 2)),),
    ),
    Term(
        "covariance: uneven light", EVERYTHING, ((covariance, "_model_covariance", no_covariance),)
    ),
    Term(
        "covariance: other models",
        EVERYTHING,
        (
            changed(
                stereo_fit,
                "with_covariance",
                lambda full: lambda fit, spread: full(fit, np.zeros_like(spread)),
            ),
        ),
    ),
)


def scenes(image: str, count: int) -> list[Scene]:
    """Scenes of one look, or of one head's half of a machined part."""
    if image == HANGING:
        return [scene for seed in range((count + 1) // 2) for scene in _hanging(seed)][:count]
    if image not in PARTS:
        if image in HARD:
            return [drawn_scene("disc", seed, HARD[image]) for seed in range(count)]
        return [drawn_scene(image, seed) for seed in range(count)]
    seen = parts(PARTS[image], api.RenderOptions(), (count + 1) // 2, 1, seed=1)
    views = [view for part in seen for view in part.views][:count]
    steps = [{hole.name: MACHINED_GREY[hole.kind] for hole in view.holes} for view in views]
    return [Scene(view, step) for view, step in zip(views, steps, strict=True)]


def _hanging(seed: int) -> Iterator[Scene]:
    """A deck over its frame, as each head of one fake cell sees it."""
    scenario = DeckScenario.read(SCENARIO)
    for _, (view,) in looks_of(Setting.shipped(), scenario, seed, 1, ("60 deck over frame",)):
        yield Scene(view, {hole.name: STEP_GREY for hole in view.holes})


def figures(images: Sequence[str], cache: dict[str, list[Scene]]) -> list[str]:
    """95 % of the errors, median over the bound, normalised error squared, refused, diameters."""
    errors, refused = HoleErrors(), 0
    for image in images:
        plain = 0 if image in PARTS or image == HANGING else 1
        for scene in cache[image]:
            refused += measure(scene, errors, "default", skip=plain) is not None
    return [
        f"{errors.p95_px():.3f}",
        f"{errors.median_ratio():.2f}",
        f"{float(np.mean(errors.squared_2d)):.2f}",
        str(refused),
        f"{errors.diameter_bias_permille():+.1f}",
    ]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", type=int, default=8, help="scenes of each look")
    parser.add_argument("--term", action="append", help="part of a term's name; default: all")
    arguments = parser.parse_args()
    cv2.setNumThreads(1)
    wanted = [
        term
        for term in TERMS
        if not arguments.term or any(part in term.name for part in arguments.term)
    ]
    images = dict.fromkeys(image for term in wanted for image in term.images)
    cache = {image: scenes(image, arguments.n) for image in track(images, "scenes", transient=True)}
    whole: dict[tuple[str, ...], list[str]] = defaultdict(list)
    table = Table("without", "images", "p95, px", "× CRLB", "error² of 2", "refused", "diameter, ‰")
    for term in track(wanted, "terms", transient=True):
        if not whole[term.images]:
            whole[term.images] = figures(term.images, cache)
        with ExitStack() as stack:
            for owner, name, instead in term.without:
                stack.enter_context(patch.object(owner, name, instead))
            without = figures(term.images, cache)
        pairs = zip(whole[term.images], without, strict=True)
        table.add_row(term.name, str(len(term.images)), *(f"{a} → {b}" for a, b in pairs))
    Console(width=120).print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
