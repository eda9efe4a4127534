"""What the daemon watches all the time: its own life, links, guard, line, disk, systemd."""

import asyncio
from functools import partial

from cellctl.api.modbus.interface import PlcInterface
from cellctl.api.modbus.publisher import StatusPublisher
from cellctl.cell.devices import Cell
from cellctl.command.arrivals import ArrivalClock
from cellctl.daemon.device_poller import DevicePoller
from cellctl.daemon.disk_watch import DiskWatch
from cellctl.daemon.ledger_watch import LedgerWatch
from cellctl.daemon.loop_watch import watch_loop
from cellctl.daemon.notify import Watchdog
from cellctl.daemon.panel_watch import PANEL_PERIOD_S, PanelWatch
from cellctl.daemon.vitals import DaemonVitals
from cellctl.errors import CellError
from cellctl.errors.force import GuardNotRealTime
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.records.async_store import AsyncRunStore
from cellctl.runtime.unit import UnitController

PUBLISH_PERIOD_S = 0.1
"""Registers, page and recording get what has changed ten times a second. A change of state does not
wait for that: it is shown at once."""
TURN_PERIOD_S = 0.1
"""A tenth of the turn after which commands count as waiting."""
LINK_PERIOD_S = 0.25
"""A robot counts as silent after 1 s and a guard after 1 s: a quarter of that is added at most."""
ASK_PERIOD_S = 2.0
"""A question occupies a camera for as long as its answer takes, and it is asked only at rest."""
DISK_PERIOD_S = 2.0
"""Each look in a run writes once and waits for the disk; between runs it asks for room."""
LEDGER_PERIOD_S = 10.0
"""A look reads two rows of the store. Whoever cuts the ledger and lets the daemon go on is found
before the next report is printed."""


async def supervise(
    cell: Cell,
    unit: UnitController,
    plc: PlcInterface,
    publisher: StatusPublisher,
    store: AsyncRunStore,
    *,
    vitals: DaemonVitals,
    arrivals: ArrivalClock,
) -> None:
    """Run until cancelled; ends with an exception when a part of the daemon itself dies."""
    beat = partial(_beat, plc, Watchdog())
    async with asyncio.TaskGroup() as tasks:
        tasks.create_task(unit.machine.beat_while_alive(beat))
        # The line would only see its heartbeat freeze, and not why.
        tasks.create_task(plc.failed())
        tasks.create_task(_publish(publisher))
        tasks.create_task(_watch_links(cell, unit))
        tasks.create_task(_watch_panels(PanelWatch(cell, unit)))
        tasks.create_task(_poll_devices(cell, unit))
        tasks.create_task(_watch_disk(DiskWatch(store, unit)))
        tasks.create_task(_watch_ledger(LedgerWatch(store, unit)))
        tasks.create_task(watch_loop(vitals.turn))
        tasks.create_task(_tell_turns(arrivals))


def _beat(plc: PlcInterface, watchdog: Watchdog) -> None:
    """The machine has taken a turn: it lives, so does the daemon for systemd."""
    plc.beat()
    watchdog.feed()


async def _tell_turns(arrivals: ArrivalClock) -> None:
    while True:
        arrivals.turn()
        await asyncio.sleep(TURN_PERIOD_S)


async def _publish(publisher: StatusPublisher) -> None:
    while True:
        publisher.publish()
        await asyncio.sleep(PUBLISH_PERIOD_S)


async def _watch_links(cell: Cell, unit: UnitController) -> None:
    watch = LinkMonitor(cell, unit)
    while True:
        await watch.look()
        await asyncio.sleep(LINK_PERIOD_S)


async def _watch_panels(watch: PanelWatch) -> None:
    while True:
        await watch.look()
        await asyncio.sleep(PANEL_PERIOD_S)


async def _poll_devices(cell: Cell, unit: UnitController) -> None:
    poller = DevicePoller(cell, unit)
    while True:
        await poller.ask()
        await asyncio.sleep(ASK_PERIOD_S)


async def _watch_disk(watch: DiskWatch) -> None:
    while True:
        await watch.look()
        await asyncio.sleep(DISK_PERIOD_S)


async def _watch_ledger(watch: LedgerWatch) -> None:
    while True:
        await watch.look()
        await asyncio.sleep(LEDGER_PERIOD_S)


class LinkMonitor:
    """Reports each broken link once, and again only after it has been whole in between."""

    def __init__(self, cell: Cell, unit: UnitController) -> None:
        self._cell = cell
        self._unit = unit
        self._broken: set[str] = set()
        self._trips: dict[str, GuardTrip | None] = {}
        self._degraded: dict[str, tuple[str, ...]] = {}

    async def look(self) -> None:
        """Look at every device once; its fault goes to the machine.

        Devices that were never reached are the matter of Clear.
        """
        if not self._unit.live:
            # Clear connects everything anew, so what is broken after it is news.
            self._broken.clear()
            return
        for name, check in self._cell.health_checks().items():
            try:
                check()
            except CellError as error:
                if name not in self._broken:
                    self._broken.add(name)
                    await self._unit.machine.fail(error)
            else:
                self._broken.discard(name)
        for incident in self._cell.incidents():
            await self._unit.machine.fail(incident)
        for name, guard in self._cell.guards.items():
            await self._look_at_trip(name, guard.trip)
            await self._look_at_real_time(name, guard.health().degraded)

    async def _look_at_trip(self, name: str, trip: GuardTrip | None) -> None:
        """A trip that no step waits for is a fault; the guard's death is one of the above."""
        known, self._trips[name] = self._trips.get(name), trip
        # By identity: the client keeps one object for as long as a trip is latched, and a second
        # trip with the same figures is a second event.
        if trip is None or trip is known or trip.reason is TripReason.GUARD_DIED:
            return
        if not self._unit.awaits_trips(name):
            await self._unit.machine.fail(trip.fault())

    async def _look_at_real_time(self, name: str, degraded: tuple[str, ...]) -> None:
        """A guard that may be late is an alarm, and no reason to stop.

        Not in a simulated cell: it is at home on PCs without these rights, and protects nothing.
        """
        known, self._degraded[name] = self._degraded.get(name, ()), degraded
        if degraded and degraded != known and not self._cell.config.simulated:
            await self._unit.machine.fail(GuardNotRealTime(f"{name}: {'; '.join(degraded)}"))
