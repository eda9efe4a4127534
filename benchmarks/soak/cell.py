"""The cell that is soaked: fake cell, daemon with its children and the page, cycle after cycle."""

import os
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Self

from benchmarks.soak.trend import Looked
from tests.rigs.kept import Kept, kept
from tests.rigs.whole_cell.outside_plc import REJECTS, OutsidePlc
from tests.rigs.whole_cell.own_cell import OwnCell, Program

CYCLE_S = "900"
"""Time for one part on a computer that others share."""
RESET_S = 120.0
_GUARD, _WORKER = "cellctl.guard.watch.main", "spawn_main"


class Died(RuntimeError):
    """A process of the cell has ended or was exchanged while it was looked at."""


@dataclass(frozen=True, slots=True)
class Cycle:
    """One part."""

    time_s: float
    """Time of its end, since the first began."""
    good: bool
    said: str
    """The line PLC's last words where it was not good."""


@dataclass
class SoakedCell:
    """Programs that run, and what they kept so far."""

    own: OwnCell
    daemon: Program
    page: Program
    cycles: list[Cycle] = field(default_factory=list)
    _serials: int = 0
    """Serial numbers given so far."""
    _kept: dict[str, list[Kept]] = field(default_factory=dict)
    _pids: dict[str, int] = field(default_factory=dict)

    @classmethod
    def start(cls, folder: Path, *, page_settings: Path | None = None) -> Self:
        """Everything of a cell's PC, and the fake cell beside it."""
        own = OwnCell.make(folder)
        own.fake().ready()
        daemon = own.daemon()
        daemon.ready()
        page = own.page(page_settings)
        page.ready()
        return cls(own, daemon, page)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.own.kill_all()

    def run(self, minutes: float, told: Callable[[Cycle], object]) -> list[Looked]:
        """Cycles until the time is over; raises ``Died``."""
        begun_s = time.monotonic()
        while time.monotonic() - begun_s < 60.0 * minutes:
            good, said = self.part()
            self._look()
            self.cycles.append(Cycle(time.monotonic() - begun_s, good, said))
            told(self.cycles[-1])
        times_s = [cycle.time_s for cycle in self.cycles]
        return [Looked(name, times_s, found) for name, found in self._kept.items()]

    def new_serial(self) -> str:
        """A serial number that no part of this cell has, whoever has them made."""
        self._serials += 1
        return f"SAT-{self._serials:04d}"

    def part(self) -> tuple[bool, str]:
        """Make a part: whether it is good, and else what the line said."""
        with OutsidePlc(self.own.modbus_port) as line:
            line.start_heartbeat()
            line.seq = line.value("ack_seq")
            # The arm that has mated a deck presses on it until Reset lifts it off. New parts put
            # below it before would be pressed, too.
            _bring_to_idle(line)
        with self.own.control() as control:
            control.request("load")
        plc = self.own.plc("--serial", self.new_serial(), "--timeout", CYCLE_S)
        good = plc.end(float(CYCLE_S) + 60.0) == 0
        said = "" if good else (plc.stdout + plc.stderr)[-400:]
        self.own.programs.remove(plc)
        return good, said

    def _look(self) -> None:
        # The workers are looked up here because the daemon starts them with the first images.
        if not self._pids:
            self._pids = processes(self.daemon, self.page)
        for name, pid in self._pids.items():
            try:
                found = kept(pid)
            except OSError as error:
                raise Died(f"{name} (process {pid}) is gone: {error}") from error
            self._kept.setdefault(name, []).append(found)


def _bring_to_idle(line: OutsidePlc) -> None:
    """Bring the cell to Idle by the line's commands; ``Died`` when the cell refuses them."""
    for state, name in (("Aborted", "Clear"), ("Stopped", "Reset"), ("Completed", "Reset")):
        if line.state != state:
            continue
        code = line.command(name)
        said = REJECTS[code] if code else line.done(RESET_S)
        if line.state == state:
            raise Died(f"the cell stays in {state} after {name}: {said}")


def processes(daemon: Program, page: Program) -> dict[str, int]:
    """The processes of a cell's PC by name; raises ``Died`` where there is no guard or worker."""
    found = {"daemon": daemon.process.pid, "page": page.process.pid}
    for pid, command in sorted(daemon.descendants().items()):
        if _GUARD in command:
            found[_numbered("guard", found)] = pid
        # The command line of a child that multiprocessing has made says no more than this.
        elif _WORKER in command and _parent(pid) == daemon.process.pid:
            found[_numbered("worker", found)] = pid
    missing = [kind for kind in ("guard", "worker") if f"{kind} 1" not in found]
    if missing:
        raise Died(f"the daemon has no {' and no '.join(missing)}")
    return found


def _numbered(name: str, taken: dict[str, int]) -> str:
    return f"{name} {1 + sum(one.startswith(name) for one in taken)}"


def _parent(pid: int) -> int:
    stat = Path(f"/proc/{pid}/stat").read_text(encoding="ascii", errors="replace")
    # The name before it is in brackets and may have spaces.
    return int(stat.rpartition(")")[2].split()[1])


def processors() -> int:
    """That this program may use."""
    return len(os.sched_getaffinity(0))
