"""Is the deck seated? Force alone does not say: depth and side load must agree."""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from cellctl.geometry.pose import Array

EDGE_MARGIN_N_M = 2.75, 1.5
"""What tare, friction and the lever of the side force may add to a moment about x and y."""
REST_RATIO = 0.8
"""Share of the side load allowed on the way that a seated deck may keep."""


class SeatFinding(Enum):
    """One way in which a seat can be wrong."""

    FORCE_LOW = "force below its window"
    FORCE_HIGH = "force above its window"
    HIGH = "deck stands above its seat"
    DEEP = "deck lies below its seat"
    LATERAL = "lateral force beyond its bound"
    MOMENT = "moment beyond its bound"


@dataclass(frozen=True, slots=True)
class SeatLimits:
    """Bounds of a good seat."""

    force_low_n: float
    force_high_n: float
    lateral_n: float
    moment_n_m: tuple[float, float, float]
    """About x, y and z of the deck."""
    depth_m: float = 1e-4
    """Greatest distance between reached and expected depth, elastic travel taken off."""


def seat_limits(
    *,
    target_force_n: float,
    abort_force_n: float,
    max_lateral_n: float,
    half_size_m: tuple[float, float],
) -> SeatLimits:
    """Bounds of the seat of a mating that is complete at a force and aborted at another.

    A deck that is tilted within its tolerance may rest on an edge: the force times half the width
    or length (``half_size_m``: along x, along y) must be allowed, and little more. A deck at rest
    has no reason for the whole side force that is allowed on the way, nor for the moment about z
    that it would have at an end.
    """
    half_x_m, half_y_m = half_size_m
    margin_x_n_m, margin_y_n_m = EDGE_MARGIN_N_M
    lateral_n = REST_RATIO * max_lateral_n
    return SeatLimits(
        force_low_n=target_force_n,
        force_high_n=abort_force_n,
        lateral_n=lateral_n,
        moment_n_m=(
            abort_force_n * half_y_m + margin_x_n_m,
            abort_force_n * half_x_m + margin_y_n_m,
            REST_RATIO * lateral_n * half_x_m,
        ),
    )


@dataclass(frozen=True, slots=True)
class SeatVerdict:
    """The seat as measured against its limits."""

    force_n: float
    gap_m: float
    """Expected minus reached depth; positive: the deck stands above its seat."""
    lateral_n: float
    moment_n_m: float
    """Greatest of the three magnitudes."""
    findings: tuple[SeatFinding, ...]

    @property
    def seated(self) -> bool:
        """True when nothing was found wrong."""
        return not self.findings


def judge_seat(
    wrench: Array,
    *,
    travel_m: float,
    expected_m: float,
    stiffness_n_m: float,
    limits: SeatLimits,
) -> SeatVerdict:
    """Judge the seat from the mean wrench while holding, shape (6,), in the deck frame.

    ``travel_m`` is the arm's travel from the stand-off, ``expected_m`` the travel at which contact
    was predicted. What arm and contact give way under the force (``stiffness_n_m``, in series) is
    travel without depth.
    """
    force_n = float(wrench[2])
    gap_m = expected_m - (travel_m - force_n / stiffness_n_m)
    lateral_n = float(np.hypot(wrench[0], wrench[1]))
    moments = np.abs(wrench[3:])
    tests = (
        (SeatFinding.FORCE_LOW, force_n < limits.force_low_n),
        (SeatFinding.FORCE_HIGH, force_n > limits.force_high_n),
        (SeatFinding.HIGH, gap_m > limits.depth_m),
        (SeatFinding.DEEP, gap_m < -limits.depth_m),
        (SeatFinding.LATERAL, lateral_n > limits.lateral_n),
        (SeatFinding.MOMENT, bool((moments > limits.moment_n_m).any())),
    )
    findings = tuple(finding for finding, found in tests if found)
    return SeatVerdict(force_n, gap_m, lateral_n, float(moments.max()), findings)
