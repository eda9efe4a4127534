"""Watches panels and latches of the robots while nothing moves: a move finds out itself."""

from collections.abc import Mapping
from dataclasses import replace

from cellctl.cell.devices import LINK_AGE_S, Cell
from cellctl.cell.readiness import why_not_ready
from cellctl.errors import CellError
from cellctl.errors.robot import ControllerFault, NotRearmed, RobotNotReady
from cellctl.interfaces import RobotState
from cellctl.packml.mode import Mode
from cellctl.packml.state import State
from cellctl.runtime.unit import UnitController

PANEL_PERIOD_S = 0.05
"""Pause between two looks. Controllers report every 20 ms, and an emergency stop whose contacts
open for 0.1 s is seen. Reading a report takes 0.4 ms of the processor, but in a run the recorder of
the motion has every report read anyway; without a run nobody looks."""

_MOVES_NEXT = frozenset(
    {State.RESETTING, State.STARTING, State.EXECUTE, State.UNHOLDING, State.UNSUSPENDING}
)
"""States in which the next move may come at any time."""
_PARKED = frozenset({State.HOLDING, State.HELD, State.SUSPENDING, State.SUSPENDED})
"""States in which a run is open, and somebody may jog an arm before the unit goes on."""


class PanelWatch:
    """Reports what is wrong with an arm that stands: once, and one look after it was found."""

    def __init__(self, cell: Cell, unit: UnitController) -> None:
        self._cell = cell
        self._unit = unit
        self._found: Mapping[str, CellError] = {}
        self._released: set[str] = set()
        """Arms that were seen without a latch since something may move: a Reset begins with those
        that it will release."""

    async def look(self) -> None:
        """Look at every arm; what the last look found goes to the machine.

        One look later, so that a motion which the panel has ended has told its own end first, with
        its reason. It is told too when the button is released by then.
        """
        if self._unit.machine.state not in _MOVES_NEXT | _PARKED:
            self._found, self._released = {}, set()
            return
        told, self._found = self._found, self._look()
        for name, fault in told.items():
            # A touch latches robot and guard, whose reports come one after the other. A latch that
            # looked for one look as if nobody had asked for it may be that of a touch; one that
            # still does is not.
            if name in self._found or not isinstance(fault, NotRearmed):
                await self._unit.machine.fail(fault)

    def _look(self) -> Mapping[str, CellError]:
        faults = {}
        for name, robot in self._cell.robots.items():
            try:
                state = robot.state(LINK_AGE_S)
            except CellError:
                continue  # the watch over the links tells it
            fault = None if state.moving else self._fault(name, state)
            if fault is not None:
                faults[name] = fault
        return faults

    def _fault(self, name: str, state: RobotState) -> CellError | None:
        machine = self._unit.machine
        # Procedures wait for people who jog an arm, and so may whoever holds a run: then key,
        # drives and errors of the arm belong to whoever stands at its panel.
        by_itself = machine.state in _MOVES_NEXT and machine.mode is Mode.PRODUCTION
        # A latch belongs to whoever asked for it: every touch that the guard finds sets one.
        reasons = why_not_ready(replace(state, stop_latched=False))
        if state.emergency_stop or (by_itself and reasons):
            kind = ControllerFault if state.error_code else RobotNotReady
            return kind(f"{name}, while it stood: {', '.join(reasons)}")
        if not state.stop_latched:
            self._released.add(name)
        elif self._stopped_by_guard(name):
            # Whoever goes on after a touch releases the guard first and then the arm.
            self._released.discard(name)
        elif state.unasked_latch and name in self._released:
            return NotRearmed(f"{name}, while it stood: {state.unasked_latch}")
        return None

    def _stopped_by_guard(self, robot: str) -> bool:
        sensors = self._cell.config.force_sensors
        return any(
            guard.trip is not None
            for name, guard in self._cell.guards.items()
            if sensors[name].mounted_on == robot
        )
