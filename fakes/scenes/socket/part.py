"""A peg and its hole as they were made, as they lie, and with what was injected into them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.faults import FaultBoard
from fakes.scenes.socket.scenario import FitSection, SocketScenario, SocketSection
from fakes.world.frames import MM, displacement, from_written, stream
from fakes.world.peg.fit import Burr, Fit, Keys
from fakes.world.truth import drawn_spread

FAULTS: Mapping[str, str] = {
    "hole_absent": "there is no hole in the face",
    "blocked": "something fills the hole from `depth_mm` on",
    "wrong_size": "the bore is narrower by `by_mm`",
    "wrong_hole": "it is another hole, wider by `by_mm`",
    "burr": "a chip of `height_mm` at `depth_mm` on the wall, at `azimuth_deg`",
    "peg_slip": "the fingers hold the peg with `grip_n` only",
    "key_missing": "the grooves of the keys fit at no yaw",
}
_PER_SIGMA = math.sqrt(2.0 * math.log(100.0))
"""Radius that holds 99 % of a normal draw in the plane, in standard deviations."""
_FLIP = RigidTransform.from_matrix(np.diag([1.0, -1.0, -1.0, 1.0]))


@dataclass(frozen=True, slots=True, eq=False)
class PegPart:
    """One peg and one hole."""

    cell_T_hole: RigidTransform
    """True place, z out of the hole."""
    flange_T_peg: RigidTransform
    """True place of the tip in the fingers, z from the tip into the peg."""


def draw_part(scenario: SocketScenario, seed: int, number: int) -> PegPart:
    """The ``number``-th part and where it lies."""
    grip = drawn_spread(stream(seed, "peg grip", number), scenario.peg.grip)
    return PegPart(
        _true_hole(scenario.socket, stream(seed, "socket", number)),
        from_written(scenario.peg.flange_T_tip_mm_deg) * grip * _FLIP,
    )


def fit_with(section: FitSection, faults: FaultBoard) -> Fit:
    """Shape with the faults that are injected now."""
    fit = nominal_fit(section)
    # Where there is no hole, its other faults have no meaning.
    if faults.active("hole_absent"):
        return replace(fit, hole_present=False)
    if (fault := faults.active("blocked")) is not None:
        fit = replace(fit, depth_m=fault.number("depth_mm", 0.5 * section.depth_mm) * MM)
    if (fault := faults.active("wrong_size")) is not None:
        fit = replace(fit, bore_radius_m=fit.bore_radius_m - _by_m(fit, fault.number("by_mm", 0)))
    if (fault := faults.active("wrong_hole")) is not None:
        fit = replace(fit, bore_radius_m=fit.bore_radius_m + fault.number("by_mm", 0.15) * MM)
    if (fault := faults.active("burr")) is not None:
        depth_m = fault.number("depth_mm", 0.5 * section.depth_mm) * MM
        height_m = fault.number("height_mm", 2.0 * fit.clearance_m / MM) * MM
        fit = replace(
            fit, burr=Burr(depth_m, height_m, math.radians(fault.number("azimuth_deg", 0.0)))
        )
    if faults.active("key_missing") and fit.keys is not None:
        fit = replace(fit, keys=replace(fit.keys, present=False))
    return fit


def grip_force_n(scenario: SocketScenario, faults: FaultBoard) -> float:
    """Axial force (N) at which the peg slips now."""
    fault = faults.active("peg_slip")
    return scenario.peg.grip_force_n if fault is None else fault.number("grip_n", 8.0)


def nominal_fit(section: FitSection) -> Fit:
    """Shape as drawn."""
    keys = section.keys
    return Fit(
        peg_radius_m=section.peg_radius_mm * MM,
        bore_radius_m=section.bore_radius_mm * MM,
        depth_m=section.depth_mm * MM,
        hole_chamfer_m=section.hole_chamfer_mm * MM,
        peg_chamfer_m=section.peg_chamfer_mm * MM,
        outer_radius_m=_length_m(section.outer_radius_mm),
        proud_m=_length_m(section.proud_mm),
        friction=section.friction,
        contact_forces=tuple((depth * MM, force) for depth, force in section.contacts),
        keys=None if keys is None else Keys(keys.depth_mm * MM, math.radians(keys.window_deg)),
    )


def _by_m(fit: Fit, by_mm: float) -> float:
    """The size that is asked for, else a little more than the clearance."""
    return by_mm * MM if by_mm > 0 else fit.clearance_m + 0.05 * MM


def _length_m(length_mm: float | None) -> float:
    return math.inf if length_mm is None else length_mm * MM


def _true_hole(section: SocketSection, rng: np.random.Generator) -> RigidTransform:
    side_m = rng.normal(0.0, section.lateral_p99_mm * MM / _PER_SIGMA, 2)
    up_m = rng.uniform(-1.0, 1.0) * section.height_spread_mm * MM
    tilt = rng.uniform(-1.0, 1.0, 2) * math.radians(section.tilt_spread_deg)
    yaw = rng.uniform(-1.0, 1.0) * math.radians(section.yaw_spread_deg)
    off = displacement([*side_m, up_m], [*tilt, yaw])
    return from_written(section.cell_T_hole_mm_deg) * off
