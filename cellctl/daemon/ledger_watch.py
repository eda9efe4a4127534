"""Watches that the ledger still has what it had: only a running daemon remembers that."""

from cellctl import log
from cellctl.errors.records.store import RecordAltered, RecordsError
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.seals import LedgerHead
from cellctl.records.store import RunStore
from cellctl.runtime.unit import UnitController

_log = log.get(__name__)


class LedgerWatch:
    """Reports a ledger from which entries were removed, or that was made anew, once each time."""

    def __init__(self, store: AsyncRunStore, unit: UnitController) -> None:
        self._store = store
        self._unit = unit
        self._seen: LedgerHead | None = None

    async def look(self) -> None:
        """Hold the ledger against the head of the last look; the first head goes to the journal."""
        try:
            if self._seen is None:
                _log.info("ledger", head=str(await self._store.do(RunStore.ledger_head)))
            self._seen = await self._store.do(RunStore.ledger_since, self._seen)
        except RecordAltered as fault:
            self._seen = None
            await self._unit.machine.fail(fault)
        except RecordsError:
            return  # a store that cannot be read is told by what needs it
