"""A cell of a test's own: the shipped files with other ports, and the programs a user starts."""

import json
import os
import re
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from shutil import copytree
from typing import Any, Self
from uuid import uuid4

from fakes.demo.control import Control
from fakes.demo.page import write_settings
from fakes.scenes.load import load
from tests.rigs.wire.ports import free_port

ROOT = Path(__file__).parents[3]
CONFIG = ROOT / "config"
_PORTS = re.compile(r"(?:\b\w*port|CMD|STA|GRD|RPC|FRAMES) = (\d{4})\b")
_MARK = "CELLCTL_TEST_FAMILY"
READY_S = 60.0
END_S = 30.0


@dataclass
class OwnCell:
    """Scenario, cell file and run store in a folder; no two of them share a port."""

    folder: Path
    shipped: str = "deck"
    """Name of the shipped files: ``NAME.toml`` and ``NAME.scenario.toml``."""
    ports: dict[int, int] = field(default_factory=dict)
    """Shipped port to own port."""
    programs: list["Program"] = field(default_factory=list)
    pin: str = ""
    """Of both people at the page, once it was started."""

    @classmethod
    def make(cls, folder: Path, shipped: str = "deck") -> Self:
        own = cls(folder, shipped)
        own._write_cell()
        scenario = own._shipped_scenario.read_text(encoding="utf-8")
        own.scenario.write_text(own._renumbered(scenario), encoding="utf-8")
        if like := tomllib.loads(scenario).get("like"):
            below = (CONFIG / like).read_text(encoding="utf-8")
            (folder / like).write_text(own._renumbered(below), encoding="utf-8")
        return own

    def visited_from(self, folder: Path) -> Self:
        """The same fake cell with another cell file and store, and a Modbus port of its own."""
        ports = {**self.ports, self._shipped_modbus_port: free_port(self.ports.values())}
        visitor = type(self)(folder, self.shipped, ports)
        visitor._write_cell()
        return visitor

    def _write_cell(self) -> None:
        text = self._shipped_cell.read_text(encoding="utf-8")
        shipped = str(tomllib.loads(text)["calibration_dir"])
        if (CONFIG / shipped).is_dir():
            copytree(CONFIG / shipped, self.calibration, dirs_exist_ok=True)
        text = text.replace(f'"{shipped}"', f'"{self.calibration}"')
        text = text.replace('"features/', f'"{CONFIG}/features/')
        # They stand beside the cell file, as shipped: a taught correction knows its drawings by
        # these names.
        copytree(CONFIG / "connectors", self.folder / "connectors", dirs_exist_ok=True)
        self.cell.write_text(self._renumbered(text), encoding="utf-8")

    @property
    def _shipped_cell(self) -> Path:
        return CONFIG / f"{self.shipped}.toml"

    @property
    def _shipped_scenario(self) -> Path:
        return CONFIG / f"{self.shipped}.scenario.toml"

    @property
    def _shipped_modbus_port(self) -> int:
        cell = tomllib.loads(self._shipped_cell.read_text(encoding="utf-8"))
        return int(cell["plc"]["port"])

    def _renumbered(self, text: str) -> str:
        def own_port(match: re.Match[str]) -> str:
            port = self.ports.setdefault(int(match[1]), free_port(self.ports.values()))
            return match[0].replace(match[1], str(port))

        return _PORTS.sub(own_port, text)

    @property
    def scenario(self) -> Path:
        return self.folder / "scenario.toml"

    @property
    def cell(self) -> Path:
        return self.folder / "cell.toml"

    @property
    def calibration(self) -> Path:
        """The shipped calibrations, of this cell alone: a fault may invalidate some."""
        return self.folder / "shipped-calibration"

    @property
    def data(self) -> Path:
        return self.folder / "store"

    @property
    def modbus_port(self) -> int:
        return self.ports[self._shipped_modbus_port]

    def change(self, old: str, new: str, count: int = -1) -> None:
        """Another line in the cell file; fails when the line is not there."""
        text = self.cell.read_text(encoding="utf-8")
        assert old in text, f"{old!r} is not in the cell file"
        self.cell.write_text(text.replace(old, new, count), encoding="utf-8")

    def fake(self, seed: int = 1) -> "Program":
        options = ["--scenario", str(self.scenario), "--seed", str(seed)]
        return self._start("fakes", "run", *options)

    def daemon(self, *, data: Path | None = None) -> "Program":
        arguments = ["run", str(self.cell), "--data-dir", str(data or self.data)]
        return self._start("cellctl", *arguments)

    def demo(self, out: Path, *options: str) -> "Program":
        files = ["--scenario", str(self.scenario), "--cell", str(self.cell), "--out", str(out)]
        return self._start("cellctl", "demo", *files, *options)

    def page(self, settings: Path | None = None) -> "Program":
        """The operator page of the daemon, on any free port."""
        if settings is None:
            settings, self.pin = write_settings(self.folder)
        return self._start("cellctl.hmi", "serve", "--settings", str(settings))

    def plc(self, *options: str) -> "Program":
        return self._start("fakes", "plc", "--port", str(self.modbus_port), *options)

    def _start(self, module: str, *arguments: str) -> "Program":
        files = self.folder / f"{len(self.programs)}-{module}-{arguments[0]}"
        program = Program.start(files, module, *arguments)
        self.programs.append(program)
        return program

    def kill_all(self) -> None:
        """For the end of a test, whatever its outcome."""
        for program in reversed(self.programs):
            program.kill()

    @contextmanager
    def control(self) -> Iterator[Control]:
        """The operator's hands at the fake cell."""
        control = Control(self.ports[load(self._shipped_scenario).control_port])
        try:
            yield control
        finally:
            control.close()


def cellctl(*arguments: str) -> subprocess.CompletedProcess[str]:
    """One command of the user to its end."""
    command = [sys.executable, "-m", "cellctl", *arguments]
    return subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, timeout=60, check=False
    )


@dataclass
class Program:
    """A process in a group of its own, its output in files; all its descendants carry a mark."""

    process: subprocess.Popen[bytes]
    out: Path
    err: Path
    mark: str

    @classmethod
    def start(cls, files: Path, module: str, *arguments: str) -> Self:
        mark = uuid4().hex
        out, err = files.with_suffix(".out"), files.with_suffix(".err")
        with out.open("wb") as stdout, err.open("wb") as stderr:
            process = subprocess.Popen(
                [sys.executable, "-m", module, *arguments],
                cwd=ROOT,
                stdin=subprocess.DEVNULL,
                stdout=stdout,
                stderr=stderr,
                # Where the kernel shares processors by session (autogroup, sched(7)), the other
                # programs of this terminal together weigh as much as this child alone.
                start_new_session=True,
                env=os.environ | {_MARK: mark, "OPENBLAS_NUM_THREADS": "1"},
            )
        return cls(process, out, err, mark)

    @property
    def stdout(self) -> str:
        return self.out.read_text(encoding="utf-8")

    @property
    def stderr(self) -> str:
        return self.err.read_text(encoding="utf-8")

    @property
    def messages(self) -> list[dict[str, Any]]:
        """Whole lines of JSON on standard output so far."""
        lines = self.stdout.split("\n")[:-1]
        return [json.loads(line) for line in lines if line.startswith("{")]

    @property
    def log(self) -> list[dict[str, Any]]:
        """Whole lines of the JSON log so far."""
        lines = self.stderr.split("\n")[:-1]
        return [json.loads(line) for line in lines if line.startswith("{")]

    def until(self, what: str, seen: Callable[[], Any], timeout_s: float = READY_S) -> Any:
        """The first true value of ``seen``; fails when the program ends before, or in time."""
        deadline = time.monotonic() + timeout_s
        while time.monotonic() < deadline:
            ended = self.process.poll() is not None
            if value := seen():
                return value
            assert not ended, f"ended before {what}:\n{self.stdout}\n{self.stderr}"
            time.sleep(0.02)
        raise AssertionError(f"no {what} in {timeout_s} s:\n{self.stdout}\n{self.stderr}")

    def ready(self) -> dict[str, Any]:
        ready: dict[str, Any] = self.until(
            "ready", lambda: next((m for m in self.messages if m.get("ready")), None)
        )
        return ready

    def logged(self, event: str, timeout_s: float = READY_S, **fields: Any) -> dict[str, Any]:
        """The first line of the log with this event and these fields."""

        def find() -> dict[str, Any] | None:
            wanted = {"event": event, **fields}
            return next((entry for entry in self.log if wanted.items() <= entry.items()), None)

        entry: dict[str, Any] = self.until(f"log line {event!r} {fields}", find, timeout_s)
        return entry

    def interrupt(self, number: signal.Signals, timeout_s: float = END_S) -> int:
        """Send the signal to this process alone and wait for its end."""
        self.process.send_signal(number)
        return self.end(timeout_s)

    def end(self, timeout_s: float = END_S) -> int:
        """The exit code."""
        try:
            return self.process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"still there:\n{self.stdout}\n{self.stderr}") from None

    def descendants(self) -> dict[int, str]:
        """Living processes with the mark, by number: also those that left group and parent."""
        found = {}
        for folder in Path("/proc").iterdir():
            if not folder.name.isdigit():
                continue
            try:
                if f"{_MARK}={self.mark}".encode() in (folder / "environ").read_bytes().split(
                    b"\0"
                ):
                    found[int(folder.name)] = (folder / "cmdline").read_text().replace("\0", " ")
            except OSError:
                continue  # ended meanwhile, or another user's
        return found

    def nobody_left(self, timeout_s: float = 5.0) -> None:
        """Fails when a process of the family outlives it."""
        deadline = time.monotonic() + timeout_s
        while left := self.descendants():
            assert time.monotonic() < deadline, f"left behind: {left}"
            time.sleep(0.05)

    def kill(self) -> None:
        """For the end of a test, whatever its outcome."""
        for number in self.descendants():
            try:
                os.kill(number, signal.SIGKILL)
            except ProcessLookupError:
                continue
        self.process.wait(END_S)
