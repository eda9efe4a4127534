"""What the daemon watches all the time: the machine's own life, links, guard, line, systemd."""

import asyncio

from cellctl.cell.devices import Cell
from cellctl.daemon.notify import notify, watchdog_interval_s
from cellctl.daemon.unit import Unit
from cellctl.errors import CellError
from cellctl.plc.port import PlcPort

PUBLISH_PERIOD_S = 0.1
LINK_PERIOD_S = 0.25


async def supervise(cell: Cell, unit: Unit, port: PlcPort) -> None:
    """Run until cancelled; ends with an exception when a part of the daemon itself dies."""
    async with asyncio.TaskGroup() as tasks:
        tasks.create_task(unit.machine.beat_while_alive(lambda: _beat(port)))
        tasks.create_task(port.failed())
        tasks.create_task(_publish(unit))
        tasks.create_task(_watch_links(cell, unit))
        tasks.create_task(_watchdog())


def _beat(port: PlcPort) -> None:
    port.beat()


async def _publish(unit: Unit) -> None:
    while True:
        unit.publish()
        await asyncio.sleep(PUBLISH_PERIOD_S)


async def _watch_links(cell: Cell, unit: Unit) -> None:
    """Report each broken link once, and again only after it has been whole in between."""
    broken: set[str] = set()
    while True:
        for name, check in cell.health_checks().items():
            try:
                check()
            except CellError as error:
                if name not in broken:
                    broken.add(name)
                    await unit.machine.fail(error)
            else:
                broken.discard(name)
        await asyncio.sleep(LINK_PERIOD_S)


async def _watchdog() -> None:
    interval_s = watchdog_interval_s()
    while interval_s is not None:
        notify("WATCHDOG=1")
        await asyncio.sleep(interval_s)
