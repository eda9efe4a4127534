"""A force sensor on the flange of an arm, with the loads of the last second."""

import numpy as np

from fakes.world.flaws.sensor import SensorFlaws
from fakes.world.frames import Array
from fakes.world.load.payload import STEP_S
from fakes.world.load.sensor import ForceReading
from fakes.world.robot import RobotArm

__all__ = ["STEP_S", "MountedSensor"]

_HISTORY = 1024
"""Milliseconds: a reading may be asked for that much later."""


class MountedSensor:
    """Follows its flange in steps of one millisecond."""

    def __init__(
        self, name: str, arm: RobotArm, reading: ForceReading, flaws: SensorFlaws | None = None
    ) -> None:
        """``flaws`` is None for a sensor that follows its load at once and in proportion."""
        self.name = name
        self._flaws = flaws
        self._arm = arm
        self._reading = reading
        self._history = np.zeros((_HISTORY, 6))
        self.flange = arm.flange_matrix(0.0)
        """True cell_T_flange, 4x4; the same array for as long as the arm stands."""

    def follow(self, time_s: float) -> bool:
        """Take over the flange's pose at the end of a step; True when the arm moved in it."""
        moving = self._arm.moving(time_s - STEP_S)
        if moving:
            self.flange = self._arm.flange_matrix(time_s)
        return moving

    def keep(self, tick: int, load: Array) -> None:
        """Store the true load at the end of a step."""
        shown = load if self._flaws is None else self._flaws.pass_on(load)
        self._history[tick % _HISTORY] = shown

    def read(self, time_s: float, newest_tick: int) -> Array:
        """Raw reading at a time, at the latest that of the newest step."""
        tick = min(max(int(time_s / STEP_S), newest_tick - _HISTORY + 1), newest_tick)
        return self._reading.read(self._history[tick % _HISTORY], time_s)
