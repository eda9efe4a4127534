"""Polls cameras, trackers and vision workers while no run is active: they report nothing."""

from cellctl.cell.devices import Cell
from cellctl.errors.internal import WorkerDied, WorkerSilent
from cellctl.errors.link import DeviceAway
from cellctl.runtime.unit import AT_REST, UnitController


class DevicePoller:
    """Reports each of them once when it stops answering. In a run the steps find out themselves."""

    def __init__(self, cell: Cell, unit: UnitController) -> None:
        self._cell = cell
        self._unit = unit
        self._away: set[str] = set()
        self._worker_died = False

    async def ask(self) -> None:
        """One round; a head that is away refuses Start, a dead or silent worker aborts."""
        if not self._unit.live:
            # Clear connects everything anew, so what is away after it is news.
            self._away.clear()
            return
        if self._unit.machine.state not in AT_REST:
            return
        await self._ask_workers()
        await self._cell.ask_silent_devices()
        unanswered = self._cell.unanswered
        for name, fault in unanswered.items():
            if name not in self._away:
                await self._unit.machine.fail(DeviceAway(f"{name}: {fault}"))
        self._away = set(unanswered)

    async def _ask_workers(self) -> None:
        known = self._worker_died
        try:
            await self._cell.workers.check()
        except (WorkerDied, WorkerSilent) as fault:
            self._worker_died = True
            if not known:
                await self._unit.machine.fail(fault)
        else:
            self._worker_died = False
