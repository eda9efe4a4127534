"""What the measuring room says of a mated deck: offsets at its pin holes, plug gauges."""

from math import floor, hypot

from scipy.spatial.transform import RigidTransform

from fakes.scenes.deck_on_frame.parts import PartsTruth
from fakes.world.frames import MM

GAUGE_STEP_MM = 0.01
"""Plug gauges come in steps of this."""


def pin_offsets(parts: PartsTruth, frame_T_deck: RigidTransform) -> dict[str, dict[str, float]]:
    """Offset between deck and frame, and largest plug gauge that passes both, for each pin hole."""
    frame_holes = {hole.name: hole for hole in parts.frame_holes}
    pins = {}
    for hole in parts.deck_holes:
        if hole.kind != "pin":
            continue
        x, y, _ = frame_T_deck.apply([*hole.position_m, -parts.deck_thickness_m]) / MM
        frame_x, frame_y = (value / MM for value in frame_holes[hole.name].position_m)
        offset_mm = hypot(x - frame_x, y - frame_y)
        pins[hole.name] = {
            "dx_mm": float(x - frame_x),
            "dy_mm": float(y - frame_y),
            "offset_mm": offset_mm,
            "gauge_mm": largest_gauge_mm(hole.diameter_m / MM - offset_mm),
        }
    return pins


def largest_gauge_mm(opening_mm: float) -> float:
    """Largest gauge not thicker than what both holes leave open, 0 when nothing passes."""
    # The small addition, because an opening of a whole number of steps may come out a rounding
    # error below it.
    return max(0.0, round(floor(opening_mm / GAUGE_STEP_MM + 1e-9) * GAUGE_STEP_MM, 2))
