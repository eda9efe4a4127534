"""One connection from its first byte on: start-up, first frame, stream."""

from collections.abc import Sequence
from typing import Protocol

from drivers.ftsensor.sri import faults
from drivers.ftsensor.sri.config import SriConfig
from drivers.ftsensor.sri.connection import Connection
from drivers.ftsensor.sri.protocol import Frame, Reply
from drivers.ftsensor.sri.startup import BoxSetup, Exchange, StartUp


class Decoder(Protocol):
    """Turns the bytes of a connection into replies and frames."""

    checksum_errors: int
    skipped_bytes: int

    def feed(self, data: bytes) -> Sequence[Reply | Frame]:
        """Take bytes, return what became complete."""
        ...


class BoxSession:
    """Never waits: ``pump`` takes what is there and looks at the clock.

    ``pump`` raises ``ConnectTimeout``, ``LinkLost``, ``ReplyTimeout``, ``StaleData`` or
    ``SensorSetupWrong``; the session is over then.
    """

    def __init__(
        self,
        config: SriConfig,
        connection: Connection,
        decoder: Decoder,
        start_up: StartUp,
        now_s: float,
    ) -> None:
        self.setup: BoxSetup | None = None
        """Known once the start-up is through."""
        self.streaming = False
        """True from the first good frame on."""
        self._config = config
        self._connection = connection
        self._decoder = decoder
        self._start_up = start_up
        self._waiting: Exchange | None = None
        self._begun = False
        self._was_prompt = False
        """The first frame has come, and not too late."""
        self._deadline_s = now_s + config.connect_timeout_s
        self._quiet_since_s = now_s
        self._started_s = self._empty_s = now_s
        """When the stream was started, and when it was last looked at in vain."""
        self._skipped_before = 0
        self._errors_before = 0
        connection.connect()

    @property
    def checksum_errors(self) -> int:
        """Frames with a wrong check since the stream began; what was drained before does not
        count."""
        return self._decoder.checksum_errors - self._errors_before if self.streaming else 0

    @property
    def skipped_bytes(self) -> int:
        """Bytes since the stream began that belonged to no frame and no reply."""
        return self._decoder.skipped_bytes - self._skipped_before if self.streaming else 0

    def pump(self, now_s: float) -> list[Frame]:
        """Go on as far as possible; the frames that arrived."""
        if not self._begun and not self._begin(now_s):
            return []
        frames = self._receive(now_s)
        if frames:
            self._begin_stream()
            self._require_prompt()
            # From here on each frame moves the limit, so a stream that stops ends the session.
            self._deadline_s = now_s + self._config.first_frame_timeout_s
        elif now_s > self._deadline_s or self._quiet(now_s):
            self._time_out(now_s)
        elif self.setup is not None:
            self._empty_s = now_s
        return frames

    def _begin(self, now_s: float) -> bool:
        if not self._connection.established():
            if now_s > self._deadline_s:
                raise faults.cannot_connect(self._connection.peer, "no answer")
            return False
        self._begun = True
        self._quiet_since_s = now_s
        self._advance(None, now_s)
        return True

    def _receive(self, now_s: float) -> list[Frame]:
        """Frames count once the set-up is through; replies go to whoever waits for them."""
        data = self._connection.receive()
        if not data:
            return []
        self._quiet_since_s = now_s
        frames: list[Frame] = []
        for item in self._decoder.feed(data):
            if isinstance(item, Frame):
                # Frames before the end of the set-up may still have the format of the session
                # before.
                if self.setup is not None:
                    frames.append(item)
            # A late answer to another question, such as the stop, must not pass for this one.
            elif self._waiting is not None and item.name == self._waiting.name:
                self._advance(item, now_s)
        return frames

    def _require_prompt(self) -> None:
        """The first sample is taken when the stream starts: a first frame that is late is old."""
        # The wait ends with the last look that has found nothing. Up to the time at which the frame
        # was found it would blame the box for a pause of this PC.
        lag_s = self._empty_s - self._started_s - self._config.points / self._config.rate_hz
        if not self._was_prompt and lag_s > self._config.max_lag_s:
            raise faults.late(self._connection.peer, lag_s, self._config.max_lag_s)
        self._was_prompt = True

    def _begin_stream(self) -> None:
        if not self.streaming:
            self.streaming = True
            self._skipped_before = self._decoder.skipped_bytes
            self._errors_before = self._decoder.checksum_errors

    def _quiet(self, now_s: float) -> bool:
        waiting = self._waiting
        if waiting is None or waiting.quiet_s is None:
            return False
        return now_s - self._quiet_since_s > waiting.quiet_s

    def _time_out(self, now_s: float) -> None:
        if self._waiting is None:
            raise faults.no_reply(self._connection.peer, "the start of the stream (no frame)")
        self._advance(None, now_s)

    def _advance(self, reply: Reply | None, now_s: float) -> None:
        """Hand the answer to the start-up, send what it wants next."""
        while True:
            try:
                exchange = self._start_up.send(reply)
            except StopIteration as stop:
                self.setup, self._waiting = stop.value, None
                self._started_s = self._empty_s = now_s
                self._deadline_s = now_s + self._config.first_frame_timeout_s
                return
            self._connection.send(exchange.send)
            if exchange.timeout_s > 0.0:
                self._waiting = exchange
                self._deadline_s = now_s + exchange.timeout_s
                return
            reply = None
