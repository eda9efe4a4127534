"""One demonstration while it runs: fake cell, daemon, operator page, line PLC."""

import signal
import time
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from queue import Empty
from typing import Any

from rich.console import Console

from fakes.demo.children import Child, ChildFailed, Family
from fakes.demo.control import Control, Refused
from fakes.demo.demo import Demo
from fakes.demo.gentl import Cameras, GentlPath, way_of_images
from fakes.demo.live import LiveView
from fakes.demo.outcome import collect, result_table
from fakes.demo.page import DemoPage, write_settings
from fakes.demo.safety import own_calibrations
from fakes.demo.stored_results import StoredResults
from fakes.demo.verdict import why_not_good
from fakes.scenario_file.scenario import Scenario
from fakes.scenario_file.sections import JobController
from fakes.scenes.load import load

GOOD, NOT_STARTED, NOT_GOOD, INTERRUPTED = 0, 1, 2, 130
"""Exit codes."""

RUN_TIMEOUT_S = 900.0
"""How long the line waits for a part. A computer that others share renders and measures so slowly
that a run of a minute takes six; a run that does not go on ends by the cell's own limits."""
SLOW_SHARE = 0.01
"""Share of its time that the fake cell may lose before the computer is named as a cause. With two
free processors it loses a tenth of that."""


@dataclass(frozen=True, slots=True)
class Files:
    """What a demonstration reads, and the folder that it writes."""

    scenario: Path
    cell: Path
    out: Path
    imperfections: Mapping[str, float] = field(default_factory=dict)
    """Scales in place of those of the scenario file, by name."""
    robots: JobController | None = None
    """What all controllers do, in place of what the scenario file says."""
    cameras: Cameras | None = None
    """How images come to the daemon; None for the real way where this computer can build it."""


def too_slow(lost_s: float, passed_s: float) -> str:
    """What to tell a user whose computer could not run the fake cell in real time."""
    return (
        f"this computer was too slow: it gave the fake cell no processor for {lost_s:.1f} s of "
        f"{passed_s:.0f} s, and devices that fall silent for tenths of a second are faults. End "
        "other programs, or give the demonstration two processors of its own, and run it again"
    )


class Session:
    """Fake cell and daemon, running."""

    def __init__(
        self,
        demo: Demo,
        files: Files,
        seed: int,
        *,
        family: Family,
        console: Console,
        complaint: Console,
        look_s: float | None = 5.0,
    ) -> None:
        """``look_s``: how often a cell that stays is asked whether this computer is too slow."""
        self._demo = demo
        self._files = files
        self._family = family
        self._console = console
        self._complaint = complaint
        self._folder = files.out
        self._seed = seed
        self._begun_s = time.monotonic()
        self._look_s = look_s
        self._looks = deque([(self._begun_s, 0.0)], maxlen=3)
        """Times, and what the fake cell had lost by then, s."""
        self._daemon: Child | None = None
        self._cell = files.cell
        self._daemon_command: list[str] = []
        self._gentl: GentlPath | None = None
        self._hands: int | None = None

    def start_fake(self) -> None:
        """The fake cell, until all its devices listen."""
        self._console.print(
            f"{self._demo.title}: starting fake cell (seed {self._seed}) and daemon …"
        )
        # This comes before the fake cell: it writes the file that tells the producer its cameras.
        self._gentl, how = way_of_images(
            self._files.cameras, self._files.cell, self._load_scenario, self._folder / "gentl"
        )
        if how:
            self._console.print(how, markup=False)
        scenario, seed = str(self._files.scenario), str(self._seed)
        arguments = ["-m", "fakes", "run", "--scenario", scenario, "--seed", seed]
        for name, scale in self._files.imperfections.items():
            arguments += ["--imperfection", f"{name}={scale:g}"]
        if self._files.robots is not None:
            arguments += ["--robots", self._files.robots]
        if self._gentl is not None:
            arguments += ["--gentl", str(self._gentl.cameras)]
        ports = self._spawn("fake-cell", arguments).wait_ready()["ports"]
        self._hands = int(ports["control"])
        self._control = Control(self._hands)

    def start_daemon(self) -> None:
        """The daemon, until every device of its cell file is connected."""
        store = self._folder / "store"
        cell = self._files.cell if self._gentl is None else self._gentl.cell
        self._cell = cell
        command = ["-m", "cellctl", "run", str(cell), "--data-dir", str(store)]
        calibrations = own_calibrations(self._files.cell, self._folder)
        if calibrations is not None:
            command += ["--calibration-dir", str(calibrations)]
        self._daemon_command = command
        self._spawn_daemon("daemon")
        self._console.print(f"both are up; record and logs in {self._folder}/")

    def start_page(self) -> None:
        """The operator page, before anything moves: its start takes a second of a processor."""
        settings, pin = write_settings(self._folder)
        arguments = ["-m", "cellctl.hmi", "serve", "--settings", str(settings)]
        url = str(self._spawn("page", arguments).wait_ready()["url"])
        self._console.print(DemoPage(url, pin).words)

    def inject(self, items: Sequence[str]) -> None:
        """Faults of the fake cell, given as device:name."""
        for item in items:
            device, _, name = item.partition(":")
            self._control.request("inject", device=device, name=name)
            self._console.print(f"injected {item}")

    def run(self, *, calibrate: bool, stay: bool) -> int:
        """The job; its exit code."""
        if stay:
            return self._stay()
        return self._calibrate() if calibrate else self._produce()

    def how_it_ended(self) -> str:
        """Tells a user who interrupted what became of the run and of the processes."""
        closed = self._daemon.logged("run closed") if self._daemon is not None else None
        run = f"run {closed['run']} is closed as {closed['result']}; " if closed else ""
        return f"stopped: {run}daemon and fake cell have ended"

    def _load_scenario(self) -> Scenario:
        return load(self._files.scenario, self._files.imperfections)

    def _stay(self) -> int:
        data = f"--data-dir {self._folder / 'store'}"
        socket = self._folder / "store" / "cellctl.sock"
        hands = f"--port {self._hands}"
        self._console.print(
            f"Modbus TCP on 127.0.0.1:{self._modbus_port}, map in docs/register-map.md\n"
            f"  its cell file:      {self._cell}\n"
            f"  a line PLC to try:  .venv/bin/python -m fakes plc --port {self._modbus_port}\n"
            f"  its state:          .venv/bin/cellctl status --watch --socket {socket}\n"
            f"  its runs:           .venv/bin/cellctl runs list {data}\n"
            f"  hands at the cell:  .venv/bin/python -m fakes operator status {hands}\n"
            "Ctrl-C ends both"
        )
        starts = 1
        while (killed_by := self._daemon_killed_by()) is not None:
            starts += 1
            self._console.print(
                f"the daemon was killed by {killed_by.name}; starting it again, as systemd does …"
            )
            # A log of its own: what the one before has said is what one wants to read now.
            self._spawn_daemon(f"daemon-{starts}")
            self._console.print(f"it is up; its log: {self._folder / f'daemon-{starts}.log'}")
        assert self._daemon is not None
        raise ChildFailed(f"the daemon ended:\n{self._daemon.last_words()}")

    def _spawn_daemon(self, name: str) -> None:
        self._daemon = self._spawn(name, self._daemon_command)
        self._modbus_port = int(self._daemon.wait_ready()["modbus_port"])

    def _daemon_killed_by(self) -> signal.Signals | None:
        """Wait until the daemon is gone; the signal that has killed it, None if it ended itself."""
        assert self._daemon is not None
        going_on = True
        while going_on:
            try:
                going_on = self._daemon.next_line(self._look_s) is not None
            except Empty:
                self._tell_if_slow(self._daemon)
        code = self._daemon.process.wait()
        return signal.Signals(-code) if code < 0 else None

    def _tell_if_slow(self, daemon: Child) -> None:
        """Say beside a new fault that this computer may be its cause."""
        try:
            faults, lost_s, now_s = daemon.new_faults(), self._lost_s(), time.monotonic()
        except (Refused, OSError):
            self._look_s = None  # a fake cell that does not answer tells nothing more
            return
        # A silence may be noticed after the look that came next.
        since_s, before_s = self._looks[0]
        self._looks.append((now_s, lost_s))
        if faults and lost_s - before_s > SLOW_SHARE * (now_s - since_s):
            self._complaint.print("\n".join(faults), markup=False)
            self._complaint.print(too_slow(lost_s - before_s, now_s - since_s), markup=False)

    def _lost_s(self) -> float:
        return float(self._control.request("truth")["truth"]["lost_s"])

    def _calibrate(self) -> int:
        if not self._demo.procedures:
            self._console.print(f"{self._demo.process} has no calibrations to run")
        results = StoredResults(self._folder / "calibration")
        for procedure in self._demo.procedures:
            procedure.prepare(self._control, self._files.cell)
            self._console.print(f"procedure {procedure.number}: {procedure.title}")
            number, timeout_s = str(procedure.number), f"{procedure.timeout_s:g}"
            result = self._line("--mode", "maintenance", "--recipe", number, "--timeout", timeout_s)
            if result.get("result") != "good":
                return self._not_good(result, self._faults())
            for table in results.new():
                self._console.print(table)
        return GOOD

    def _produce(self) -> int:
        self._demo.prepare(self._control)
        serial = self._demo.serial.format(seed=self._seed)
        mate = self._demo.mate_serial.format(seed=self._seed)
        parts = ("--serial", serial, "--mate-serial", mate)
        patience = ("--timeout", f"{RUN_TIMEOUT_S:g}")
        result = self._line("--recipe", str(self._demo.recipe), *parts, *patience)
        faults = self._faults()
        # Asked at once: the truth is that of the end of the job.
        truth = self._control.request("truth")["truth"]
        self._console.print("writing record and report …")
        wall_s = time.monotonic() - self._begun_s
        outcome = collect(self._demo, self._folder, result, truth, wall_s)
        self._console.print(result_table(outcome))
        if outcome.report:
            self._console.print(f"report: {outcome.report}")
            data = f"--data-dir {self._folder / 'store'}"
            self._console.print(f"its records: .venv/bin/cellctl runs list {data}")
        if not outcome.judgement.passed:
            return self._not_good(result, faults)
        return GOOD

    def _line(self, *arguments: str) -> dict[str, Any]:
        """Play the line PLC for one job; its last message."""
        port = str(self._modbus_port)
        plc = self._spawn("line-plc", ["-m", "fakes", "plc", "--port", port, *arguments])
        result: dict[str, Any] = {}
        with LiveView(self._console, self._demo) as view:
            while (message := plc.next_line(timeout_s=None)) is not None:
                view.show(message | {"doing": self._doing()})
                if message.get("event") in ("result", "error"):
                    result = message
        if not result:
            raise ChildFailed(f"the line PLC ended without a result:\n{plc.last_words()}")
        return result

    def _doing(self) -> str:
        """What the daemon has said last of the job."""
        said = self._daemon.logged("doing") if self._daemon is not None else None
        return "" if said is None else str(said["text"])

    def _faults(self) -> list[str]:
        return self._daemon.faults() if self._daemon is not None else []

    def _not_good(self, result: dict[str, Any], faults: list[str]) -> int:
        self._complaint.print(f"not good: {why_not_good(result)}", style="bold", markup=False)
        for fault in faults:
            self._complaint.print(fault, markup=False)
        lost_s = self._lost_s()
        passed_s = time.monotonic() - self._begun_s
        if lost_s > SLOW_SHARE * passed_s:
            self._complaint.print(too_slow(lost_s, passed_s), markup=False)
        return NOT_GOOD

    def _spawn(self, name: str, command: list[str]) -> Child:
        return self._family.spawn(name, command, self._folder / f"{name}.log")
