"""The panel of a controller: key, button, drives and error number, as faults have set them."""

from dataclasses import dataclass

from fakes.faults import FaultBoard


@dataclass(frozen=True, slots=True)
class Panel:
    """What an operator, or the controller itself, can do to a motion."""

    faults: FaultBoard
    by_hand: bool = False
    """Somebody jogs the arm."""

    @property
    def emergency_stop(self) -> bool:
        """The button is pressed."""
        return self.faults.active("emergency_stop") is not None

    @property
    def mode(self) -> str:
        """MAN, AUT or REM."""
        if self.by_hand or self.faults.active("manual_mode"):
            return "MAN"
        return "AUT" if self.faults.active("automatic_mode") else "REM"

    @property
    def drives(self) -> bool:
        """The drives have power."""
        return not (self.emergency_stop or self.faults.active("drives_off"))

    @property
    def error_code(self) -> int:
        """The vendor's error number."""
        fault = self.faults.active("vendor_error")
        return int(fault.number("code", 4001)) if fault else 0
