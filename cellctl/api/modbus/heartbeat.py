"""The heartbeat of the line PLC: a counter that must change. Any constant value means lost.

Every client of the Modbus server can write the counter. What counts is the counter of the client
that is in command: an operator page that beats as well must not make a dead PLC look alive.
"""

import asyncio
from collections.abc import Callable
from functools import partial

_LATE_S = 0.1
"""A timer that fires later than this shows that the event loop itself was held up: a loop that is
not busy is late by a millisecond."""
_GRACE_S = 0.25
"""After such a delay, beats that already wait in the socket get this long to be read, once. Reading
them takes a few turns of the loop. A line that is really dead is noticed later by this time."""


class HeartbeatWatch:
    """Missing until the first change, alive while it changes, lost after ``timeout_s`` without.

    ``on_lost`` is called once at each loss and must not raise.
    """

    def __init__(self, timeout_s: float, on_lost: Callable[[], None]) -> None:
        self._timeout_s = timeout_s
        self._on_lost = on_lost
        self._value = 0
        self._seen_s: float | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._lost = False
        self._graced = False

    @property
    def age_s(self) -> float | None:
        """Since the counter has changed; None before its first change."""
        return None if self._seen_s is None else asyncio.get_running_loop().time() - self._seen_s

    @property
    def alive(self) -> bool:
        """True while the counter changes in time."""
        return self._timer is not None

    @property
    def lost(self) -> bool:
        """True once it was alive and stood still; False again as soon as it changes."""
        return self._lost

    def seen(self, value: int) -> bool:
        """A client has written the counter; True when that ended a silence."""
        if value == self._value:
            return False
        self._value = value
        self._seen_s = asyncio.get_running_loop().time()
        back = self._timer is None
        if self._timer is not None:
            self._timer.cancel()
        self._lost = self._graced = False
        self._arm(self._timeout_s)
        return back

    def stop(self) -> None:
        """Stop watching. Idempotent."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _arm(self, delay_s: float) -> None:
        loop = asyncio.get_running_loop()
        self._timer = loop.call_later(delay_s, self._expired, loop.time() + delay_s)

    def _expired(self, due_s: float) -> None:
        if not self._graced and asyncio.get_running_loop().time() - due_s > _LATE_S:
            # The PLC is not to blame for a delay of this process. But in a loop that is always late
            # a second grace would follow the first one for ever, and a dead PLC would never show.
            self._graced = True
            self._arm(_GRACE_S)
            return
        self._timer = None
        self._lost = True
        self._on_lost()


class LineHeartbeat:
    """The heartbeat of the client in command, and those of the others, which count for nothing.

    In command is the client, known by its address, that has given the last command besides those
    that only halt the unit; before the first command it is the first one to beat. Observers of
    ``on_lost`` are called once at each loss and must not raise.
    """

    def __init__(self, timeout_s: float, on_lost: Callable[[], None]) -> None:
        self._timeout_s = timeout_s
        self.on_lost = [on_lost]
        self._watches: dict[str, HeartbeatWatch] = {}
        self._in_command = ""

    @property
    def alive(self) -> bool:
        """True while the client in command beats."""
        return self.alive_of(self._in_command)

    @property
    def lost(self) -> bool:
        """True once the client in command was alive and stood still, until it beats again."""
        watch = self._watches.get(self._in_command)
        return watch is not None and watch.lost

    @property
    def age_s(self) -> float | None:
        """Since the counter of the client in command has changed; None before its first change."""
        watch = self._watches.get(self._in_command)
        return None if watch is None else watch.age_s

    def in_command(self, client: str) -> bool:
        """True for the address of the client in command, also while its line is lost."""
        return client == self._in_command

    def alive_of(self, client: str) -> bool:
        """True while this client beats, in command or not."""
        watch = self._watches.get(client)
        return watch is not None and watch.alive

    def seen(self, client: str, value: int) -> bool:
        """A client has written the counter; True when that ended a silence of the line."""
        watch = self._watches.get(client) or self._new_watch(client)
        back = watch.seen(value)
        self._in_command = self._in_command or (client if watch.alive else "")
        return back and client == self._in_command

    def commanded(self, client: str) -> None:
        """A client has given a command: it is in command from now on, if it beats itself."""
        if self.alive_of(client):
            self._in_command = client

    def stop(self) -> None:
        """Stop watching all clients. Idempotent."""
        for watch in self._watches.values():
            watch.stop()

    def _new_watch(self, client: str) -> HeartbeatWatch:
        # Clients that are gone are forgotten: a PLC behind changing addresses must not fill this.
        for known, watch in tuple(self._watches.items()):
            if not watch.alive and known != self._in_command:
                del self._watches[known]
        self._watches[client] = HeartbeatWatch(self._timeout_s, partial(self._expired, client))
        return self._watches[client]

    def _expired(self, client: str) -> None:
        if client == self._in_command:
            for observer in self.on_lost:
                observer()
