"""Judges whether a part is seated, by force, depth and side load together.

The force alone does not tell: a part that stands on the tip of a pin presses as hard as one that
lies on its face. The difference is that it stands some millimetres too high, or is pushed sideways.
"""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from cellctl.geometry.pose import Array

EDGE_MARGIN_N_M = 2.75, 1.5
"""Allowance for tare, friction and the lever of the side force in the moments about x and y. With
the paper's deck they make the bounds of docs/mating.md, 14 and 24 N·m."""
SEAT_DEPTH_M = 1e-4
"""A part that stands higher than this above its seat, or lies deeper, is not seated. A pin that is
caught on its chamfer holds a part millimetres too high, so the bound need not be sharp; it is what
the position of the contact is known to (``ContactWindow``)."""
REST_RATIO = 0.8
"""A seated part may keep this share of the side load that is allowed on the way: at rest nothing
pushes it, and what is left may be a pin that jams."""


class SeatFinding(Enum):
    """One way in which a seat can be wrong."""

    FORCE_LOW = "force below its window"
    FORCE_HIGH = "force above its window"
    HIGH = "part stands above its seat"
    DEEP = "part lies below its seat"
    LATERAL = "lateral force beyond its bound"
    MOMENT = "moment beyond its bound"


@dataclass(frozen=True, slots=True)
class SeatLimits:
    """Bounds of a good seat."""

    force_low_n: float
    force_high_n: float
    lateral_n: float
    moment_n_m: tuple[float, float, float]
    """About x, y and z of the part."""
    depth_m: float = SEAT_DEPTH_M
    """Greatest distance between reached and expected depth, without elastic travel."""


def seat_limits(
    *,
    target_force_n: float,
    abort_force_n: float,
    max_lateral_n: float,
    half_size_m: tuple[float, float],
) -> SeatLimits:
    """Bounds of a seat, from the force at which it is complete and the force at which to abort.

    A part that is tilted within its tolerance may rest on an edge. So the moments may reach the
    force times half the length or width of the face (``half_size_m``: along x, along y), and
    little more. The side force, and the moment about z that it makes at an end of the face, are
    bounded tighter than on the way: a part at rest is not being pushed.
    """
    half_x_m, half_y_m = half_size_m
    margin_x_n_m, margin_y_n_m = EDGE_MARGIN_N_M
    lateral_n = REST_RATIO * max_lateral_n
    # The moment about z has the ratio once more, on top of that of the side force: 8 N·m for the
    # paper's deck (docs/mating.md).
    return SeatLimits(
        force_low_n=target_force_n,
        # Below the guard's limit: the noise of a force that the seat allows must not trip it.
        force_high_n=abort_force_n,
        lateral_n=lateral_n,
        moment_n_m=(
            # The moment about x has its lever along y, and the other way round.
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
    """Expected minus reached depth; positive when the part stands above its seat."""
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
    """Judge the seat from the mean wrench while holding, shape (6,), in the frame of the part.

    ``travel_m`` is the arm's travel from the stand-off, ``expected_m`` the travel at which contact
    was predicted. Under the force, arm and contact give way by force over ``stiffness_n_m`` (both
    in series); that part of the travel is not depth and is subtracted.
    """
    force_n = float(wrench[2])
    # Without the elastic part a seated part would seem to lie deeper the harder it is pressed.
    gap_m = expected_m - (travel_m - force_n / stiffness_n_m)
    lateral_n = float(np.hypot(wrench[0], wrench[1]))
    moments = np.abs(wrench[3:])
    # Each says what a good seat is, so that what is not a number is never seated.
    good = {
        SeatFinding.FORCE_LOW: force_n >= limits.force_low_n,
        SeatFinding.FORCE_HIGH: force_n <= limits.force_high_n,
        SeatFinding.HIGH: gap_m <= limits.depth_m,
        SeatFinding.DEEP: gap_m >= -limits.depth_m,
        SeatFinding.LATERAL: lateral_n <= limits.lateral_n,
        SeatFinding.MOMENT: bool((moments <= limits.moment_n_m).all()),
    }
    findings = tuple(finding for finding, holds in good.items() if not holds)
    return SeatVerdict(force_n, gap_m, lateral_n, float(moments.max()), findings)
