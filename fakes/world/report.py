"""The truth as JSON values, for the measuring room of a demonstration: mm, degrees, N."""

from math import floor, hypot
from typing import Any

from scipy.spatial.transform import RigidTransform

from fakes.world.frames import MM, to_written
from fakes.world.snapshot import Snapshot
from fakes.world.truth import PartsTruth
from fakes.world.views import camera_pose

GAUGE_STEP_MM = 0.01
"""Plug gauges come in steps of this."""


def truth_report(world: Snapshot) -> dict[str, Any]:
    """True poses, pin holes, contact forces."""
    camera_1, camera_2 = camera_pose(world, "head_1"), camera_pose(world, "head_2")
    report: dict[str, Any] = {
        "seed": world.seed,
        "hardware_seed": world.truth.hardware_seed,
        "time_s": world.time_s,
        "load": world.loads,
        "base_T_flange_mm_deg": to_written(world.flanges["main"]),
        "base_T_c1_mm_deg": to_written(camera_1),
        "base_T_c2_mm_deg": to_written(camera_2),
        "c1_T_c2_mm_deg": to_written(camera_1.inv() * camera_2),
        "base_T_c_mm_deg": to_written(world.truth.large_field.cell_T_head),
        "contact_force_n": world.contact_force_n,
        "peak_contact_force_n": world.peak_contact_force_n,
    }
    parts, cell_T_deck = world.placed.parts, world.cell_T_deck
    if parts is not None:
        report["base_T_frame_mm_deg"] = to_written(parts.cell_T_frame)
        report["flange_T_deck_mm_deg"] = to_written(parts.flange_T_deck)
        report["deck_thickness_mm"] = parts.deck_thickness_m / MM
        report["contact_stiffness_n_m"] = parts.contact_stiffness_n_m
    if parts is not None and cell_T_deck is not None:
        frame_T_deck = parts.cell_T_frame.inv() * cell_T_deck
        report["base_T_deck_mm_deg"] = to_written(cell_T_deck)
        report["frame_T_deck_mm_deg"] = to_written(frame_T_deck)
        report["pins"] = pin_offsets(parts, frame_T_deck)
    return report


def pin_offsets(parts: PartsTruth, frame_T_deck: RigidTransform) -> dict[str, dict[str, float]]:
    """Of each pin hole: offset between deck and frame, largest plug gauge that passes both."""
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
    return max(0.0, round(floor(opening_mm / GAUGE_STEP_MM + 1e-9) * GAUGE_STEP_MM, 2))
