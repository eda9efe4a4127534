"""The active alarms: each stays active, over restarts too, until somebody acknowledges it."""

from dataclasses import dataclass
from datetime import datetime

from cellctl import log
from cellctl.clock import utc_now
from cellctl.errors import CellError
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.store import RunStore
from cellctl.runtime.background import Background

_log = log.get(__name__)


@dataclass(frozen=True, slots=True)
class ActiveAlarm:
    """The first occurrence of a fault since its number was acknowledged last."""

    number: int
    text: str
    """Text of the fault, with the facts of this occurrence."""
    since: datetime
    """Time of this occurrence, UTC."""
    run: int | None


class Alarms:
    """The active alarms by number, the oldest first; the store has every single one."""

    def __init__(self, store: AsyncRunStore, background: Background) -> None:
        self._store = store
        self._background = background
        self._active: dict[int, ActiveAlarm] = {}
        self._came_meanwhile: dict[int, ActiveAlarm] = {}
        """The first of each number that came while an earlier one was being acknowledged."""

    @property
    def numbers(self) -> tuple[int, ...]:
        """Each fault number once."""
        return tuple(self._active)

    @property
    def active(self) -> tuple[ActiveAlarm, ...]:
        """One for each number, the oldest first."""
        return tuple(self._active.values())

    async def open(self) -> None:
        """Take over what was active before the restart."""
        for alarm in await self._store.do(RunStore.active_alarms):
            known = ActiveAlarm(alarm.number, alarm.text, alarm.time, alarm.run)
            # The oldest of each number counts, and the store gives the oldest first.
            self._active.setdefault(alarm.number, known)
        if self._active:
            _log.warning("alarms not yet acknowledged", numbers=self.numbers)

    def add(self, error: CellError, run: int | None) -> None:
        """A fault has come; written to the store in the background."""
        # The list changes at once and the store later: the line must see the alarm also when the
        # disk is what has failed.
        text = "; ".join([str(error), *getattr(error, "__notes__", ())])
        alarm = ActiveAlarm(error.number, text, utc_now(), run)
        self._active.setdefault(error.number, alarm)
        self._came_meanwhile.setdefault(error.number, alarm)
        self._background.start(self._store.do(RunStore.add_alarm, run, error.number, text))

    async def acknowledge(self, number: int, who: str) -> bool:
        """Acknowledge every alarm with this number; False when none is active."""
        if number not in self._active:
            return False
        self._came_meanwhile.pop(number, None)
        # The disk first, so that an acknowledged alarm does not come back with the next start.
        await self._store.do(RunStore.acknowledge_alarms, number, who)
        self._active.pop(number, None)
        # Nobody has acknowledged what came after the store was told: in the store it is active too.
        if number in self._came_meanwhile:
            self._active[number] = self._came_meanwhile.pop(number)
        return True
