"""The active alarms: each stays active, over restarts too, until somebody acknowledges it."""

import asyncio
from collections import deque
from dataclasses import dataclass, field, replace
from datetime import datetime

from cellctl import log
from cellctl.clock import utc_now
from cellctl.errors import CellError
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.store import RunStore
from cellctl.runtime.background import Background

_log = log.get(__name__)


KEPT = 100
"""Occurrences of a number that are remembered with their facts, behind the first."""


@dataclass(frozen=True, slots=True)
class ActiveAlarm:
    """The first occurrence of a fault that nobody has acknowledged, and what came of it since."""

    number: int
    text: str
    """Text of the fault, with the facts of this occurrence."""
    since: datetime
    """Time of this occurrence, UTC."""
    run: int | None
    times: int = 1
    """How often it came that nobody has acknowledged."""
    newest: datetime | None = None
    """Time of the last occurrence, UTC; None where there is but one."""


@dataclass(slots=True)
class _Occurrences:
    """Those of one number that nobody has acknowledged."""

    first: ActiveAlarm
    later: deque[ActiveAlarm] = field(default_factory=lambda: deque(maxlen=KEPT))
    times: int = 1

    def add(self, alarm: ActiveAlarm) -> None:
        self.later.append(alarm)
        self.times += 1

    def told(self) -> ActiveAlarm:
        if not self.later:
            return self.first
        return replace(self.first, times=self.times, newest=self.later[-1].since)

    def without(self, taken: int) -> "_Occurrences | None":
        """The occurrences after the first ``taken``; None where nothing is left."""
        left = self.times - taken
        if left <= 0:
            return None
        # Of more than are remembered the oldest one that is has to stand for the first.
        kept = list(self.later)[-left:]
        return _Occurrences(kept[0], deque(kept[1:], maxlen=KEPT), left)


class Alarms:
    """The active alarms by number, the oldest first; the store has every single one."""

    def __init__(self, store: AsyncRunStore, background: Background) -> None:
        self._store = store
        self._background = background
        self._active: dict[int, _Occurrences] = {}
        self._turn = asyncio.Lock()

    @property
    def numbers(self) -> tuple[int, ...]:
        """Each fault number once."""
        return tuple(self._active)

    @property
    def active(self) -> tuple[ActiveAlarm, ...]:
        """One for each number, the oldest first."""
        return tuple(one.told() for one in self._active.values())

    async def open(self) -> None:
        """Take over what was active before the restart."""
        # The store gives the oldest first.
        for alarm in await self._store.do(RunStore.active_alarms):
            self._came(ActiveAlarm(alarm.number, alarm.text, alarm.time, alarm.run))
        if self._active:
            _log.warning("alarms not yet acknowledged", numbers=self.numbers)

    def add(self, error: CellError, run: int | None) -> None:
        """A fault has come; written to the store in the background."""
        # The list changes at once and the store later: the line must see the alarm also when the
        # disk is what has failed.
        text = "; ".join([str(error), *getattr(error, "__notes__", ())])
        self._came(ActiveAlarm(error.number, text, utc_now(), run))
        self._background.start(self._store.do(RunStore.add_alarm, run, error.number, text))

    def _came(self, alarm: ActiveAlarm) -> None:
        known = self._active.get(alarm.number)
        if known is None:
            self._active[alarm.number] = _Occurrences(alarm)
        else:
            known.add(alarm)

    async def acknowledge(self, number: int, who: str, seen: int = 0) -> bool:
        """Acknowledge the first ``seen`` alarms with this number, or all; False for none active.

        Whatever comes meanwhile, or came after those that were seen, stays active.
        """
        async with self._turn:
            known = self._active.get(number)
            if known is None:
                return False
            taken = min(seen or known.times, known.times)
            # The disk first, so that an acknowledged alarm does not come back with the next start.
            await self._store.do(RunStore.acknowledge_alarms, number, who, taken)
            left = known.without(taken)
            if left is None:
                del self._active[number]
            else:
                self._active[number] = left
            return True
