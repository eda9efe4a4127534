"""The cell on which the faults are tried: fake cell, daemon, and the line PLC that watches it."""

import os
import resource
import signal
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from pymodbus.exceptions import ModbusException

from benchmarks.faults.daemon import CLOCK_FILE
from benchmarks.faults.line import Shown, WatchingPlc
from cellctl.records.store import RunStore
from fakes.demo.control import Control
from tests.rigs.whole_cell.own_cell import OwnCell, Program

LINE_FAILURES = (ModbusException, AssertionError, OSError)
"""How the daemon's silence looks from the line; ``OutsidePlc`` asserts every answer."""
ARMS = ("main", "aux_1", "aux_2")
DEVICES = (*ARMS, "force", "head_1", "head_2", "tracker", "world")
POLL_S = 0.03
PROCESSES_S = 20.0
"""How long a process of the daemon is waited for that is to be killed or suspended."""
BOTH_WORKERS_S = 1.0
"""How long the second of two vision workers is waited for."""
RESTING = frozenset({"Aborted", "Stopped", "Held", "Completed", "Idle"})
OVER = RESTING - {"Idle"}
"""A job that is found in one of these has ended."""
_LEADS_ON = {"Aborted": "Clear", "Stopped": "Reset", "Completed": "Reset", "Held": "Stop"}


class NotReached(RuntimeError):
    """The cell did not get where a trial begins."""


class FaultCell(OwnCell):
    """Its daemon has a clock that can be set back."""

    def daemon(self, *, data: Path | None = None) -> Program:
        arguments = ["run", str(self.cell), "--data-dir", str(data or self.data)]
        return self._start("benchmarks.faults.daemon", *arguments)


class Bench:
    """Running; ``close`` ends everything."""

    def __init__(self, folder: Path, seed: int) -> None:
        folder = folder.resolve()  # paths in a cell file count from where that file lies
        folder.mkdir(parents=True, exist_ok=True)
        self._clock = folder / "clock-offset-s"
        self._clock.unlink(missing_ok=True)
        os.environ[CLOCK_FILE] = str(self._clock)
        self.own = FaultCell.make(folder)
        # A coarse loop is soon where the deck is mated; what stops it is the same.
        self.own.change("threshold_mm = 0.05", "threshold_mm = 0.15\nframes = 1")
        self.own.change("threshold_deg = 0.006", "threshold_deg = 0.05")
        self.fresh = True
        """Nothing has moved yet."""
        try:
            ports = self.own.fake(seed).ready()["ports"]
            self.control = Control(int(ports["control"]))
            self._start_daemon()
        except BaseException:
            self.own.kill_all()
            raise

    def close(self) -> None:
        """End all programs. Idempotent."""
        with suppress(*LINE_FAILURES):
            self.plc.__exit__(None, None, None)
        self.control.close()
        self.own.kill_all()

    # -- programs -------------------------------------------------------------------------------
    def _start_daemon(self) -> None:
        self.daemon = self.own.daemon()
        self.daemon.ready()
        self.connect_plc()

    def restart_daemon(self) -> None:
        """End the daemon, however it fares, and start another one on the same store."""
        with suppress(*LINE_FAILURES):
            self.plc.__exit__(None, None, None)
        self.daemon.kill()
        self._start_daemon()

    def connect_plc(self) -> None:
        """A PLC that has just been switched on: its first number may be ignored."""
        self.plc = WatchingPlc(self.own.modbus_port)
        self.plc.__enter__()
        self.plc.seq = self.plc.value("ack_seq")
        self.plc.start_heartbeat()
        self.plc.command(0, mode=1)

    def signal(self, whom: str, number: signal.Signals) -> None:
        """Send a signal to the daemon alone, to its guards, or to its vision workers."""
        if whom == "daemon":
            self.daemon.process.send_signal(number)
            return
        for pid in self._guards() if whom == "guard" else self._workers():
            with suppress(ProcessLookupError):
                os.kill(pid, number)

    def _guards(self) -> list[int]:
        found = self._processes("cellctl.guard", 1, PROCESSES_S)
        if not found:
            raise NotReached("the daemon has no guard")
        return found

    def _workers(self) -> list[int]:
        # Each is started when there is work for it, those anew that an earlier trial has killed. If
        # only the first is hit, the second does the work of both and nothing is wrong with the run.
        if not self._processes("spawn_main", 1, PROCESSES_S):
            raise NotReached("the daemon has no vision worker")
        return self._processes("spawn_main", 2, BOTH_WORKERS_S)

    def _processes(self, word: str, count: int, patience_s: float) -> list[int]:
        """Those of the daemon with the word in their command line, once there are so many."""
        deadline = time.monotonic() + patience_s
        while True:
            found = [pid for pid, line in self.daemon.descendants().items() if word in line]
            if len(found) >= count or time.monotonic() > deadline:
                return found
            time.sleep(POLL_S)

    def fill_disk(self) -> None:
        """No file of the daemon takes another byte: EFBIG, handled as a full disk is."""
        _limit_files(self.daemon.process.pid, 0)

    def free_disk(self) -> None:
        """The daemon may write again."""
        with suppress(ProcessLookupError):
            _limit_files(self.daemon.process.pid, resource.RLIM_INFINITY)

    def set_clock(self, off_s: float) -> None:
        """Set the daemon's time of day off by so much; 0 sets it right."""
        part = self._clock.with_suffix(".part")
        part.write_text(str(off_s), encoding="ascii")
        part.replace(self._clock)  # the daemon must never read half a file

    # -- fake world -----------------------------------------------------------------------------
    def inject(self, device: str, name: str, **parameters: Any) -> None:
        """A fault of the fake cell."""
        self.control.request("inject", device=device, name=name, **parameters)

    def clear_faults(self) -> None:
        """Nothing is wrong with any device any more, nor with the clock and the disk."""
        for device in DEVICES:
            self.control.request("clear", device=device)
        self.set_clock(0.0)
        self.free_disk()

    def next_parts(self) -> None:
        """What the operator puts into the cell between two jobs."""
        self.control.request("remove_boards")
        self.control.request("load")

    def watched(self) -> dict[str, Any]:
        """Motions since the watch began."""
        return self.control.request("watched")

    def moving_arm(self, travelled_mm: float, arms: Sequence[str] = ARMS) -> str | None:
        """One of these arms that is on its way and has come so far, in a turn a degree for each
        3 mm: a stop then has something to stop."""
        for arm in arms:
            motions = self.watched()["motions"][arm]
            last = motions[-1] if motions else None
            if last is None or last["ended_s"] is not None:
                continue
            if max(last["travel_mm"], 3.0 * last["turn_deg"]) >= travelled_mm:
                return arm
        return None

    def truth(self) -> dict[str, Any]:
        """What nobody in the cell knows."""
        truth: dict[str, Any] = self.control.request("truth")["truth"]
        return truth

    # -- line -----------------------------------------------------------------------------------
    def shown(self) -> Shown | None:
        """What the line sees; None while the daemon is silent."""
        try:
            return self.plc.shown()
        except LINE_FAILURES:
            return None

    def until(
        self,
        what: str,
        reached: Callable[[Shown], Any],
        *,
        timeout_s: float = 60.0,
        ends: frozenset[str] = OVER,
    ) -> Shown:
        """Wait until the line sees it; ``NotReached`` when it ends elsewhere or takes too long."""
        deadline = time.monotonic() + timeout_s
        while time.monotonic() < deadline:
            shown = self.plc.shown()
            if reached(shown):
                return shown
            if shown.state in ends:
                raise NotReached(f"{what}: {shown.state} with F{shown.first_out}")
            time.sleep(POLL_S)
        raise NotReached(f"{what}: not in {timeout_s:.0f} s")

    def command(self, name: str, **parameters: Any) -> None:
        """A command that must be taken."""
        code = self.plc.command(name, **parameters)
        if code:
            raise NotReached(f"{name} is refused with 0x{code:X}")

    def to_idle(self, mode: int = 1) -> str:
        """Clear and Reset as an operator would; what was found on the way, in words.

        Raises ``NotReached``.
        """
        words = []
        for _ in range(6):
            shown = self.until("rest", lambda shown: shown.state in RESTING, ends=frozenset())
            words.append(shown.state + (f" F{shown.first_out}" if shown.first_out else ""))
            if shown.state == "Idle":
                return " → ".join(words)
            name = _LEADS_ON[shown.state]
            self.command(name, **({"mode": mode} if name == "Reset" else {}))
            # The time-out covers a slow lift-off and the way home.
            self.plc.done(90)
        raise NotReached(" → ".join(words))

    def acknowledge(self) -> None:
        """All alarms that can be."""
        for alarm in self.plc.shown().alarms:
            self.plc.command(0, alarm=alarm)

    def newest_run(self) -> tuple[int, str | None]:
        """Number and result of the newest record; 0 without any; result None while it is open."""
        store = RunStore(self.own.data, create=False)
        try:
            heads = store.runs(1)
        finally:
            store.close()
        return (heads[0].number, heads[0].result) if heads else (0, None)


def _limit_files(pid: int, size: int) -> None:
    hard = resource.prlimit(pid, resource.RLIMIT_FSIZE)[1]
    resource.prlimit(pid, resource.RLIMIT_FSIZE, (size, hard))
