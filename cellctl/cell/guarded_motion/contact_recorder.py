"""Records wrench and travel while a robot works in contact."""

import asyncio
from collections.abc import Callable
from types import TracebackType
from typing import Self

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.cell.guarded_motion.guard_port import GuardPort
from cellctl.errors.base import CellError
from cellctl.force.contact.curve import ForceCurve
from cellctl.geometry.pose import Array
from cellctl.interfaces import Robot

PERIOD_S = 0.02
"""The robot reports every 20 ms; the guard's memory reaches back much further than this."""


class ContactRecorder:
    """Collects samples and poses in the background, as an async context."""

    def __init__(
        self, robot: Robot, guard: GuardPort, travel_of: Callable[[RigidTransform], float]
    ) -> None:
        """``travel_of``: travel in m along the approach of a ``base_T_flange``."""
        self._robot, self._guard, self._travel_of = robot, guard, travel_of
        self._times: list[float] = []
        self._travels: list[float] = []
        self._chunks: list[tuple[Array, Array]] = []
        self._task: asyncio.Task[None] | None = None
        self._since_s = 0.0

    async def __aenter__(self) -> Self:
        # The clock of the loop is the one that stamps samples, also in a loop of simulated time.
        self._since_s = asyncio.get_running_loop().time()
        self._take_travel()
        self._task = asyncio.create_task(self._run(), name="contact-recorder")
        return self

    async def __aexit__(
        self,
        exc_type: type[BaseException] | None,
        exc: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)

    def travel_at(self, time_s: float) -> float:
        """Travel (m) at a moment, between the reports around it."""
        if not self._times:
            return float("nan")
        return float(np.interp(time_s, self._times, self._travels))

    def curve(self) -> ForceCurve:
        """Everything that was recorded so far."""
        self._take_travel()
        self._take_samples()
        if not self._chunks:
            return ForceCurve(np.zeros(0), np.zeros((0, 6)), np.zeros(0))
        time_s = np.concatenate([chunk[0] for chunk in self._chunks])
        wrench = np.concatenate([chunk[1] for chunk in self._chunks])
        travel = np.full(len(time_s), np.nan)
        if self._times:
            travel = np.interp(time_s, self._times, self._travels)
        return ForceCurve(time_s, wrench, travel)

    async def _run(self) -> None:
        while True:
            self._take_travel()
            self._take_samples()
            await asyncio.sleep(PERIOD_S)

    def _take_travel(self) -> None:
        try:
            state = self._robot.state()
        except CellError:
            return  # The motion that runs meets the same fault and raises it.
        # ``interp`` needs rising times, and a report that was read twice says nothing new.
        if not self._times or state.time_s > self._times[-1]:
            self._times.append(state.time_s)
            self._travels.append(self._travel_of(state.base_T_flange))

    def _take_samples(self) -> None:
        try:
            curve = self._guard.samples(self._since_s)
        except CellError:
            return  # Likewise: a dead guard is raised by the phase that needs it.
        if len(curve.time_s):
            self._chunks.append((np.array(curve.time_s), np.array(curve.wrench)))
            self._since_s = float(curve.time_s[-1])
