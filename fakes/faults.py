"""Faults that can be injected into robots, trackers and the bodies of a scene, by name.

The interface box and the frame servers keep their own; the control port reaches all of them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

ROBOT_FAULTS = {
    "split": "records leave in two writes, `gap_s` apart",
    "merged": "records are held back and leave `records` at a time",
    "dribbled": "records leave byte by byte",
    "late": "records leave `delay_s` late",
    "corrupt": "a digit of a record changes after its sum was made",
    "silent": "nothing leaves any more, the socket stays open",
    "cut": "every connection is closed, and none is opened until the fault is cleared",
    "half_open": "nothing leaves and nothing is read any more, the socket stays open",
    "never_ack": "a command is neither acknowledged nor executed",
    "never_done": "the end of a motion is never reported",
    "frozen_stat": "STAT repeats its last record",
    "clock_jump": "robot_ms jumps by `jump_ms`",
    "ignore_stop": "a stop request is overheard",
    "stop_latency": "stops take `latency_s`",
    "wrong_version": "HELLO names version 9",
    "wrong_euler": "HELLO names EUL=ZYZ, which no PC knows",
    "other_euler": "HELLO names EUL=XYZ, and the angles are in the order ZYX all the same",
    "wrong_unit": "HELLO names UNIT=MRAD",
    "wrong_name": "HELLO names another controller",
    "reject": "a motion is rejected with `reason`",
    "abort": "a motion is aborted with `reason` when `after_s` have passed",
    "emergency_stop": "the button is pressed until the fault is cleared",
    "emergency_stop_mid_move": "the button is pressed `after_s` into the next motion",
    "manual_mode": "the panel's key is turned to manual until the fault is cleared",
    "automatic_mode": "the panel's key is turned to automatic until the fault is cleared",
    "drives_off": "the drives are off until the fault is cleared",
    "vendor_error": "the controller shows error `code` until the fault is cleared",
    "override_zero": "the speed override is 0 % until the fault is cleared",
    "reboot": "all connections drop and the job programs start again",
    "set_lost": "a setpoint of a stream is overheard",
    "set_late": "a setpoint of a stream is heard together with the next one",
    "set_repeated": "a setpoint of a stream is heard twice",
    "ticks_silent": "the ticks of a stream are not reported, the stream goes on",
}
JOB_FAULTS = {
    name: meaning
    for name, meaning in ROBOT_FAULTS.items()
    if name not in {"set_lost", "set_late", "set_repeated", "ticks_silent"}
} | {
    "never_ack": "a command is executed and not acknowledged",
    "frozen_stat": "the background jobs stand still",
    "clock_jump": "TIMER jumps by `jump_ms`, for STAT and for the dead man alike",
    "reject": "the next motion is an alarm with `reason` that ends the main job",
    "abort": "the controller shows an error when `after_s` have passed",
}
"""Faults of a controller that runs the shipped jobs, which offer no streamed motion."""
TRACKER_FAULTS = {
    "silent": "requests are not answered",
    "error": "requests are answered with an error",
    "hidden": "target `name` is not seen",
    "wrong_id": "the reply carries another id",
    "malformed": "the reply is not JSON",
}


@dataclass(slots=True)
class Fault:
    """An injected fault; it ends when it has been used ``count`` times, or when it is cleared."""

    name: str
    count: int | None = None
    parameters: dict[str, float | str] = field(default_factory=dict)

    def number(self, name: str, default: float) -> float:
        """A numeric parameter."""
        return float(self.parameters.get(name, default))

    def text(self, name: str, default: str) -> str:
        """A textual parameter."""
        return str(self.parameters.get(name, default))


class FaultBoard:
    """The faults of one device."""

    def __init__(self, device: str, known: Mapping[str, str]) -> None:
        """``known``: every fault that this device can have, with its meaning."""
        self.device = device
        self.known = known
        self._active: dict[str, Fault] = {}

    def inject(self, name: str, *, count: int | None = None, **parameters: float | str) -> None:
        """Inject a fault; raises ``ValueError`` for a name that this device does not know."""
        if name not in self.known:
            known = ", ".join(sorted(self.known))
            raise ValueError(f"{self.device} knows no fault {name!r}; it knows {known}")
        self._active[name] = Fault(name, count, parameters)

    def clear(self, name: str | None = None) -> None:
        """End one fault, or all."""
        if name is None:
            self._active.clear()
        else:
            self._active.pop(name, None)

    def active(self, name: str) -> Fault | None:
        """The fault if it is injected; does not use it up."""
        return self._active.get(name)

    def use(self, name: str) -> Fault | None:
        """The fault if it is injected, counted as used once."""
        fault = self._active.get(name)
        if fault is not None and fault.count is not None:
            fault.count -= 1
            if fault.count <= 0:
                del self._active[name]
        return fault

    def names(self) -> list[str]:
        """Injected faults."""
        return sorted(self._active)
