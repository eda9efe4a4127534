"""A peg in the fingers of a compliant arm: follows the commanded tip, slips when pushed hard."""

import math
from dataclasses import replace
from typing import Final

from fakes.world.frames import Array
from fakes.world.peg.attitude import Pose6, axis_of
from fakes.world.peg.equilibrium import free_at, settle
from fakes.world.peg.fit import Fit
from fakes.world.peg.slots import Slots

_STEP_M: Final = 20e-6
_STEP_RAD: Final = 2e-3
_NEAR_M: Final = 0.2e-3
"""A longer motion than this in one call is not cut into steps as long as nothing is touched."""

_STILL: Final = 1e-9
"""Change of pose (m, rad) in a call below which the peg stands."""


class HeldPeg:
    """State of the contact from one call to the next; the same calls give the same forces."""

    def __init__(
        self, fit: Fit, robot_n_m: Array, commanded: Pose6, *, grip_n: float = math.inf
    ) -> None:
        """``robot_n_m``: 6x6 stiffness between the commanded pose and the tip, in the axes of the
        hole. ``grip_n``: axial force (N) at which the peg slips in the fingers."""
        self._slots = Slots(fit)
        self.robot_n_m = robot_n_m
        self._grip_n = grip_n
        self.commanded = commanded
        self._now = free_at(commanded)
        self._rests = False
        self.slip_m = 0.0
        """How far the peg was pushed into the fingers."""
        self.failures = 0
        """Steps in which the peg crept because no equilibrium was found."""
        self.steps = 0
        """All steps in contact."""

    @property
    def pose(self) -> Pose6:
        """Pose of the peg."""
        return self._now.pose

    @property
    def wrench(self) -> Array:
        """Wrench on the peg about its tip, in the axes of the hole (N, N·m), shape (6,)."""
        return self._now.wrench

    @property
    def unsolved_share(self) -> float:
        """Share of the steps in contact for which no equilibrium was found: their forces are not to
        be relied on."""
        return self.failures / max(self.steps, 1)

    @property
    def touching(self) -> tuple[int, ...]:
        """Slots that are in contact."""
        return self._now.slots

    @property
    def fit(self) -> Fit:
        """Shape of peg and hole."""
        return self._slots.fit

    def change(self, fit: Fit) -> None:
        """Another hole or another peg from now on."""
        self._slots = Slots(fit)
        self._now = replace(self._now, bristles={})
        self._rests = False

    def hold_with(self, grip_n: float) -> None:
        """Let the peg slip in the fingers at another axial force (N) from now on."""
        self._grip_n = grip_n
        self._rests = False

    def follow(self, commanded: Pose6, dt_s: float) -> None:
        """Let a time pass in which the commanded tip goes to another pose."""
        last, before = self.commanded, self.pose
        if self._rests and commanded == last:
            return
        steps = _count(last, commanded)
        if not self.touching and self._slots.free(self._slipped(commanded)):
            steps = 1 if steps * _STEP_M > _NEAR_M else steps
        for number in range(1, steps + 1):
            ratio = number / steps
            between = tuple(a + ratio * (b - a) for a, b in zip(last, commanded, strict=True))
            self._step(
                (between[0], between[1], between[2], between[3], between[4], between[5]),
                dt_s / steps,
            )
        self.commanded = commanded
        away = max(abs(a - b) for a, b in zip(self.pose, before, strict=True))
        self._rests = commanded == last and away < _STILL and self._now.found

    def _step(self, commanded: Pose6, dt_s: float) -> None:
        wanted = self._slipped(commanded)
        if not self.touching and self._slots.free(wanted):
            self._now = free_at(wanted)
            return
        self._now = settle(self._slots, self.robot_n_m, wanted, self._now, dt_s)
        self.steps += 1
        self.failures += not self._now.found
        self._slip()

    def _slip(self) -> None:
        ax, ay, az = axis_of(self.pose[3], self.pose[4])
        axial_n = self.wrench[0] * ax + self.wrench[1] * ay + self.wrench[2] * az
        beyond_n = abs(axial_n) - self._grip_n
        if beyond_n > 0:
            self.slip_m += math.copysign(beyond_n / self.robot_n_m[2, 2], axial_n)

    def _slipped(self, commanded: Pose6) -> Pose6:
        if self.slip_m == 0.0:
            return commanded
        ax, ay, az = axis_of(commanded[3], commanded[4])
        x, y, z, *turn = commanded
        slip = self.slip_m
        return x + slip * ax, y + slip * ay, z + slip * az, turn[0], turn[1], turn[2]


def _count(last: Pose6, commanded: Pose6) -> int:
    way_m = max(abs(b - a) for a, b in zip(last[:3], commanded[:3], strict=True))
    turn_rad = max(abs(b - a) for a, b in zip(last[3:], commanded[3:], strict=True))
    return max(1, math.ceil(way_m / _STEP_M), math.ceil(turn_rad / _STEP_RAD))
