"""Follows the hub and fills an outbox for each receiver of the settings."""

import asyncio
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from cellctl import log
from cellctl.clock import now_s
from cellctl.hmi.hub import Hub
from cellctl.hmi.notifying.events import Event, EventWatch
from cellctl.hmi.notifying.outbox import Outbox
from cellctl.hmi.notifying.senders import Messenger, StartedProgram, WebHook
from cellctl.hmi.settings import Receiver

_LOOK_S = 1.0
_DUE_PERIOD_S = 60.0
"""Calibrations end by the day: their dates need not be read at each of ten snapshots a second."""
_log = log.get(__name__)


class Notifier:
    """Belongs to one event loop."""

    def __init__(self, hub: Hub, receivers: Sequence[Receiver]) -> None:
        self._hub = hub
        self._watch = EventWatch()
        self._due_s = -math.inf
        """When calibrations are looked at next."""
        self._outboxes = [(frozenset(one.on), Outbox(sender_of(one))) for one in receivers]

    async def run(self) -> None:
        """Tell all receivers until cancelled; returns at once where there are none."""
        if not self._outboxes:
            return
        async with asyncio.TaskGroup() as group:
            for _, outbox in self._outboxes:
                group.create_task(outbox.run(), name="tell a receiver")
            version, understood = -1, True
            while True:
                # Without anything new it looks all the same: silence is something to tell, too.
                await self._hub.wait(version, _LOOK_S)
                version = self._hub.version
                try:
                    self._look()
                except (LookupError, TypeError, ValueError) as error:
                    # A daemon of another version may say less. Complained of once, not ten times
                    # a second.
                    if understood:
                        _log.error("snapshot not understood", reason=repr(error))
                    understood = False

    def _look(self) -> None:
        hub, watch = self._hub, self._watch
        if hub.description and now_s() >= self._due_s:
            self._due_s = now_s() + _DUE_PERIOD_S
            self._put(watch.description(hub.description))
        self._put(watch.age(hub.age_s))
        if hub.snapshot and hub.linked:
            self._put(watch.snapshot(hub.snapshot))

    def _put(self, messages: Iterable[Mapping[str, Any]]) -> None:
        for message in messages:
            for wanted, outbox in self._outboxes:
                if Event(message["event"]) in wanted:
                    outbox.put(message)


def sender_of(receiver: Receiver) -> Messenger:
    """What delivers to a receiver of the settings."""
    if receiver.url:
        return WebHook(receiver.url, receiver.headers)
    return StartedProgram(receiver.program)
