"""The tasks of a controller: one motion or setpoint each, with a number and a state."""

from dataclasses import dataclass
from enum import IntEnum

FIRST_TASK = 100
_KEPT = 256
"""How many tasks are remembered; a stream makes up to a hundred of them in a second."""


class TaskEnd(IntEnum):
    """States of a task that a caller may ask for."""

    IDLE = 0
    RUNNING = 1
    PAUSED = 2
    STOPPED = 3
    FINISHED = 4
    INTERRUPT = 5
    ERROR = 6
    ILLEGAL = 7
    PARAMETERS = 8


@dataclass(slots=True)
class Task:
    """One motion or setpoint."""

    number: int
    state: int


class Tasks:
    """Numbers tasks upwards; the newest one may be running."""

    def __init__(self) -> None:
        self._tasks: dict[int, Task] = {}
        self._next = FIRST_TASK
        self._current: Task | None = None

    def begin(self, state: int = TaskEnd.RUNNING) -> Task:
        """A new task. One that was running is interrupted by one that runs."""
        task = Task(self._next, state)
        self._next += 1
        self._tasks[task.number] = task
        self._tasks.pop(task.number - _KEPT, None)
        if state == TaskEnd.RUNNING:
            self.end(TaskEnd.INTERRUPT)
            self._current = task
        return task

    def end(self, state: int) -> None:
        """The running task ends, if there is one."""
        if self._current is not None:
            self._current.state, self._current = state, None

    @property
    def running(self) -> bool:
        """A task runs."""
        return self._current is not None

    def state(self, number: int) -> int:
        """The state of a task; one that never was, or is forgotten, is idle."""
        task = self._tasks.get(number)
        return TaskEnd.IDLE if task is None else task.state
