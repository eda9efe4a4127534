"""Is the deck seated? Force alone does not say: depth and side load must agree."""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from cellctl.geometry.pose import Array


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

    force_low_n: float = 35.0
    force_high_n: float = 45.0
    depth_m: float = 1e-4
    """Greatest distance between reached and expected depth, elastic travel taken off."""
    lateral_n: float = 20.0
    moment_n_m: tuple[float, float, float] = (14.0, 24.0, 8.0)
    """About x, y and z of the deck. A deck that is tilted within its tolerance may rest on an edge:
    the force times half the width or length must be allowed, and no more."""


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

    @property
    def false_seat(self) -> bool:
        """True when force is there but the deck stands above its seat: measure again."""
        return SeatFinding.HIGH in self.findings


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
