"""Dowel pins in the frame that enter the pin holes of the deck, with clearance and chamfers.

In the plane through pin axis and a direction u the deck's hole meets a convex obstacle: the pin's
wall, the chamfers of pin and hole taken together, and the top. With rho the offset of the hole
along u and z the height of the deck's underside above the frame, the obstacle is

    rho > clearance   and   z < length   and   below the chamfer's line

Whoever is inside is pushed out through the nearest of the three faces. Sixteen directions a pin,
which share its top: that carries once, with the stiffness of the pin.
The hole is felt at its mouth only: no resistance against tilt by a long engagement.
"""

from dataclasses import dataclass

import numpy as np

from fakes.scenes.deck_on_frame.parts import PartsTruth
from fakes.scenes.deck_on_frame.scenario import Pins
from fakes.world.frames import MM, Array

DIRECTIONS = 16


@dataclass(frozen=True, slots=True, eq=False)
class PinFaces:
    """Three rows each direction and pin: wall, chamfer, top."""

    points_m: Array
    """Positions in the deck's frame."""
    directions: Array
    anchors_m: Array


def pin_faces(pins: Pins, parts: PartsTruth) -> PinFaces:
    """Faces of all pins as they were made."""
    holes = {hole.name: hole for hole in parts.deck_holes if hole.kind == "pin"}
    rows = [
        _faces(pins, np.array(pin.position_m), np.array(holes[pin.name].position_m), angle)
        for pin in parts.frame_holes
        if pin.kind == "pin"
        for angle in 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    ]
    points, directions, anchors = (np.concatenate(part) for part in zip(*rows, strict=True))
    points[:, 2] = -parts.deck_thickness_m
    return PinFaces(points, directions, anchors)


def _faces(pins: Pins, pin_m: Array, hole_m: Array, angle: float) -> tuple[Array, Array, Array]:
    """Points, directions and anchors of the three faces, shape (3, 3) each."""
    along = np.array([np.cos(angle), np.sin(angle)])
    slope = np.deg2rad(pins.chamfer_deg)
    rim_m = hole_m - pins.radius_mm * MM * along
    anchor_m = pin_m + (pins.clearance_mm - pins.radius_mm) * MM * along
    heights_m = np.array([0.0, pins.length_mm - pins.chamfer_mm, pins.length_mm]) * MM
    directions = np.array(
        [
            [*-along, 0.0],
            [*(-np.cos(slope) * along), np.sin(slope)],
            [0.0, 0.0, 1.0],
        ]
    )
    points = np.column_stack([np.tile(rim_m, (3, 1)), np.zeros(3)])
    anchors = np.column_stack([np.tile(anchor_m, (3, 1)), heights_m])
    return points, directions, anchors
