"""SRI six-axis sensor behind an M8128-family box, over TCP, serial or CAN (README.md)."""

from collections.abc import Mapping

from cellctl.clock import now_s
from cellctl.errors.link import LinkError, LinkLost
from cellctl.interfaces.ft_sensor import FtHealth, FtSensor, WrenchSample
from drivers.ftsensor.sri import faults
from drivers.ftsensor.sri.config import SriConfig
from drivers.ftsensor.sri.links import Link, link_for
from drivers.ftsensor.sri.sampler import Sampler
from drivers.ftsensor.sri.session import BoxSession

_LONGEST_WAIT_S = 0.05
"""Time-outs of the start-up are looked at this often."""


class SriSensor(FtSensor):
    """Reconnects by itself for reading; ``read`` is empty until the start-up has run again."""

    Config = SriConfig

    @classmethod
    def remarks(cls, config: SriConfig) -> Mapping[str, str]:
        """A remark where this PC, and not the box, converts the samples to newtons."""
        return config.remarks

    def __init__(self, config: SriConfig) -> None:
        self._config = config
        self._link: Link = link_for(config)
        self._sampler = Sampler(config)
        self._session: BoxSession | None = None
        self._opened = False
        self._retry_s = 0.0
        self._firmware = ""
        self._reconnects = 0
        self._checksum_errors = 0
        self._skipped_bytes = 0
        self._ready: list[WrenchSample] = []

    def open(self) -> None:
        """Connect, configure, start, wait for the first frame; all time-outs are configured."""
        self.close()
        self._begin()
        try:
            while not self._opened:
                self._ready += self._pump()
                if not self._opened:
                    self._link.connection.wait(_LONGEST_WAIT_S)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Ask the box to stop, drop the link."""
        session, self._opened = self._session, False
        if session is not None and session.setup is not None:
            try:
                # Left streaming, the box would fill the next connection with frames before it
                # answers anything.
                self._link.connection.send(self._link.stop)
            except LinkLost:
                self._end()
        self._end()
        self._ready.clear()

    def fileno(self) -> int:
        """Descriptor of the link; changes with a reconnection, -1 while there is none."""
        return self._link.connection.fileno()

    def read(self, timeout_s: float) -> tuple[WrenchSample, ...]:
        """Samples that have arrived.

        Raises ``SensorSetupWrong`` when another box answers, or one that does not count its frames.
        """
        if not self._opened:
            raise LinkLost(f"force sensor at {self._link.connection.peer} is not open")
        deadline_s = now_s() + timeout_s
        while True:
            # What came with the first frame while ``open`` was waiting must not be lost.
            samples = self._ready or self._pump()
            self._ready = []
            left_s = deadline_s - now_s()
            if samples or left_s <= 0.0:
                return tuple(samples)
            # In short pieces, because time-outs of a start-up that runs meanwhile have to be looked
            # at.
            self._link.connection.wait(min(left_s, _LONGEST_WAIT_S))

    def health(self) -> FtHealth:
        """Counters since the driver was made."""
        session, sampler = self._session, self._sampler
        return FtHealth(
            samples=sampler.samples,
            lost=sampler.lost,
            checksum_errors=self._checksum_errors + (session.checksum_errors if session else 0),
            resynchronised_bytes=self._skipped_bytes + (session.skipped_bytes if session else 0),
            invalid=sampler.invalid,
            saturated=sampler.saturated,
            reconnects=self._reconnects,
            rate_deviations=sampler.clock.deviations,
            rate_hz=sampler.clock.rate_hz,
        )

    def serial_number(self) -> str:
        """Sensor as configured, firmware as read."""
        return f"{self._config.serial_number or 'no serial number'} ({self._firmware})"

    def _pump(self) -> list[WrenchSample]:
        """Do what can be done without waiting, and return the samples that have arrived.

        A broken link is connected again after a pause.
        """
        time_s = now_s()
        if self._session is None and time_s < self._retry_s:
            return []
        try:
            if self._session is None:
                self._begin()
            return self._samples(time_s)
        except LinkError:
            self._end()
            # During ``open`` the caller has to hear of it. Later the stream comes back by itself,
            # and the silence until then is judged by the guard.
            if not self._opened:
                raise
            # Without a pause a box that refuses connections would keep the guard busy with nothing
            # else.
            self._retry_s = time_s + self._config.reconnect_s
            return []

    def _samples(self, time_s: float) -> list[WrenchSample]:
        session = self._session
        assert session is not None
        was_streaming = session.streaming
        frames = session.pump(time_s)
        if not frames:
            return []
        if not was_streaming and session.setup is not None:
            # A new stream has a new numbering and a new phase: joined to the old one it would show
            # a gap that never was, and times that are off.
            self._sampler.restart(session.setup.convert)
            self._firmware = session.setup.firmware
            self._reconnects += self._opened
            self._opened = True
        samples = self._sampler.take(frames, now_s())
        if (number := self._sampler.uncounted) is not None:
            raise faults.not_counting(self._link.connection.peer, number)
        if (lag_s := self._sampler.clock.lag_s) > self._config.max_lag_s:
            # A new stream begins with what is taken now, and shows by its first frame whether it is
            # late too.
            raise faults.late(self._link.connection.peer, lag_s, self._config.max_lag_s)
        return samples

    def _begin(self) -> None:
        link = self._link
        self._session = BoxSession(
            self._config, link.connection, link.decoder(), link.start_up(), now_s()
        )

    def _end(self) -> None:
        if self._session is not None:
            self._checksum_errors += self._session.checksum_errors
            self._skipped_bytes += self._session.skipped_bytes
            self._session = None
        self._link.connection.close()
