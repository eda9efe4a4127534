"""The guard's use of its stop channel: heartbeats, repeated stop requests, reconnection."""

import os
import threading
from collections.abc import Container

from cellctl.errors.base import CellError
from cellctl.errors.internal import Unexpected
from cellctl.interfaces.stop_channel import FlangeState, StopChannel

_RETRY_S = 0.5
"""Pause between attempts to connect: long enough not to flood a controller that is starting up. Its
exact value does not matter, because a guard without its channel cannot be armed."""

STAND_S = 2.0
"""A robot that has latched a stop and still reports after this time that it moves is not stopping:
arms come to rest within a second."""


class StopSupervisor:
    """Repeats a wanted stop until it is confirmed, and tells the robot that the guard lives.

    A request that was sent is not yet a robot that stands: the message can be lost with its
    connection, and a robot program can ignore it. So the request is repeated at every beat until
    the robot reports that it has latched the stop. A robot that has not done so after
    ``confirm_s`` gets no more heartbeats: its dead man is the second way to stop it, and does not
    depend on the part of its program that has just failed.

    A robot that has latched the stop but was not seen standing within ``STAND_S`` gets no more
    heartbeats either, and is asked again. Once it was seen standing, it may move under its latch:
    then somebody jogs it at its panel.

    No method blocks. Connecting can take seconds, in which samples still have to be judged, so a
    thread connects and then hands the open channel over; the two never use it at the same time.
    """

    def __init__(self, channel: StopChannel | None, confirm_s: float) -> None:
        self.up = channel is None
        """True while the channel is open, or when there is none."""
        self.fault: CellError | None = None
        """Why the channel last went down or did not open."""
        self._channel = channel
        self._confirm_s = confirm_s
        self._wanted_s: float | None = None
        """Time since when a stop is wanted; None while none is."""
        self._latched = self._stood = False
        """What the robot has reported since the stop is wanted: whether it is latched now, and
        whether it has stood with it at any time."""
        self._opener: threading.Thread | None = None
        self._retry_s = 0.0
        """Monotonic time before which no new attempt to connect begins."""
        # The thread rings it when an attempt has ended, which wakes the loop out of ``select``.
        self._bell = os.eventfd(0, os.EFD_NONBLOCK)

    @property
    def present(self) -> bool:
        """True when there is a channel at all."""
        return self._channel is not None

    def filenos(self) -> list[int]:
        """Descriptors to wait on: the robot's reports, and the end of an attempt to connect."""
        # A channel that a thread is opening belongs to that thread, so its descriptor is not
        # watched.
        descriptor = -1 if self._channel is None or not self.up else self._channel.fileno()
        return [self._bell] if descriptor < 0 else [self._bell, descriptor]

    def open(self) -> None:
        """Begin to open the channel in a thread; does nothing while an attempt runs."""
        channel = self._channel
        if channel is None or self._opener is not None:
            return

        def run() -> None:
            try:
                channel.open()
                self.fault = None
            except CellError as error:
                self.fault = error
            # A defect of a driver must not end this thread in silence: nobody would ever try
            # again, and the daemon could only say that the guard is not ready.
            except Exception as error:  # noqa: BLE001
                self.fault = Unexpected(f"in the stop channel: {error!r}")
            os.eventfd_write(self._bell, 1)

        self._opener = threading.Thread(target=run, name="stop-channel", daemon=True)
        self._opener.start()

    def due(self, ready: Container[object]) -> bool:
        """Whether ``poll`` has anything to do, given the descriptors that are readable.

        A channel that is down always has: its retry depends on the time, not on a descriptor.
        """
        if self._channel is None or not self.up:
            return self._channel is not None
        descriptor = self._channel.fileno()
        return descriptor < 0 or descriptor in ready

    def poll(self, now_s: float) -> FlangeState | None:
        """The newest report that has arrived, if any; reconnects a channel that is down."""
        if self._channel is None:
            return None
        if not self.up:
            self._continue_opening(now_s)
            return None
        state: FlangeState | None = None
        try:
            state = self._channel.poll()
        except CellError as error:
            self._lost(error, now_s)
        # Not "confirmed once": a robot that releases its latch while the stop is still wanted,
        # for instance from its own panel, is asked again.
        if state is not None and self._wanted_s is not None:
            self._latched = state.stop_latched
            self._stood = self._stood or (state.stop_latched and not state.moving)
        return state

    def stop(self, now_s: float) -> None:
        """Want a stop from now on; the first request leaves at once."""
        first = self._wanted_s is None
        if first:
            self._wanted_s, self._latched, self._stood = now_s, False, False
        self._request(now_s, first=first)

    def release(self) -> None:
        """Want no stop any more. The robot's own latch is not the guard's to release."""
        self._wanted_s = None

    def beat(self, now_s: float) -> None:
        """Repeat a stop that is not confirmed; beat unless that has taken too long."""
        wanted_s = self._wanted_s
        if wanted_s is not None and not (self._latched and self._stood):
            late = now_s - wanted_s > (STAND_S if self._latched else self._confirm_s)
            if late or not self._latched:
                self._request(now_s, first=False)
            # No heartbeat any more: the robot's dead man stops what does not obey the request.
            if late:
                return
        if self._channel is not None and self.up:
            try:
                self._channel.heartbeat()
            except CellError as error:
                self._lost(error, now_s)

    def close(self) -> None:
        """Close the channel, which the robot takes as a reason to stop.

        A channel that a thread is still opening is left to that thread: the process ends anyway.
        """
        if self._channel is not None and self._opener is None:
            self._channel.close()
        self.up = False

    def _request(self, now_s: float, *, first: bool) -> None:
        if self._channel is None or not self.up:
            return
        try:
            if first:
                self._channel.request_stop()
            else:
                self._channel.repeat_stop()
        except CellError as error:
            self._lost(error, now_s)

    def _lost(self, error: CellError, now_s: float) -> None:
        self.up, self.fault = False, error
        self._retry_s = now_s  # at once: only an attempt that fails is followed by a pause
        if self._channel is not None:
            self._channel.close()

    def _continue_opening(self, now_s: float) -> None:
        if self._opener is None:
            if now_s >= self._retry_s:
                self.open()
            return
        try:
            os.eventfd_read(self._bell)
        except BlockingIOError:
            return
        self._opener.join()
        self._opener = None
        self.up = self.fault is None
        self._retry_s = now_s + _RETRY_S
