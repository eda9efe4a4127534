"""What a tracker measures: the positions of targets on flanges and bodies."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.scenario_file.sections import Tracker
from fakes.world.frames import MM, Array

UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True, eq=False)
class Target:
    """A target at its real place on the body that carries it."""

    name: str
    cell_T_body: RigidTransform
    place_m: Array
    facing: Array
    """Unit vector away from the body, in its frame."""


@dataclass(frozen=True, slots=True, eq=False)
class SeenTarget:
    """Mean of a target's position in the frame of the tracker, and its standard deviation."""

    name: str
    position_m: Array
    sigma_m: float


def flange_targets(
    cell_T_flange: RigidTransform, places_m: Mapping[str, Array]
) -> Iterator[Target]:
    """The ring on a flange; it is seen from behind, where the arm is."""
    return (Target(name, cell_T_flange, place, -UP) for name, place in places_m.items())


def seen_targets(
    settings: Tracker,
    cell_T_tracker: RigidTransform,
    candidates: Iterable[Target],
    frames: int,
    rng: np.random.Generator,
) -> tuple[SeenTarget, ...]:
    """Targets in view, with the noise of the mean of so many exposures.

    Hidden targets use up their share of ``rng`` too, so that the noise of one target does not
    depend on whether another is in view.
    """
    tracker_T_cell = cell_T_tracker.inv()
    sigma_m = settings.noise_mm * MM / np.sqrt(frames)
    seen = []
    for target in candidates:
        tracker_T_body = tracker_T_cell * target.cell_T_body
        position = tracker_T_body.apply(target.place_m)
        noise = rng.normal(0, sigma_m, 3)
        if _visible(settings, position, tracker_T_body.rotation.apply(target.facing)):
            seen.append(SeenTarget(target.name, position + noise, float(sigma_m)))
    return tuple(seen)


def _visible(settings: Tracker, position: Array, facing: Array) -> bool:
    """True for a target in range, within the cone of view, and turned towards the tracker."""
    near, far = settings.range_mm
    range_m = float(np.linalg.norm(position))
    in_range = near * MM <= range_m <= far * MM
    in_cone = position[2] >= range_m * np.cos(np.deg2rad(settings.half_angle_deg))
    turned = facing @ -position >= range_m * np.cos(np.deg2rad(settings.tilt_max_deg))
    return bool(in_range and in_cone and turned)
