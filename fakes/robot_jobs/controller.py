"""A robot controller that runs the job files of the SJL/2 delivery on the fake arm."""

import asyncio
import logging
from collections.abc import Callable
from pathlib import Path

from fakes.faults import JOB_FAULTS, FaultBoard
from fakes.robot_jobs.installation import SHIPPED, Adaptation, installed
from fakes.robot_jobs.lexer import JobError
from fakes.robot_jobs.memory import Memory
from fakes.robot_jobs.motion import Motions
from fakes.robot_jobs.sockets import JobSocket
from fakes.robot_jobs.task import Shared, Task
from fakes.scenario_file.sections import Channel
from fakes.wire.sjl.panel import Panel
from fakes.world.robot import RobotArm

_log = logging.getLogger(__name__)

MAIN = "SJLMAIN"
_TICK_S = 0.004
_JOB_PORTS: dict[int, Channel] = {5001: "CMD", 5002: "STA", 5003: "GRD"}
"""Ports in the shipped job files."""
_CAUSES = {1: "asked for by the PC", 2: "no heartbeat", 3: "link lost", 4: "panel"}
_PERMIT, _GUARD_PERMIT, _PERMIT_LOOP = 9, 10, 9
"""DO[9] and DO[10], the contacts of both background jobs, and DI[9], the end of the permit loop."""
_JOB_ALARM = 4100
"""Error number that this controller shows when a job has ended in an alarm; any but 0 would do."""


class JobController:
    """``start`` begins the main job, which starts the others; ``stop`` ends them all.

    Wiring as on the installation sheet: DO[9], DO[10] and the PC's own contact in series to DI[9].
    """

    def __init__(
        self,
        arm: RobotArm,
        clock: Callable[[], float],
        ports: dict[Channel, int],
        folder: Path = SHIPPED,
        *,
        host: str = "127.0.0.1",
        faults: FaultBoard | None = None,
        statement_s: float = 0.0005,
        adaptation: Adaptation | None = None,
        contact_closed: Callable[[], bool] = lambda: True,
    ) -> None:
        """``folder`` holds the job files; without ``adaptation`` they run as they are shipped.

        ``contact_closed`` tells of the PC's digital output in the permit loop.
        """
        self.faults = faults or FaultBoard("robot", JOB_FAULTS)
        self.contact_closed = contact_closed
        self.alarm = ""
        """What has ended a job; the main job starts again with ``acknowledge``."""
        self._arm, self._clock, self._ports, self._host = arm, clock, ports, host
        self._programs = installed(folder, adaptation)
        self._statement_s = statement_s
        self._jobs: dict[str, asyncio.Task[None]] = {}
        self.tasks: dict[str, Task] = {}
        self._power_on()

    def _power_on(self) -> None:
        self.memory = Memory(self._input)
        self._logged: dict[str, int] = {}
        self.motions = Motions(self._arm, self._clock, self._panel)
        self._shared = Shared(
            memory=self.memory,
            motions=self.motions,
            clock=self._clock,
            timer=self._timer_s,
            route=lambda _, port: (self._host, self._ports.get(_JOB_PORTS[port], 1)),
            socket=lambda: JobSocket(self.faults),
            start=self._start_background,
            frozen=lambda: self.faults.active("frozen_stat") is not None,
            statement_s=self._statement_s,
        )

    def start(self) -> None:
        """Switch on and start the main job."""
        self._jobs["supervision"] = asyncio.create_task(self._supervise())
        self._begin(MAIN, background=False)

    async def stop(self) -> None:
        """End all jobs and drop their connections. Idempotent."""
        jobs, self._jobs = self._jobs, {}
        for job in jobs.values():
            job.cancel()
        await asyncio.gather(*jobs.values(), return_exceptions=True)

    async def reboot(self) -> None:
        """Switch off and on: variables are kept by no job, joints stay."""
        self._arm.stop(self._clock(), latency_s=0.0)
        await self.stop()
        self._power_on()
        self.start()

    def acknowledge(self) -> None:
        """Somebody at the pendant resets the alarm and starts the main job again."""
        self.alarm = ""
        self._begin(MAIN, background=False)

    @property
    def open_channels(self) -> list[Channel]:
        """Channels on which a job has a PC."""
        channels: dict[str, Channel] = {"SJLMAIN": "CMD", "SJLSTA": "STA", "SJLGRD": "GRD"}
        return sorted(
            channels[name]
            for name, task in self.tasks.items()
            if name in channels and any(one.greeted for one in task.sockets.values())
        )

    def moving(self) -> bool:
        """The arm moves."""
        return self.motions.moving()

    def _timer_s(self) -> float:
        """The clock that TIMER reads."""
        jump = self.faults.active("clock_jump")
        return self._clock() + (jump.number("jump_ms", 1e6) / 1000 if jump else 0.0)

    def _panel(self) -> Panel:
        return Panel(self.faults, self._arm.by_hand)

    def _start_background(self, name: str) -> None:
        if name not in self._jobs or self._jobs[name].done():
            self._begin(name, background=True)

    def _begin(self, name: str, *, background: bool) -> None:
        task = self.tasks[name] = Task(self._programs[name], self._shared, background)
        self._jobs[name] = asyncio.create_task(self._run(task))

    async def _run(self, task: Task) -> None:
        try:
            await task.run()
        except JobError as error:
            _log.warning("%s", error)
            self.alarm = str(error)

    async def _supervise(self) -> None:
        while True:
            if self.faults.active("cut"):
                for task in self.tasks.values():
                    for connection in task.sockets.values():
                        connection.cut()
            self.motions.supervise()
            self._log_stops()
            await asyncio.sleep(_TICK_S)

    def _log_stops(self) -> None:
        """What the background jobs have counted as stops, and why, by the comments of the jobs."""
        for job, count, why in (("SJLSTA", 61, 65), ("SJLGRD", 62, 66)):
            stops = int(self.memory.numbers["I", count])
            if stops != self._logged.get(job, 0):
                cause = _CAUSES.get(int(self.memory.numbers["I", why]), "no cause")
                _log.warning("%s, stop %d of %s: %s", self.faults.device, stops, job, cause)
            self._logged[job] = stops

    def _input(self, family: str, index: int) -> int:
        panel = self._panel()
        signals = {
            ("DI", 1): panel.emergency_stop,
            ("DI", 2): panel.drives,
            ("DI", 3): panel.mode == "REM",
            ("DI", 4): panel.mode == "AUT",
            ("DI", 5): self.motions.moving(),
            ("DI", _PERMIT_LOOP): self._permit(),
            ("GIH", 1): _JOB_ALARM if self.alarm else panel.error_code,
            ("GIB", 2): 0 if self.faults.active("override_zero") else 100,
        }
        if (family, index) == ("GIB", 1):
            bits = (int(signals["DI", place]) << (place - 1) for place in range(1, 6))
            return sum(bits)
        if (family, index) not in signals:
            raise JobError(f"nothing is wired to {family}[{index}]")
        return int(signals[family, index])

    def _permit(self) -> bool:
        outputs = self.memory.outputs
        contacts = outputs["DO", _PERMIT], outputs["DO", _GUARD_PERMIT]
        return self.contact_closed() and all(contacts)
