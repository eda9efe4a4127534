"""The coroutine of the present state: one task, started on entry and cancelled on leaving."""

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from functools import partial

from cellctl.errors.internal import StateDidNotEnd
from cellctl.packml.state import State
from cellctl.packml.transition_tables import WHEN_DONE

Action = Callable[[], Awaitable[None]]
Task = asyncio.Task[None]

_PAUSE = frozenset({State.HOLDING, State.SUSPENDING})
"""States in which Execute is parked when it enters them at a safe point."""
_STOPPING = frozenset({State.STOPPING, State.COMPLETING, State.ABORTING})
"""States that begin with the stop of all motion, unless nothing was left in its midst."""
_PAUSED = _PAUSE | {State.HELD, State.UNHOLDING, State.SUSPENDED, State.UNSUSPENDING}
"""States in which Execute stays parked; from any other it can never go on."""


class Activities:
    """Runs the coroutine of the present state.

    Execute is parked, not cancelled, when it pauses at a safe point, and goes on after Unholding
    or Unsuspending. A cancelled coroutine gets ``leave_timeout_s`` to clean up; the next state
    waits for it, except those that stop the motion: they act at once and wait afterwards.
    """

    def __init__(
        self,
        actions: Mapping[State, Action],
        on_end: Callable[[Task, BaseException | None], None],
        leave_timeout_s: float,
    ) -> None:
        unknown = set(actions) - set(WHEN_DONE)
        # A coroutine of a state that waits for a command would end at once and has nowhere to lead.
        if unknown:
            raise ValueError(f"these states only wait: {sorted(state.name for state in unknown)}")
        self._actions = dict(actions)
        self._on_end = on_end
        self._leave_timeout_s = leave_timeout_s
        self._task: Task | None = None
        self._parked: Task | None = None
        self._leaving: list[Task] = []
        self._resumed = asyncio.Event()

    def is_current(self, task: Task) -> bool:
        """True while the state that started the task has not been left."""
        return task is self._task

    def follow(self, previous: State, state: State) -> None:
        """Leave one state and enter another."""
        task, self._task = self._task, None
        if task is not None and not task.done():
            if previous is State.EXECUTE and state in _PAUSE:
                # Execute waits in ``resumed`` at a safe point. It keeps its local variables, so
                # that it can go on where it was.
                self._parked = task
                self._resumed.clear()
            else:
                self._leave(task)
        if state is State.EXECUTE and self._parked is not None:
            self._task, self._parked = self._parked, None
            self._resumed.set()
            return
        if self._parked is not None and state not in _PAUSED:
            # Stop, Abort or Complete while it was held: it will never go on.
            self._leave(self._parked)
            self._parked = None
        if state in WHEN_DONE:
            self._start(state)

    async def resumed(self) -> None:
        """Wait, parked, until Execute goes on."""
        await self._resumed.wait()

    async def close(self) -> None:
        """Cancel everything and wait for it."""
        current = [task for task in (self._task, self._parked) if task is not None]
        self._task = self._parked = None
        for task in current:
            self._leave(task)
        # With a limit: a device that never answers must not keep the daemon from ending.
        if self._leaving:
            await asyncio.wait(self._leaving, timeout=self._leave_timeout_s)

    def _start(self, state: State) -> None:
        task = asyncio.create_task(self._run(state), name=state.name)
        task.add_done_callback(self._ended)
        self._task = task

    def _leave(self, task: Task) -> None:
        task.cancel(msg="state left")
        self._leaving.append(task)

    async def _run(self, state: State) -> None:
        settle = partial(self._settle, tuple(self._leaving))
        if state in _STOPPING:
            await self._act_at_once(state, settle)
        else:
            # What was left may still be stopping its robots, and two coroutines must not command
            # the same device.
            await settle()
            await self._act(state)

    async def _act(self, state: State) -> None:
        if state in self._actions:
            await self._actions[state]()

    async def _act_at_once(self, state: State, settle: Callable[[], Awaitable[None]]) -> None:
        """Stop, and wait only then for what was left.

        What was left may hang, or ask a robot that does not listen again and again, while the
        second stop channel lies idle. Stopping twice does no harm.
        """
        try:
            await self._act(state)
        except Exception as error:
            # The fault of the stop itself must not be lost to one of what was left.
            for left in await asyncio.gather(settle(), return_exceptions=True):
                if left is not None:
                    error.add_note(f"beside it: {left}")
            raise
        await settle()

    async def _settle(self, left: tuple[Task, ...]) -> None:
        """Wait until left coroutines have ended; raises what went wrong in their clean-up."""
        if not left:
            return
        _, pending = await asyncio.wait(left, timeout=self._leave_timeout_s)
        self._leaving = [task for task in self._leaving if task not in left or task in pending]
        if pending:
            names = ", ".join(sorted(task.get_name() for task in pending))
            raise StateDidNotEnd(
                f"{names} still runs {self._leave_timeout_s:g} s after it was left"
            )
        for task in left:
            error = None if task.cancelled() else task.exception()
            if error is not None:
                raise error

    def _ended(self, task: Task) -> None:
        error = asyncio.CancelledError() if task.cancelled() else task.exception()
        if self.is_current(task):
            self._on_end(task, error)
