"""A six-axis force/torque sensor, read by the guard process.

This interface blocks by design (docs/decisions/0003): its only caller is the guard, a process of
its own without an event loop, because nothing else may delay a stop.
"""

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from cellctl.interfaces.device import BlockingDevice


class WrenchSample(NamedTuple):
    """One raw sample in the sensor frame. A NamedTuple: made a thousand times a second."""

    receive_time_s: float
    """Monotonic time when its bytes arrived."""
    time_s: float
    """De-jittered sample time, same clock."""
    number: int
    """The device's packet number, or a running count where it has none."""
    fx_n: float
    fy_n: float
    fz_n: float
    mx_n_m: float
    my_n_m: float
    mz_n_m: float
    saturated: bool


@dataclass(frozen=True, slots=True)
class FtHealth:
    """Counters since ``open``."""

    samples: int = 0
    lost: int = 0
    """Samples missing by packet number."""
    checksum_errors: int = 0
    resynchronised_bytes: int = 0
    """Bytes thrown away while looking for a frame."""
    invalid: int = 0
    """Frames with a good check that are no new samples: their values are not finite numbers, or
    they have the number of the frame before."""
    saturated: int = 0
    reconnects: int = 0
    rate_deviations: int = 0
    """Measuring windows whose rate was further from the set rate than the driver tolerates."""
    rate_hz: float = 0.0
    """Measured over the last second or so."""


class FtSensor(BlockingDevice):
    """Called by the guard process only; every method blocks no longer than it says.

    The driver's ``Config`` has a field ``rate_hz``: samples a second that the device is set to.

    Methods may raise ``ConnectTimeout``, ``LinkLost``, ``ReplyTimeout``, ``ProtocolViolation``.
    """

    @classmethod
    def remarks(cls, config: Any) -> Mapping[str, str]:  # noqa: ARG003
        """What `cellctl check` says of settings that are possible and should be looked at again, by
        their keys; ``config`` is a ``Config`` of the driver."""
        return {}

    @abstractmethod
    def open(self) -> None:
        """Connect, configure, start the stream and wait for the first valid sample."""

    @abstractmethod
    def close(self) -> None:
        """Stop the stream and drop the link. Idempotent, in any state."""

    @abstractmethod
    def read(self, timeout_s: float) -> tuple[WrenchSample, ...]:
        """Samples that arrived since the last call, oldest first; empty after ``timeout_s``."""

    @abstractmethod
    def health(self) -> FtHealth:
        """Counters for the log and the acceptance of a run."""

    @abstractmethod
    def serial_number(self) -> str:
        """Identity of sensor and box, for the record and the calibration gate."""
