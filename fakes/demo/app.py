"""`python -m fakes demo`: the whole cell as separate processes, and one job for it."""

import sys
import time
import tomllib
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from fakes.demo.calibration import PROCEDURES
from fakes.demo.children import Child, ChildFailed, Family
from fakes.demo.control import Control, Refused
from fakes.demo.live import LiveView
from fakes.demo.outcome import collect, result_table
from fakes.demo.verdict import why_not_good

GOOD, NOT_STARTED, NOT_GOOD, INTERRUPTED = 0, 1, 2, 130

app = typer.Typer(add_completion=False, rich_markup_mode=None)


@app.command()
def demo(
    *,
    seed: Annotated[int, typer.Option(help="Another seed is another cell.", min=0)] = 1,
    scenario: Annotated[Path, typer.Option(help="Scenario of the fake cell.")] = Path(
        "config/deck.scenario.toml"
    ),
    cell: Annotated[Path, typer.Option(help="The daemon's cell file.")] = Path("config/deck.toml"),
    out: Annotated[Path | None, typer.Option(help="Folder for record, report, logs.")] = None,
    calibrate: Annotated[bool, typer.Option(help="Run all calibrations instead.")] = False,
    stay: Annotated[bool, typer.Option(help="Start and wait for an outside PLC.")] = False,
    quiet: Annotated[bool, typer.Option(help="No live view.")] = False,
    fault: Annotated[
        list[str] | None, typer.Option(help="Inject before the start: device:name.")
    ] = None,
) -> None:
    """Assemble one deck on the fake cell; exit code 0 only for a good part.

    With --stay the cell waits for an outside PLC, and Ctrl-C is its ordinary end.
    """
    console = Console(highlight=False, quiet=quiet, soft_wrap=True)
    complaint = Console(stderr=True, highlight=False, soft_wrap=True, style="red")
    folder = out or Path("runs") / f"{datetime.now(UTC):%Y%m%d-%H%M%S}-seed-{seed}"
    code = INTERRUPTED
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with Family() as family:
            session = Session(family, console, complaint, folder=folder, seed=seed)
            try:
                session.start_fake(scenario)
                session.inject(fault or [])
                session.start_daemon(cell)
                code = session.run(calibrate=calibrate, stay=stay)
            except KeyboardInterrupt:
                console.print("\nstopping the cell …")
        if code == INTERRUPTED:
            console.print(session.how_it_ended())
            code = GOOD if stay else INTERRUPTED
    except (ChildFailed, Refused, OSError) as error:
        complaint.print(str(error), markup=False)
        code = NOT_STARTED
    raise typer.Exit(code)


class Session:
    """Fake cell and daemon, running."""

    def __init__(
        self, family: Family, console: Console, complaint: Console, *, folder: Path, seed: int
    ) -> None:
        self._family = family
        self._console = console
        self._complaint = complaint
        self._folder = folder
        self._seed = seed
        self._begun_s = time.monotonic()
        self._daemon: Child | None = None

    def start_fake(self, scenario: Path) -> None:
        """The fake cell, until all its devices listen."""
        self._console.print(f"starting fake cell (seed {self._seed}) and daemon …")
        arguments = ["-m", "fakes", "run", "--scenario", str(scenario), "--seed", str(self._seed)]
        ports = self._spawn("fake-cell", arguments).wait_ready()["ports"]
        self._control = Control(int(ports["control"]))

    def start_daemon(self, cell: Path) -> None:
        """The daemon, until every device of its cell file is connected."""
        _as_calibrated(cell)
        store = self._folder / "store"
        self._daemon = self._spawn(
            "daemon", ["-m", "cellctl", "run", str(cell), "--data-dir", str(store)]
        )
        self._modbus_port = int(self._daemon.wait_ready()["modbus_port"])
        self._console.print(f"both are up; record and logs in {self._folder}/")

    def inject(self, items: list[str]) -> None:
        """Faults of the fake cell, given as device:name."""
        for item in items:
            device, _, name = item.partition(":")
            self._control.request("inject", device=device, name=name)
            self._console.print(f"injected {item}")

    def run(self, *, calibrate: bool, stay: bool) -> int:
        """The job; its exit code."""
        if stay:
            return self._stay()
        return self._calibrate() if calibrate else self._assemble()

    def how_it_ended(self) -> str:
        """For the user who interrupted: what became of the run, and of the processes."""
        closed = self._daemon.logged("run closed") if self._daemon is not None else None
        run = f"run {closed['run']} is closed as {closed['result']}; " if closed else ""
        return f"stopped: {run}daemon and fake cell have ended"

    def _stay(self) -> int:
        data = f"--data-dir {self._folder / 'store'}"
        socket = self._folder / "store" / "cellctl.sock"
        self._console.print(
            f"Modbus TCP on 127.0.0.1:{self._modbus_port}, map in docs/register-map.md\n"
            f"  a line PLC to try:  .venv/bin/python -m fakes plc --port {self._modbus_port}\n"
            f"  its state:          .venv/bin/cellctl status --watch --socket {socket}\n"
            f"  its runs:           .venv/bin/cellctl runs list {data}\n"
            "Ctrl-C ends both"
        )
        assert self._daemon is not None
        while self._daemon.next_line(timeout_s=None) is not None:
            continue
        raise ChildFailed(f"the daemon ended:\n{self._daemon.last_words()}")

    def _calibrate(self) -> int:
        for procedure in PROCEDURES:
            procedure.prepare(self._control)
            self._console.print(f"procedure {procedure.number}: {procedure.title}")
            result = self._line("--mode", "maintenance", "--recipe", str(procedure.number))
            if result.get("result") != "good":
                return self._not_good(result, self._faults())
        return GOOD

    def _assemble(self) -> int:
        result = self._line("--serial", f"SAT-{self._seed:04d}")
        faults = self._faults()
        truth = self._control.request("truth")["truth"]
        self._console.print("writing record and report …")
        outcome = collect(self._folder, result, truth, time.monotonic() - self._begun_s)
        self._console.print(result_table(outcome))
        if outcome["report"]:
            self._console.print(f"report: {outcome['report']}")
        if not outcome["passed"]:
            return self._not_good(result, faults)
        return GOOD

    def _line(self, *arguments: str) -> dict[str, Any]:
        """Play the line PLC for one job; its last message."""
        port = str(self._modbus_port)
        plc = self._spawn("line-plc", ["-m", "fakes", "plc", "--port", port, *arguments])
        result: dict[str, Any] = {}
        with LiveView(self._console) as view:
            while (message := plc.next_line(timeout_s=None)) is not None:
                view.show(message)
                if message.get("event") in ("result", "error"):
                    result = message
        if not result:
            raise ChildFailed(f"the line PLC ended without a result:\n{plc.last_words()}")
        return result

    def _faults(self) -> list[str]:
        return self._daemon.faults() if self._daemon is not None else []

    def _not_good(self, result: dict[str, Any], faults: list[str]) -> int:
        self._complaint.print(f"not good: {why_not_good(result)}", style="bold", markup=False)
        for fault in faults:
            self._complaint.print(fault, markup=False)
        return NOT_GOOD

    def _spawn(self, name: str, command: list[str]) -> Child:
        return self._family.spawn(name, command, self._folder / f"{name}.log")


if __name__ == "__main__":
    sys.exit(app())


def _as_calibrated(cell: Path) -> None:
    """The devices of a new fake cell are as its hardware seed draws them: what an earlier one
    suffered, and the daemon held against its calibrations, is undone.
    """
    try:
        written = tomllib.loads(cell.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return  # the daemon says what is wrong with it
    folder = cell.parent / str(written.get("calibration_dir", "calibration"))
    for marker in folder.glob("*.invalidated.json"):
        marker.unlink()
