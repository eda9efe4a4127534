"""One pair of frame and deck: how the operator loads them, and how they were really made."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.scenes.deck_on_frame.scenario import DeckScenario, HoleSpec, Parts
from fakes.world.frames import MM, displacement, from_written, stream, stream_seed
from fakes.world.scene import HoleKind, SceneHole
from fakes.world.truth import drawn_spread

_SLIP_LEVER_M = 0.5
"""Half the length of the deck: its end slips as far by turning as its middle by shifting."""


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
    burr_m: tuple[float, float, float] | None = None
    """x and y on the underside of the deck, and height; None for a deck without one."""


def draw_parts(scenario: DeckScenario, seed: int, number: int) -> PartsTruth:
    """The ``number``-th pair of parts of a cell."""
    parts = scenario.parts
    rng = stream(seed, "parts", number)
    low, high = np.log(scenario.contact.stiffness_n_m)
    thickness_spread = parts.deck_thickness_spread_mm
    # A tap takes hold anywhere. Turns that all began at one azimuth would draw all images of
    # threads to one side, and a part measured through them with it.
    tapped = stream(seed, "threads", number).uniform(-np.pi, np.pi, len(parts.holes)).tolist()
    return PartsTruth(
        number=number,
        cell_T_frame=from_written(parts.frame_mm_deg) * drawn_spread(rng, parts.frame_displacement),
        flange_T_deck=from_written(parts.flange_T_deck_mm_deg) * drawn_spread(rng, parts.grip),
        deck_thickness_m=(
            parts.deck_thickness_mm + rng.uniform(-thickness_spread, thickness_spread)
        )
        * MM,
        contact_stiffness_n_m=float(np.exp(rng.uniform(low, high))),
        frame_holes=tuple(
            replace(_frame_hole(parts, hole, rng), thread_begins_rad=thread_begins_rad)
            for hole, thread_begins_rad in zip(parts.holes, tapped, strict=True)
        ),
        deck_holes=tuple(_deck_hole(parts, hole, rng) for hole in parts.holes),
        frame_seed=stream_seed(seed, "frame texture", number),
        deck_seed=stream_seed(seed, "deck texture", number),
        burr_m=_burr(scenario, seed, number),
    )


def grip_slips(scenario: DeckScenario, seed: int, number: int) -> Iterator[RigidTransform]:
    """How far the ``number``-th deck slips in the gripper, at each start of a motion."""
    size_m = scenario.size_of("grip_slip") * MM
    rng = stream(seed, "grip slip", number)
    while size_m > 0:
        shift, turn = rng.uniform(-size_m, size_m, (2, 3))
        yield displacement(shift, turn / _SLIP_LEVER_M)


def _burr(scenario: DeckScenario, seed: int, number: int) -> tuple[float, float, float] | None:
    """Somewhere on the rim, where the deck rests on the frame."""
    height_m = scenario.size_of("burr") * MM
    if not height_m:
        return None
    angle = stream(seed, "burr", number).uniform(0, 2 * np.pi)
    half_m = (np.array(scenario.parts.size_mm) / 2 - scenario.contact.rim_inset_mm) * MM
    x, y = half_m * [np.cos(angle), np.sin(angle)] / max(abs(np.cos(angle)), abs(np.sin(angle)))
    return float(x), float(y), height_m


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
