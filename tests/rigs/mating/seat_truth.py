"""How the deck truly sits on the frame, from the geometry of the fake cell alone."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.scenes.deck_on_frame.gauges import pin_offsets
from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from fakes.world.frames import MM


@dataclass(frozen=True, slots=True)
class SeatTruth:
    """One moment of a deck over its frame; lengths in mm."""

    gap_mm: float
    """Height of the deck's middle over its seat, less what the seat gives way there. It is zero
    where the face is closed all round, however soft the seat is and whatever else carries."""
    opening_mm: float
    """Greatest distance between the deck and a pad of the seat; 0 when all of them bear."""
    pin_error_mm: float
    """Greatest distance, across the approach, between a pin and the axis of its hole."""


def seat_truth(world: DeckOnFrame, M_T_D: RigidTransform) -> SeatTruth:
    """The deck at a true pose in the frame, such as the one it has at present."""
    parts, touch = world.placed.parts, world.payload.touch
    assert parts is not None
    assert touch is not None
    # The pads are the first of the contact points. How far each is pressed says what the seat gives
    # way; the whole force over its stiffness would not, because a burr or a pin carries a part of
    # the force beside it.
    heights_m = touch.points.gaps(M_T_D.as_matrix())[: world.scenario.contact.pads]
    middle_m = float(M_T_D.translation[2]) - parts.deck_thickness_m
    return SeatTruth(
        gap_mm=(middle_m + float(np.maximum(-heights_m, 0.0).mean())) / MM,
        opening_mm=max(float(heights_m.max()), 0.0) / MM,
        pin_error_mm=max(pin["offset_mm"] for pin in pin_offsets(parts, M_T_D).values()),
    )
