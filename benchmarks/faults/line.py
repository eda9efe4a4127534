"""The line PLC of the campaign: reads everything at once, and can fall silent."""

from dataclasses import dataclass

from pymodbus.exceptions import ModbusException

from tests.rigs.whole_cell.outside_plc import INPUT, STATES, OutsidePlc

_ALARMS = [f"alarm_{number}" for number in range(1, 9)]


@dataclass(frozen=True, slots=True)
class Shown:
    """One reading of the input registers."""

    state: str
    step: int
    first_out: int
    alarms: tuple[int, ...]
    run: int


class WatchingPlc(OutsidePlc):
    """Its heartbeat ends quietly when the daemon does."""

    def shown(self) -> Shown:
        """What the cell shows now."""
        block = self.block()
        run = INPUT["run_number"]
        return Shown(
            state=STATES[block[INPUT["state"]]],
            step=block[INPUT["step"]],
            first_out=block[INPUT["first_out_alarm"]],
            alarms=tuple(block[INPUT[name]] for name in _ALARMS if block[INPUT[name]]),
            run=block[run] << 16 | block[run + 1],
        )

    def fall_silent(self) -> None:
        """The heartbeat stands still from now on; reading goes on."""
        self._quiet.set()
        self._beat.join(5)

    def _beats(self) -> None:
        try:
            super()._beats()
        except (ModbusException, AssertionError, OSError):
            return  # the daemon has gone, which the trial sees by itself
