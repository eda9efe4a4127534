"""A feed that goes on where the seat should have stopped it.

Then the hole is deeper than drawn, the part slips in its fingers, or the sensor is dead. Arm and
contact yield under a force, so the tip of a good part goes on beyond its seat, too. But only a
force that rises with the travel is that of a seat. A force that stays the same is friction, or the
last reading of a dead sensor: taken for a seat, it would let the arm press on, and nobody would
know with how much.
"""

from collections import deque
from dataclasses import replace
from typing import NamedTuple

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.processes.peg_in_hole.insertion.felt import (
    LEAST_SLOPE,
    OUT_OF_BAND_N,
    Standing,
    unloaded_depth_m,
)
from cellctl.processes.peg_in_hole.insertion.jam import rubbing_n
from cellctl.processes.peg_in_hole.plan.task import SearchTask

SEAT_TOLERANCE_M = 0.3e-3
"""A part counts as seated within this distance of the depth by the drawing (section 5.4 of the
study of insertion by touch)."""
_IN_A_ROW = 3
"""Samples: fewer are the noise of a force."""
_STAYS_M = 0.1e-3
"""Way on which a force must rise at the seat: the arm goes on by it where a sensor has died."""
_LEAST_SIGMAS = 8.0
"""The rise on that way is to be far above the noise."""


class _Felt(NamedTuple):
    """What was felt at one place of the way."""

    standing: Standing
    unexplained_n: float
    """Force against the feed that neither walls nor contacts of the part make."""


class PastSeat:
    """Takes the samples of one feed to a seat that frame A puts ``face_yields_m`` too deep."""

    def __init__(self, task: SearchTask, face_yields_m: float) -> None:
        self._fit, self._cell, self._face_yields_m = task.fit, task.cell, face_yields_m
        contacts = task.fit.contacts
        self._contacts_n = 0.0 if contacts is None else contacts.most_n
        self._least_n_m = LEAST_SLOPE * task.cell.stiffness_n_m
        self._stays_m = max(_STAYS_M, _LEAST_SIGMAS * task.cell.force_sigma_n / self._least_n_m)
        self._way: deque[_Felt] = deque()
        self._past: deque[bool] = deque(maxlen=_IN_A_ROW)
        self.held = False
        """Whether something holds the tip back at its seat with a force that does not rise."""

    def take(self, sample: ContactSample) -> bool:
        """Take the next one; whether the tip is past its seat, or its force does not rise there."""
        standing = Standing.of(sample)
        walls_n = rubbing_n(sample, self._fit, self._cell.friction)
        self._way.append(_Felt(standing, standing.axial_n - walls_n - self._contacts_n))
        while len(self._way) > 1 and self._since_m(self._way[1]) >= self._stays_m:
            self._way.popleft()
        stays = self._stays()
        self.held = stays and self._held_at_seat()
        # By a force that stays, arm and contact yield only where contacts of the part make it.
        yielded_by_n = min(standing.axial_n, self._contacts_n) if stays else standing.axial_n
        past = self._beyond_m(replace(standing, axial_n=yielded_by_n)) > SEAT_TOLERANCE_M
        self._past.append(past or self.held)
        return sum(self._past) == _IN_A_ROW

    def _held_at_seat(self) -> bool:
        begin, now = self._way[0], self._way[-1]
        at_seat = self._beyond_m(now.standing) > -SEAT_TOLERANCE_M
        return at_seat and min(begin.unexplained_n, now.unexplained_n) > OUT_OF_BAND_N

    def _stays(self) -> bool:
        """Whether the force rises neither on the whole way nor on its second half."""
        if self._since_m(self._way[0]) < self._stays_m:
            return False
        half_m = 0.5 * self._stays_m
        halfway = next(one for one in self._way if self._since_m(one) <= half_m)
        return self._rises_less(self._way[0], self._stays_m) and self._rises_less(halfway, half_m)

    def _rises_less(self, begin: _Felt, way_m: float) -> bool:
        risen_n = self._way[-1].standing.axial_n - begin.standing.axial_n
        return risen_n < self._least_n_m * way_m

    def _since_m(self, begin: _Felt) -> float:
        return self._way[-1].standing.depth_m - begin.standing.depth_m

    def _beyond_m(self, standing: Standing) -> float:
        """How far the tip is past its seat, less what its force makes it yield."""
        unloaded_m = unloaded_depth_m(standing, self._cell.stiffness_n_m, self._face_yields_m)
        return unloaded_m - self._fit.depth_m
