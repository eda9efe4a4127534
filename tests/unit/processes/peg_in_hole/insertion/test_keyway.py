"""A keyed plug is turned until its keys drop, and is known to be held by them."""

import asyncio
from dataclasses import replace

import numpy as np
import pytest

from cellctl.cell.contact_motion.motions import Condition, ContactMotion, Ended
from cellctl.geometry.pose import Array
from cellctl.processes.peg_in_hole.faults import KeywayNotFound
from cellctl.processes.peg_in_hole.insertion.keyway import find_keyway
from cellctl.processes.peg_in_hole.plan.task import KeyGeometry, SearchTask
from cellctl.processes.peg_in_hole.verdict.holding import directions_that_resist_a_turn
from tests.rigs.insertion.kinematic import KinematicMotions
from tests.rigs.insertion.surface import Truth
from tests.unit.processes.peg_in_hole.tasks import plug

KEYS = KeyGeometry(depth_m=3e-3, window_rad=np.radians(1.0), uncertainty_rad=np.radians(1.8))
ROUND = plug()
TASK = replace(ROUND, fit=replace(ROUND.fit, keys=KEYS))
OVER_THE_HOLE = np.zeros(2)


class KeyedMotions(KinematicMotions):
    """A peg in the hole, whose keys meet their keyways at one angle, or at none."""

    def __init__(self, task: SearchTask, keyway_rad: float | None) -> None:
        super().__init__(task, Truth(OVER_THE_HOLE, np.zeros(2)), np.random.default_rng(0))
        self.keyway_rad = keyway_rad
        self.deepest_m = KEYS.depth_m
        self.moment_n_m = 0.0

    def _free(self) -> bool:
        if self.keyway_rad is None:
            return False
        return abs(float(self.rotation_rad[2]) - self.keyway_rad) < KEYS.window_rad

    async def turn(
        self,
        task_rotation_tip_rad: Array,
        hold_force_n: Array,
        speed_rad_s: float,
        until: Condition | None = None,
    ) -> ContactMotion:
        for at_rad in np.linspace(self.rotation_rad[2], task_rotation_tip_rad[2], 50):
            self.rotation_rad = np.array([0.0, 0.0, at_rad])
            in_keyway = self.position_m[2] > KEYS.depth_m + 1e-3
            self.moment_n_m = 1.0 if in_keyway and not self._free() else 0.0
            if not in_keyway and self._free():
                self.position_m[2] = KEYS.depth_m + 0.3e-3
                self.moment_n_m = 0.9
            sample = replace(self._sample(5.0), moment_n_m=np.array([0.0, 0.0, self.moment_n_m]))
            if until is not None and until(sample):
                return ContactMotion(Ended.CONDITION, (sample,))
        return ContactMotion(Ended.TRAVEL, (sample,))

    async def comply(
        self,
        press_n: float,
        hold_s: float,
        until: Condition | None = None,
        *,
        turns: bool = True,
    ) -> ContactMotion:
        """Nothing carries keys that have dropped; without a press the plug turns free."""
        if press_n == 0.0 and turns:
            self.moment_n_m = 0.0
        moment_n_m = np.array([0.0, 0.0, self.moment_n_m])
        sample = replace(self._sample(0.0), moment_n_m=moment_n_m)
        ended = Ended.CONDITION if until is not None and until(sample) else Ended.TIME
        return ContactMotion(ended, (sample,))

    async def press(
        self, force_n: float, hold_s: float, until: Condition | None = None
    ) -> ContactMotion:
        del hold_s, until
        return ContactMotion(Ended.TIME, (self._sample(force_n),))

    async def feed(
        self,
        depth_m: float,
        force_limit_n: float,
        until: Condition | None = None,
        past_m: float = 0.0,
    ) -> ContactMotion:
        del until, past_m
        if self._free():
            self.position_m[2] = depth_m
            return ContactMotion(Ended.TRAVEL, (self._sample(0.0),))
        yields_m = force_limit_n / self.task.cell.stiffness_n_m
        self.position_m[2] = KEYS.depth_m + yields_m
        return ContactMotion(Ended.FORCE, (self._sample(force_limit_n),))


@pytest.mark.parametrize("keyway_deg", [0.5, 2.0, -2.5])
def test_the_keys_drop_and_then_hold(keyway_deg: float) -> None:
    motions = KeyedMotions(TASK, float(np.radians(keyway_deg)))
    asyncio.run(find_keyway(motions, TASK, KEYS))
    assert motions.position_m[2] == pytest.approx(1.5 * KEYS.depth_m)
    assert motions.moment_n_m == 0.0  # its flank of the keyway is not pressed on all the way
    assert asyncio.run(directions_that_resist_a_turn(motions, KEYS)) == 2


def test_another_keying_is_a_fault() -> None:
    with pytest.raises(KeywayNotFound, match=r"2\.7 degrees to both sides at a depth of 3\.\d"):
        asyncio.run(find_keyway(KeyedMotions(TASK, None), TASK, KEYS))


def test_a_part_without_keys_turns() -> None:
    motions = KeyedMotions(TASK, 0.0)
    motions.position_m[2] = KEYS.depth_m
    motions.keyway_rad = None
    assert asyncio.run(directions_that_resist_a_turn(motions, KEYS)) == 0
