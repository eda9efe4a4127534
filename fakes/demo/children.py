"""Child processes of the demonstration: started in order, ended in reverse, never left behind."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from queue import Empty, Queue
from typing import Any

START_TIMEOUT_S = 60.0
STOP_TIMEOUT_S = 15.0


class ChildFailed(RuntimeError):
    """A child ended or did not become ready."""


@dataclass(slots=True)
class Child:
    """One process whose standard output is lines of JSON; its log goes to a file."""

    name: str
    process: subprocess.Popen[str]
    lines: "Queue[dict[str, Any] | None]"
    log: Path

    @classmethod
    def start(cls, name: str, command: list[str], log: Path) -> "Child":
        """Start in a process group of its own, so that Ctrl-C reaches only the parent."""
        with log.open("w", encoding="utf-8") as stderr:
            process = subprocess.Popen(
                [sys.executable, *command],
                stdout=subprocess.PIPE,
                stderr=stderr,
                text=True,
                start_new_session=True,
                env=os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
            )
        child = cls(name, process, Queue(), log)
        threading.Thread(target=child._read, daemon=True).start()
        return child

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            try:
                message = json.loads(line)
            except ValueError:
                message = {"text": line.rstrip()}
            self.lines.put(message if isinstance(message, dict) else {"text": message})
        self.lines.put(None)

    def next_line(self, timeout_s: float | None) -> dict[str, Any] | None:
        """The next message, or None when the child has ended; ``queue.Empty`` after a time-out."""
        return self.lines.get(timeout=timeout_s)

    def wait_ready(self, timeout_s: float = START_TIMEOUT_S) -> dict[str, Any]:
        """The message with ``ready``; raises ``ChildFailed`` with the end of the log otherwise."""
        while True:
            try:
                message = self.next_line(timeout_s)
            except Empty:
                raise ChildFailed(f"{self.name} is not ready after {timeout_s:.0f} s") from None
            if message is None:
                raise ChildFailed(f"{self.name} ended before it was ready:\n{self.log_tail()}")
            if message.get("ready"):
                return message

    def log_tail(self, lines: int = 12) -> str:
        """The end of the child's log, for a message to the user."""
        return "\n".join(self.log.read_text(encoding="utf-8").splitlines()[-lines:])

    def faults(self) -> list[str]:
        """Every numbered fault in the log, once, with its remedy."""
        found: dict[str, None] = {}
        for line in self.log.read_text(encoding="utf-8").splitlines():
            try:
                entry = json.loads(line)
            except ValueError:
                continue
            if "number" in entry and "fault" in entry:
                found[f"{entry['fault']}\n  remedy: {entry.get('remedy', '')}"] = None
        return list(found)

    def stop(self) -> None:
        """Ask the child to end; after a time-out kill its whole group."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(STOP_TIMEOUT_S)
            except subprocess.TimeoutExpired:
                self._kill_group()
        self._kill_group()

    def _kill_group(self) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait(STOP_TIMEOUT_S)


@contextlib.contextmanager
def family() -> Iterator[list[Child]]:
    """Children appended to the list end in reverse order, whatever happens."""
    children: list[Child] = []
    try:
        yield children
    finally:
        for child in reversed(children):
            child.stop()
