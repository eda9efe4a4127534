"""Forces of an insertion over depth, and what they say where a peg stands.

All forces are those that the hole exerts on the peg; the axial force is counted against the feed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot

import numpy as np

from cellctl.cell.contact_motion.motions import ContactSample

OUT_OF_BAND_N, OUT_OF_BAND_N_M = 3.0, 0.1
"""Band of side force and moment round that of a free peg, before a recipe has measured its own."""
LEAST_SLOPE = 0.3
"""Rise of the force at the seat over the stiffness of arm and contact."""
_STAYS = 0.7
"""Share of side force and moment that stays when the feed is lowered, for a peg that is wedged.
In a peg that is only jammed they fall together with the feed (section 5.2 of the study)."""
_FOOT = 0.2
"""The rise at the seat begins where the force leaves this share of it behind."""
_LINE_SAMPLES = 20
"""Fewest samples on the way to which a line of the friction is fitted."""
_SEAT_ZONE_M, _WAY_M = 0.5e-3, 3e-3
"""How far before its end a feed is slowed by the seat, and how far back from its end the way counts
for friction."""


@dataclass(frozen=True, slots=True)
class Standing:
    """A peg that stands, by the last sample of its feed."""

    depth_m: float
    axial_n: float
    side_n: float
    moment_n_m: float
    yaw_rad: float = 0.0
    """About the axis of the hole: that of a plug whose keys are in their keyways."""

    @classmethod
    def of(cls, sample: ContactSample) -> "Standing":
        """The figures of one sample; the moment about z does not count, keys make one."""
        x_n, y_n, z_n = (float(value) for value in sample.force_n)
        x_n_m, y_n_m, _ = (float(value) for value in sample.moment_n_m)
        depth_m = float(sample.task_position_tip_m[2])
        yaw_rad = float(sample.task_rotation_tip_rad[2])
        return cls(depth_m, -z_n, hypot(x_n, y_n), hypot(x_n_m, y_n_m), yaw_rad)

    @property
    def sideways(self) -> bool:
        """Side force or moment out of their band: a jam or a wedge, not a closed hole."""
        return self.side_n > OUT_OF_BAND_N or self.moment_n_m > OUT_OF_BAND_N_M

    def wedged_after(self, before: "Standing") -> bool:
        """The feed was lowered since, and side force and moment have stayed: the peg is wedged."""
        if not before.sideways:
            return False
        stays_n = self.side_n > _STAYS * before.side_n
        return self.sideways and stays_n and self.moment_n_m > _STAYS * before.moment_n_m

    def __str__(self) -> str:
        return (
            f"depth {self.depth_m * 1e3:.2f} mm, axial {self.axial_n:.1f} N, side "
            f"{self.side_n:.1f} N, moment {self.moment_n_m:.2f} N·m"
        )


def seat_slope_n_m(samples: Sequence[ContactSample]) -> float | None:
    """Rise of the axial force over depth at the end of a feed, N/m; None where it cannot be told.

    From the sample at which the force last was below a fifth of its rise over what friction made
    on the way, to its greatest value: after that the arm gives way.
    """
    # A tick that found no new force repeats the last one, at a depth that it does not belong to.
    fresh = [
        sample
        for before, sample in zip([None, *samples], samples, strict=False)
        if before is None or not np.array_equal(before.force_n, sample.force_n)
    ]
    axial_n = np.array([-sample.force_n[2] for sample in fresh])
    peak = int(np.argmax(axial_n)) + 1
    axial_n = axial_n[:peak]
    depth_m = np.array([sample.task_position_tip_m[2] for sample in fresh[:peak]])
    back_m = depth_m[-1] - depth_m
    sliding = (back_m > _SEAT_ZONE_M) & (back_m < _WAY_M)
    friction_n = float(np.median(axial_n[sliding])) if sliding.any() else 0.0
    if sliding.sum() >= _LINE_SAMPLES:
        # Contacts of a connector make a force that grows on the way; at the seat it is what their
        # line leads to.
        friction_n = max(
            friction_n, float(np.polyval(np.polyfit(back_m[sliding], axial_n[sliding], 1), 0.0))
        )
    below = np.flatnonzero(axial_n < friction_n + _FOOT * (axial_n[-1] - friction_n))
    begin = int(below[-1]) if below.size else 0
    if len(axial_n) - begin < 2 or np.ptp(depth_m[begin:]) == 0:
        return None
    return float(np.polyfit(depth_m[begin:], axial_n[begin:], 1)[0])


def unloaded_depth_m(standing: Standing, stiffness_n_m: float, face_yields_m: float) -> float:
    """Depth of the tip as it would be without a force, m below the face.

    Under the force arm and contact have yielded, so that the arm reports too great a depth. Frame A
    lies deeper than the face by ``face_yields_m``, which the touches of the face had yielded.
    """
    return standing.depth_m - standing.axial_n / stiffness_n_m + face_yields_m


def greatest_axial_n(samples: Sequence[ContactSample]) -> float:
    """The greatest force along the axis, of either sign."""
    return max(abs(float(sample.force_n[2])) for sample in samples)
