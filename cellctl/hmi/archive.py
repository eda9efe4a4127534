"""Reads the run store for the page, in threads; never writes to it."""

import asyncio
from collections.abc import Callable
from contextlib import closing
from dataclasses import asdict
from datetime import datetime
from pathlib import Path
from typing import Any, TypeVar

from cellctl.errors.records.store import StoreUnavailable
from cellctl.records.entered.gauges import PART_VERDICT, judge_gauge, part_verdict
from cellctl.records.entries import Artefact, RunHead
from cellctl.records.figures import on_pages, verdicts
from cellctl.records.outcome import outcome
from cellctl.records.run_filter import RunFilter
from cellctl.records.run_list import ListedRun, listed_runs
from cellctl.records.store import RunStore

T = TypeVar("T")
READERS = 4
ANSWER_S = 10.0
"""A disk that answers within this time is a slow one; after it nobody waits any longer."""


class ArchiveReader:
    """Opens the store for each question, so that a store that is replaced or away is noticed.

    What asks the store raises ``StoreUnavailable`` when there is no answer within ``answer_s``.
    """

    def __init__(self, data_dir: Path, *, answer_s: float = ANSWER_S) -> None:
        self.data_dir = data_dir
        self._answer_s = answer_s
        self._readers = asyncio.Semaphore(READERS)

    async def runs(self, wanted: RunFilter, limit: int) -> list[dict[str, Any]]:
        """Heads of the newest of the wanted runs, newest first; ``ended_as`` in words of lists.

        Raises ``StoreUnavailable``.
        """
        found = await self.listed(wanted, limit)
        return [_plain(one.for_programs()) | {"ended_as": _ended_as(one)} for one in found]

    async def run(self, number: int) -> dict[str, Any]:
        """One run with figures, passes, phases, alarms, gauges and names of its files.

        Figures in the units of the report, as they stand beside it: mm, degrees, N/mm.
        Raises ``RunUnknown`` or ``StoreUnavailable``.
        """

        def read(store: RunStore) -> dict[str, Any]:
            record = store.run(number)
            said = verdicts(record.newest_figures)
            gauges = [
                _plain(asdict(gauge))
                | {"verdict": str(judge_gauge(record, gauge)), "counts": gauge in record.gauges}
                for gauge in record.gauge_history
            ]
            return {
                "head": _head(record.head),
                PART_VERDICT: part_verdict(record),
                "figures": [
                    _plain(asdict(on_pages(one))) | {"verdict": said.get(one.key)}
                    for one in record.newest_figures.values()
                ],
                "passes": [_plain(asdict(one)) for one in record.passes],
                "phases": [_plain(asdict(one)) for one in record.phases],
                "alarms": [_plain(asdict(one)) for one in record.alarms],
                "gauges": gauges,
                "files": [_plain(asdict(one)) for one in record.artefacts],
                "sealed": record.seal is not None,
                "as_sealed": store.is_as_sealed(number) if record.head.result else None,
            }

        return await self.ask(read)

    async def file(self, number: int, name: str) -> tuple[Artefact, bytes] | None:
        """A file of a run, checked against its hash; None when the run has none of this name.

        Raises ``RunUnknown``, ``ArtefactDamaged`` or ``StoreUnavailable``.
        """

        def read(store: RunStore) -> tuple[Artefact, bytes] | None:
            files = [one for one in store.run(number).artefacts if one.name == name]
            return (files[-1], store.artefacts.get(files[-1].sha256)) if files else None

        return await self.ask(read)

    async def audit(self, limit: int) -> list[dict[str, Any]]:
        """The newest entries of the audit log, newest first; raises ``StoreUnavailable``."""
        found = await self.ask(lambda store: store.newest_audit(limit))
        return [_plain(asdict(one)) for one in found]

    async def listed(self, wanted: RunFilter, limit: int) -> list[ListedRun]:
        """The newest of the wanted runs, newest first; raises ``StoreUnavailable``."""
        return await self._in_thread(lambda: listed_runs(self.data_dir, limit, wanted))

    async def ask(self, read: Callable[[RunStore], T]) -> T:
        """What ``read`` finds in the store; raises what it raises, and ``StoreUnavailable``."""

        def work() -> T:
            # Never created by a reader: an empty store in the place of one that is not mounted
            # would look like a cell that has done nothing.
            with closing(RunStore(self.data_dir, create=False)) as store:
                return read(store)

        return await self._in_thread(work)

    async def _in_thread(self, work: Callable[[], T]) -> T:
        try:
            async with asyncio.timeout(self._answer_s):
                await self._readers.acquire()
                reading = asyncio.ensure_future(asyncio.to_thread(work))
                # A thread that a disk holds is a reader until it comes back: others in its place
                # would take the threads that signing in needs.
                reading.add_done_callback(self._ended)
                return await asyncio.shield(reading)
        except TimeoutError:
            where = f"{self.data_dir}: no answer within {self._answer_s:g} s"
            raise StoreUnavailable(where) from None

    def _ended(self, reading: "asyncio.Future[Any]") -> None:
        self._readers.release()
        # Nobody may wait any more for what went wrong.
        if not reading.cancelled():
            reading.exception()


def _ended_as(run: ListedRun) -> str:
    return outcome(run.head.mode, run.head.result, spoilt=run.spoilt)


def _head(head: RunHead) -> dict[str, Any]:
    return _plain(asdict(head))


def _plain(fields: dict[str, Any]) -> dict[str, Any]:
    """Times as text; all other values are JSON already."""
    return {
        name: value.isoformat(timespec="milliseconds") if isinstance(value, datetime) else value
        for name, value in fields.items()
    }
