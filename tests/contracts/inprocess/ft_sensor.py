"""A force/torque sensor in memory, driven by the clock."""

import math
import socket
import time

from cellctl.clock import now_s
from cellctl.errors.link import LinkLost
from cellctl.interfaces.ft_sensor import FtHealth, FtSensor, WrenchSample


class InProcessSensor(FtSensor):
    """Makes the samples that are due whenever it is read."""

    def __init__(self, wrench: tuple[float, ...], rate_hz: float) -> None:
        self.wrench = wrench
        self.silent = self.losing = self.spoiling = self.overloaded = self.broken = False
        self._rate_hz = rate_hz
        self._sockets: tuple[socket.socket, socket.socket] | None = None
        self._next_s = 0.0
        self._number = 0
        self._counts = dict.fromkeys(("samples", "lost", "errors", "saturated", "reconnects"), 0)

    def open(self) -> None:
        self.close()
        self._sockets = socket.socketpair()
        self._sockets[1].send(b"x")
        self._next_s = now_s()

    def close(self) -> None:
        if self._sockets is not None:
            for end in self._sockets:
                end.close()
            self._sockets = None

    def fileno(self) -> int:
        return -1 if self._sockets is None else self._sockets[0].fileno()

    def read(self, timeout_s: float) -> tuple[WrenchSample, ...]:
        if self._sockets is None:
            raise LinkLost("closed")
        if self.broken:
            self.broken = False
            self._counts["reconnects"] += 1
            return ()
        if self.silent:
            time.sleep(timeout_s)
            return ()
        time.sleep(max(0.0, self._next_s - now_s()))
        samples = []
        while self._next_s <= now_s():
            samples += self._sample(self._next_s)
            self._next_s += 1.0 / self._rate_hz
        return tuple(samples)

    def health(self) -> FtHealth:
        return FtHealth(
            samples=self._counts["samples"],
            lost=self._counts["lost"],
            checksum_errors=self._counts["errors"],
            saturated=self._counts["saturated"],
            reconnects=self._counts["reconnects"],
            rate_hz=self._rate_hz,
        )

    def serial_number(self) -> str:
        return "MEMORY-1"

    def _sample(self, time_s: float) -> list[WrenchSample]:
        self._number += 1
        if self._number % 5 == 0 and (self.losing or self.spoiling):
            self._counts["lost" if self.losing else "errors"] += 1
            return []
        if not all(math.isfinite(value) for value in self.wrench):
            return []
        self._counts["samples"] += 1
        self._counts["saturated"] += self.overloaded
        fx, fy, fz, mx, my, mz = self.wrench
        return [
            WrenchSample(
                now_s(), time_s, self._number, fx, fy, fz, mx, my, mz, saturated=self.overloaded
            )
        ]
