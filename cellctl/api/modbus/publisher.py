"""Keeps the status that the line PLC reads up to date."""

from collections.abc import Callable

from cellctl.runtime.cell_status import CellStatus
from cellctl.runtime.unit import UnitController


class StatusPublisher:
    """Publishes a snapshot at every change of state and every fault, and whenever it is told to.

    Values that change without an event, such as forces and remaining validity, need a caller that
    publishes periodically.
    """

    def __init__(self, unit: UnitController, show: Callable[[CellStatus], None]) -> None:
        """``show`` is ``PlcInterface.publish``."""
        self._unit = unit
        self._show = show
        unit.machine.on_change.append(lambda _before, _after: self.publish())
        unit.machine.on_fault.append(lambda _error: self.publish())

    def publish(self) -> None:
        """Show what is going on now."""
        unit = self._unit
        self._show(unit.view.snapshot(unit.jobs.shown, unit.jobs.shown_result, unit.parts))
