"""Moves the main robot of a world as an all-knowing operator would."""

from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from fakes.world.arm import inverse
from fakes.world.frames import from_written
from fakes.world.world import World

SETTLE_S = 1.5


def to_taught(world: World[Any], robot: str, name: str, settle_s: float = SETTLE_S) -> None:
    arm = world.arms[robot]
    cell_T_base = from_written(arm.settings.base_mm_deg)
    pose = cell_T_base.inv() * from_written(world.scenario.taught[robot][name])
    joints = inverse(arm.settings.chain_mm, pose, arm.joints(world.time_s))
    arm.start_joint(world.time_s, joints, 100)
    world.advance(arm.standstill_s + settle_s)


def deck_to(
    world: DeckOnFrame,
    frame_T_deck: RigidTransform,
    speed_m_s: float = 0.05,
    acceleration_m_s2: float = 0.2,
    settle_s: float = SETTLE_S,
) -> None:
    """Command the flange so that the undeflected deck comes to a pose over the frame."""
    arm, parts = world.arms["main"], world.placed.parts
    assert parts is not None
    wanted = parts.cell_T_frame * frame_T_deck * parts.flange_T_deck.inv()
    change = world.flange("main").inv() * wanted
    target = arm.encoder_pose(world.time_s) * change
    arm.start_linear(world.time_s, target, speed_m_s, acceleration_m_s2)
    world.advance(arm.standstill_s + settle_s)


def above(world: DeckOnFrame, gap_m: float, x_m: float = 0.0) -> RigidTransform:
    """frame_T_deck with so much room between deck and frame."""
    parts = world.placed.parts
    assert parts is not None
    return RigidTransform.from_translation([x_m, 0.0, parts.deck_thickness_m + gap_m])


def undeflected_gap_m(world: DeckOnFrame) -> float:
    """Room between deck and frame if the gripper were rigid; negative when pressed."""
    parts = world.placed.parts
    assert parts is not None
    flange = world.flange("main")
    frame_T_deck = parts.cell_T_frame.inv() * flange * parts.flange_T_deck
    return float(frame_T_deck.translation[2]) - parts.deck_thickness_m


def hovering(world: DeckOnFrame, gap_m: float = 2e-3) -> DeckOnFrame:
    to_taught(world, "main", "deck_measure", settle_s=0.0)
    # What swings on the way there has no part in where the flange goes next.
    deck_to(world, above(world, gap_m), settle_s=0.0)
    deck_to(world, above(world, gap_m))
    return world


def mean_reading(world: DeckOnFrame, samples: int = 500) -> np.ndarray:
    start = world.time_s
    readings = [world.sensor_wrench("force", start + 1e-3 * k) for k in range(samples)]
    return np.asarray(np.mean(readings, axis=0))
