"""One pair of frame and deck: how the operator loads them, and how they were really made."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.scenes.deck_on_frame.scenario import DeckScenario, HoleSpec, Parts
from fakes.world.frames import MM, from_written, stream, stream_seed
from fakes.world.scene import HoleKind, SceneHole
from fakes.world.truth import drawn_spread


@dataclass(frozen=True, slots=True)
class PartsTruth:
    """One pair of frame and deck, as loaded by the operator."""

    number: int
    cell_T_frame: RigidTransform
    flange_T_deck: RigidTransform
    deck_thickness_m: float
    frame_holes: tuple[SceneHole, ...]
    deck_holes: tuple[SceneHole, ...]
    contact_stiffness_n_m: float
    frame_seed: int
    deck_seed: int


def draw_parts(scenario: DeckScenario, seed: int, number: int) -> PartsTruth:
    """The ``number``-th pair of parts of a cell."""
    parts = scenario.parts
    rng = stream(seed, "parts", number)
    low, high = np.log(scenario.contact.stiffness_n_m)
    thickness_spread = parts.deck_thickness_spread_mm
    return PartsTruth(
        number=number,
        cell_T_frame=from_written(parts.frame_mm_deg) * drawn_spread(rng, parts.frame_displacement),
        flange_T_deck=from_written(parts.flange_T_deck_mm_deg) * drawn_spread(rng, parts.grip),
        deck_thickness_m=(
            parts.deck_thickness_mm + rng.uniform(-thickness_spread, thickness_spread)
        )
        * MM,
        contact_stiffness_n_m=float(np.exp(rng.uniform(low, high))),
        frame_holes=tuple(_frame_hole(parts, hole, rng) for hole in parts.holes),
        deck_holes=tuple(_deck_hole(parts, hole, rng) for hole in parts.holes),
        frame_seed=stream_seed(seed, "frame texture", number),
        deck_seed=stream_seed(seed, "deck texture", number),
    )


def _frame_hole(parts: Parts, hole: HoleSpec, rng: np.random.Generator) -> SceneHole:
    diameter = parts.pin_diameter_mm if hole.pin else parts.thread_diameter_mm
    place = _machined(parts, hole, rng)
    kind: HoleKind = "pin" if hole.pin else "thread"
    depth = parts.frame_depth_mm * MM
    return SceneHole(hole.name, kind, place, diameter * MM, None, depth, through=hole.pin)


def _deck_hole(parts: Parts, hole: HoleSpec, rng: np.random.Generator) -> SceneHole:
    place = _machined(parts, hole, rng)
    depth = parts.deck_thickness_mm * MM
    if hole.pin:
        return SceneHole(
            hole.name, "pin", place, parts.pin_diameter_mm * MM, None, depth, through=True
        )
    return SceneHole(
        hole.name,
        "countersink",
        place,
        parts.bore_diameter_mm * MM,
        parts.countersink_mm * MM,
        depth,
        through=True,
    )


def _machined(parts: Parts, hole: HoleSpec, rng: np.random.Generator) -> tuple[float, float]:
    place = (np.array(hole.position_mm) + rng.normal(0, parts.hole_sigma_mm, 2)) * MM
    return float(place[0]), float(place[1])
