"""The guard's hold on its stop channel: beats, stop requests that are repeated, reconnection."""

import os
import threading
from collections.abc import Container

from cellctl.errors.base import CellError
from cellctl.interfaces.stop_channel import FlangeState, StopChannel

_RETRY_S = 0.5


class StopLine:
    """Never blocks: a channel is opened in a thread, which hands it over when it stands.

    While a stop is wanted it is requested again at every beat until the robot reports that it has
    latched. A robot that has not by ``confirm_s`` gets no more beats: its dead man is the second
    way to stop it.
    """

    def __init__(self, channel: StopChannel | None, confirm_s: float) -> None:
        self.up = channel is None
        """True while the channel stands, or when there is none."""
        self.fault: CellError | None = None
        """Why the channel last went down or did not open."""
        self._channel = channel
        self._confirm_s = confirm_s
        self._wanted_s: float | None = None
        self._confirmed = False
        self._opener: threading.Thread | None = None
        self._retry_s = 0.0
        self._bell = os.eventfd(0, os.EFD_NONBLOCK)

    @property
    def present(self) -> bool:
        """True when there is a channel at all."""
        return self._channel is not None

    @property
    def opening(self) -> bool:
        """True while an attempt to open runs."""
        return self._opener is not None

    def filenos(self) -> list[int]:
        """Descriptors to wait on."""
        descriptor = -1 if self._channel is None or not self.up else self._channel.fileno()
        return [self._bell] if descriptor < 0 else [self._bell, descriptor]

    def open(self) -> None:
        """Begin to open the channel."""
        channel = self._channel
        if channel is None or self._opener is not None:
            return

        def run() -> None:
            try:
                channel.open()
                self.fault = None
            except CellError as error:
                self.fault = error
            os.eventfd_write(self._bell, 1)

        self._opener = threading.Thread(target=run, name="stop-channel", daemon=True)
        self._opener.start()

    def due(self, ready: Container[object]) -> bool:
        """Whether ``poll`` has anything to do, given the descriptors that are readable."""
        if self._channel is None or not self.up:
            return self._channel is not None
        descriptor = self._channel.fileno()
        return descriptor < 0 or descriptor in ready

    def poll(self, now_s: float) -> FlangeState | None:
        """Take what has arrived; keep the channel open."""
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
        if state is not None and self._wanted_s is not None:
            self._confirmed = state.stop_latched
        return state

    def stop(self, now_s: float) -> None:
        """Want a stop: the first request leaves at once."""
        if self._wanted_s is None:
            self._wanted_s, self._confirmed = now_s, False
        self._request(now_s)

    def release(self) -> None:
        """Want no stop any more."""
        self._wanted_s = None

    def beat(self, now_s: float) -> None:
        """Repeat a stop that is not confirmed; beat unless it has taken too long."""
        wanted_s = self._wanted_s
        if wanted_s is not None and not self._confirmed:
            self._request(now_s)
            if now_s - wanted_s > self._confirm_s:
                return
        if self._channel is not None and self.up:
            try:
                self._channel.heartbeat()
            except CellError as error:
                self._lost(error, now_s)

    def close(self) -> None:
        """Drop the channel; the robot takes that as a stop of its own."""
        if self._channel is not None and self._opener is None:
            self._channel.close()
        self.up = False

    def _request(self, now_s: float) -> None:
        if self._channel is None or not self.up:
            return
        try:
            self._channel.request_stop()
        except CellError as error:
            self._lost(error, now_s)

    def _lost(self, error: CellError, now_s: float) -> None:
        self.up, self.fault = False, error
        self._retry_s = now_s
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
