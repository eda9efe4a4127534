"""What the large-field head measures."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.scenario import LargeField
from fakes.world.frames import MM, Array, stream
from fakes.world.snapshot import Snapshot


@dataclass(frozen=True, slots=True)
class SeenTarget:
    """Mean of a target's position in the frame of the head, and its standard deviation."""

    name: str
    position_m: Array
    sigma_m: float


def seen_targets(world: Snapshot, frames: int, exposure: int) -> tuple[SeenTarget, ...]:
    """Targets in view, with the noise of so many exposures."""
    settings, rng = world.scenario.large_field, stream(world.seed, "targets", exposure)
    head_T_cell = world.truth.large_field.cell_T_head.inv()
    sigma_m = settings.noise_mm * MM / np.sqrt(frames)
    seen = []
    for name, head_T_body, place, facing in _candidates(world, head_T_cell):
        position = head_T_body.apply(place)
        noise = rng.normal(0, sigma_m, 3)
        if _visible(settings, position, head_T_body.rotation.apply(facing)):
            seen.append(SeenTarget(name, position + noise, float(sigma_m)))
    return tuple(seen)


def _candidates(
    world: Snapshot, head_T_cell: RigidTransform
) -> Iterator[tuple[str, RigidTransform, Array, Array]]:
    """Name, pose of the body that carries it, place on that body, direction it faces."""
    truth, up = world.truth.large_field, np.array([0.0, 0.0, 1.0])
    head_T_flange = head_T_cell * world.flanges["main"]
    for name, place in truth.flange_targets_m.items():
        yield name, head_T_flange, place, -up
    if world.placed.target_board is not None:
        head_T_board = head_T_cell * world.placed.target_board
        for name, place in truth.board_targets_m.items():
            yield name, head_T_board, place, up


def _visible(settings: LargeField, position: Array, facing: Array) -> bool:
    """In range, within the cone of view, and turned towards the head."""
    near, far = settings.range_mm
    range_m = float(np.linalg.norm(position))
    in_range = near * MM <= range_m <= far * MM
    in_cone = position[2] >= range_m * np.cos(np.deg2rad(settings.half_angle_deg))
    turned = facing @ -position >= range_m * np.cos(np.deg2rad(settings.tilt_max_deg))
    return bool(in_range and in_cone and turned)
