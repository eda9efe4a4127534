"""Child processes of the demonstration: started in order, ended in reverse, never left behind."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from queue import Empty, Queue
from types import FrameType, TracebackType
from typing import Any, Self

START_TIMEOUT_S = 60.0
_CROWDED = 2.0
"""Programs for each processor from which on a late start is no surprise; with a processor of its
own the daemon starts in two seconds."""
STOP_TIMEOUT_S = 30.0
"""The daemon stops robots that may be moving, and closes its run."""
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class ChildFailed(RuntimeError):
    """A child ended or did not become ready."""


@dataclass(slots=True)
class Child:
    """One process whose standard output is lines of JSON; its log goes to a file."""

    name: str
    process: subprocess.Popen[str]
    lines: "Queue[dict[str, Any] | None]"
    log: Path
    _asked_to: int = 0
    """Bytes of the log in which ``new_faults`` has looked."""

    @classmethod
    def start(cls, name: str, command: list[str], log: Path) -> "Child":
        """Start in a process group of its own, so that Ctrl-C reaches only the parent."""
        with log.open("w", encoding="utf-8") as stderr:
            process = subprocess.Popen(
                [sys.executable, "-P", *command],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=stderr,
                text=True,
                # Where the kernel shares processors by session (autogroup, sched(7)), the other
                # programs of this terminal together weigh as much as this child alone.
                start_new_session=True,
                env=os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
            )
        child = cls(name, process, Queue(), log)
        # Read all the time: a pipe that nobody empties fills up, and the child would stand still in
        # its next print.
        threading.Thread(target=child._read, daemon=True).start()
        return child

    def _read(self) -> None:
        assert self.process.stdout is not None
        with self.process.stdout as lines:
            for line in lines:
                try:
                    message = json.loads(line)
                except ValueError:
                    # Libraries print, too; a line that is no JSON must not end the reading.
                    message = {"text": line.rstrip()}
                self.lines.put(message if isinstance(message, dict) else {"text": message})
        self.lines.put(None)

    def next_line(self, timeout_s: float | None) -> dict[str, Any] | None:
        """The next message, or None when the child has ended; ``queue.Empty`` after a time-out."""
        return self.lines.get(timeout=timeout_s)

    def wait_ready(self, timeout_s: float = START_TIMEOUT_S) -> dict[str, Any]:
        """The message with ``ready``; raises ``ChildFailed`` with the child's own words."""
        while True:
            try:
                message = self.next_line(timeout_s)
            except Empty:
                raise ChildFailed(self._late(timeout_s, os.getloadavg()[0])) from None
            if message is None:
                raise ChildFailed(f"{self.name} did not start:\n{self.last_words()}")
            if message.get("ready"):
                return message
            if "error" in message:
                raise ChildFailed(f"{self.name} did not start: {message['error']}")

    def _late(self, timeout_s: float, load: float) -> str:
        """Why a child is not ready, as far as this computer tells."""
        there = os.cpu_count() or 1
        text = f"{self.name} is not ready after {timeout_s:.0f} s; its log is {self.log}"
        if load < _CROWDED * there:
            return text
        return (
            f"{text}\nthis computer was too slow: in the last minute {load:.0f} programs on "
            f"average wanted its {there} processors. End other programs, and run it again"
        )

    def last_words(self, lines: int = 12) -> str:
        """The end of the child's log that was meant for people, else of all of it."""
        log = self.log.read_text(encoding="utf-8").splitlines()
        words = [line for line in log if not line.startswith("{")]
        return "\n".join((words or log)[-lines:])

    def faults(self) -> list[str]:
        """Every numbered fault in the log, once, with its remedy."""
        return _faults(self._entries())

    def new_faults(self) -> list[str]:
        """The same of what the log has gained since this was asked last."""
        with self.log.open("rb") as log:
            log.seek(self._asked_to)
            # What follows the last line is the beginning of one that is being written.
            whole = log.read().rpartition(b"\n")[0]
        self._asked_to += len(whole)
        return _faults(_entries_of(whole.decode()))

    def logged(self, event: str) -> dict[str, Any] | None:
        """The last entry of the log with this event."""
        return next((e for e in reversed(self._entries()) if e.get("event") == event), None)

    def _entries(self) -> list[dict[str, Any]]:
        return _entries_of(self.log.read_text(encoding="utf-8"))

    def stop(self) -> None:
        """Ask the child to end; after a time-out kill its whole group."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.process.wait(STOP_TIMEOUT_S)
        with contextlib.suppress(ProcessLookupError):
            # The group: whatever the child has started and left behind goes with it.
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait(STOP_TIMEOUT_S)


def _faults(entries: Iterable[dict[str, Any]]) -> list[str]:
    found: dict[str, None] = {}
    for entry in entries:
        if "number" in entry and "fault" in entry:
            remedy = f"\n  remedy: {entry['remedy']}" if entry.get("remedy") else ""
            found[f"{entry['fault']}{remedy}"] = None
    return list(found)


def _entries_of(text: str) -> list[dict[str, Any]]:
    return [entry for line in text.splitlines() if (entry := _entry(line)) is not None]


def _entry(line: str) -> dict[str, Any] | None:
    """A line of a JSON log; None for anything else."""
    try:
        entry = json.loads(line)
    except ValueError:
        return None
    return entry if isinstance(entry, dict) else None


class Family:
    """Children end in reverse order, whatever happens.

    Inside, the signals that end a program raise ``KeyboardInterrupt``, but not while a child is
    being started or ended: none is ever forgotten.
    """

    def __init__(self) -> None:
        self.children: list[Child] = []
        self._held = False
        self._pending = False

    def spawn(self, name: str, command: list[str], log: Path) -> Child:
        """Start a child."""
        with self._signals_held():
            child = Child.start(name, command, log)
            self.children.append(child)
        return child

    def __enter__(self) -> Self:
        self._before = {number: signal.signal(number, self._take) for number in SIGNALS}
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._held = True
        for child in reversed(self.children):
            child.stop()
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _take(self, _number: int, _frame: FrameType | None) -> None:
        if self._held:
            self._pending = True
        else:
            raise KeyboardInterrupt

    @contextlib.contextmanager
    def _signals_held(self) -> Iterator[None]:
        self._held = True
        try:
            yield
        finally:
            self._held = False
        if self._pending:
            raise KeyboardInterrupt
