"""Records what robots are told and report, what force sensors feel and what the unit does."""

import asyncio
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import BinaryIO, Self

from cellctl.cell.guarded_motion.guard_port import GuardPort
from cellctl.cell.robot_layers.noted_robot import RobotNote, RobotNotes
from cellctl.cell.run_notes import RunNote, RunNotes
from cellctl.clock import now_s, utc_now
from cellctl.errors import CellError
from cellctl.errors.records.store import RecordNotWritten
from cellctl.geometry.pose import Array
from cellctl.interfaces import Robot, RobotState
from cellctl.records.files.motion_file import MotionWriter

POLL_S = 0.02
"""As often as controllers report: more looks would find the same report again."""
WRITE_S = 0.5
"""How often what was collected is encoded, in a thread: seconds of samples at once would keep the
interpreter, and with it the heartbeats, from their turn."""


@dataclass(slots=True, eq=False)
class _Collected:
    """What came in since the last writing."""

    notes: list[RobotNote] = field(default_factory=list)
    run_notes: list[RunNote] = field(default_factory=list)
    states: list[tuple[str, RobotState]] = field(default_factory=list)
    samples: list[tuple[str, Array, Array]] = field(default_factory=list)


class MotionRecorder:
    """Listens from ``start`` to ``finish``. Disturbs nobody: what cannot be read is left out."""

    def __init__(
        self,
        robots: Mapping[str, Robot],
        guards: Mapping[str, GuardPort],
        notes: RobotNotes,
        run_notes: RunNotes,
        file: BinaryIO,
    ) -> None:
        """``notes`` are those of the robots, ``run_notes`` those of the unit and the line.

        The recording goes to ``file`` as it comes in, so that a daemon that dies in contact leaves
        the force curve.
        """
        self._file = file
        self._robots, self._guards, self._notes = robots, guards, notes
        self._run_notes = run_notes
        self._collected = _Collected()
        self._reported_s: dict[str, float] = {}
        self._felt_s: dict[str, float] = {}
        self.start_s = now_s()
        """Monotonic time from which the recording counts."""
        self._writer = MotionWriter(file, utc_now(), self.start_s)
        self._task: asyncio.Task[None] | None = None
        self._writing: asyncio.Task[None] | None = None
        self._fault: OSError | None = None
        """What the file has refused: nothing is written after it."""

    def start(self) -> Self:
        """Begin to listen."""
        begin_s = now_s()
        self._felt_s = dict.fromkeys(self._guards, begin_s)
        self._notes.listeners.append(self._noted)
        # What holds at the beginning, such as state and registers, is dated now. It may have begun
        # hours ago, and a viewer would show a recording that is hours long.
        held = [replace(one, time_s=begin_s) for one in self._run_notes.newest]
        self._collected.run_notes += held
        self._run_notes.listeners.append(self._told)
        self._task = asyncio.create_task(self._run(), name="motion recorder")
        return self

    async def finish(self) -> None:
        """End the recording, see ``cellctl.records.files.motion_file``, and close its file.

        Raises ``RecordNotWritten`` when the file did not take all of it.
        """
        self._notes.listeners.remove(self._noted)
        self._run_notes.listeners.remove(self._told)
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
        if self._writing is not None:
            await self._writing
        # Once more: what came since the last writing is the end of the motion.
        self._collect_states()
        self._collect_samples()
        await asyncio.to_thread(self._write, self._collected)
        await asyncio.to_thread(self._end)
        if self._fault is not None:
            raise RecordNotWritten(f"motion: {self._fault.strerror}") from self._fault

    def _noted(self, note: RobotNote) -> None:
        self._collected.notes.append(note)

    def _told(self, note: RunNote) -> None:
        self._collected.run_notes.append(note)

    async def _run(self) -> None:
        next_write_s = now_s() + WRITE_S
        while True:
            self._collect_states()
            # The writer takes one thread at a time.
            if now_s() >= next_write_s and (self._writing is None or self._writing.done()):
                next_write_s += WRITE_S
                self._collect_samples()
                collected, self._collected = self._collected, _Collected()
                self._writing = asyncio.create_task(asyncio.to_thread(self._write, collected))
            await asyncio.sleep(POLL_S)

    def _collect_states(self) -> None:
        for name, robot in self._robots.items():
            try:
                state = robot.state()
            except CellError:
                continue  # a silent robot shows as a gap, and its fault is raised elsewhere
            if state.time_s > self._reported_s.get(name, 0.0):
                self._reported_s[name] = state.time_s
                self._collected.states.append((name, state))

    def _collect_samples(self) -> None:
        for name, guard in self._guards.items():
            try:
                samples = guard.samples(self._felt_s[name])
            except CellError:
                continue  # likewise
            if len(samples.time_s):
                self._felt_s[name] = float(samples.time_s[-1])
                self._collected.samples.append((name, samples.time_s, samples.raw))

    def _write(self, collected: _Collected) -> None:
        if self._fault is not None:
            return
        try:
            for note in collected.notes:
                self._writer.command(note.robot, note.time_s, {"what": note.what, **note.values})
            for told in collected.run_notes:
                self._writer.note(told.topic, told.time_s, told.values)
            for name, state in collected.states:
                self._writer.report(name, state)
            for name, times_s, raw in collected.samples:
                self._writer.force(name, times_s, raw)
            self._writer.flush()
        except OSError as error:
            self._fault = error

    def _end(self) -> None:
        try:
            with self._file:
                if self._fault is None:
                    self._writer.finish()
        except OSError as error:
            self._fault = self._fault or error
