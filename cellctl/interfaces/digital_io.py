"""Named digital inputs and outputs of the cell."""

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from cellctl.interfaces.device import Device


@dataclass(frozen=True, slots=True)
class DigitalIoState:
    """All signals at one time, by the names of the cell file."""

    time_s: float
    """Monotonic time at which the device's answer was complete on this PC."""
    inputs: Mapping[str, bool]
    outputs: Mapping[str, bool]
    """Outputs as the device drives them, which is not always what was written."""


@dataclass(frozen=True, slots=True)
class IoNames:
    """Names of the signals of a device."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


class DigitalIo(Device):
    """Called by steps, from the daemon's event loop only.

    The safe state of every output is *off*. Actuators must be wired so that this is true, because
    it is also what a device without power or without its PC does. Outputs go to the safe state
    when ``disconnect`` is called, and by the device's own doing when it no longer hears this PC.

    Connecting changes no output. Outputs that the device has switched off are never switched on
    again by the driver itself.

    Methods may raise ``LinkLost``, ``ReplyTimeout``, ``ProtocolViolation``, ``DeviceFault`` or
    ``OutputsDropped``; ``connect`` also ``WatchdogUnsuitable``. After any of them every call raises
    until ``connect`` is called again, because it is open what the outputs have done; Clear does
    that. ``connect`` does nothing while the link stands.
    """

    input_names: tuple[str, ...]
    output_names: tuple[str, ...]

    @classmethod
    def names(cls, config: Any) -> IoNames | None:  # noqa: ARG003
        """The signals that these settings name, before anything is connected; None where only the
        device knows them. What the cell file says of outputs is held against them."""
        return None

    @abstractmethod
    async def disconnect(self) -> None:
        """Switch every output off and drop the link. Idempotent, in any state."""

    @abstractmethod
    async def read(self) -> DigitalIoState:
        """Ask the device now for all signals."""

    @abstractmethod
    async def write(self, outputs: Mapping[str, bool]) -> None:
        """Set these outputs, in the order given; the others stay as they are.

        Returns when the device has confirmed all of them. An unknown name raises
        ``SignalUnknown`` and then nothing is written at all.
        """
