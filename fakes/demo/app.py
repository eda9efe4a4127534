"""`python -m fakes demo`: the whole cell as separate processes, and one job for it."""

import json
import signal
import sys
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from fakes.demo.calibration import PROCEDURES
from fakes.demo.children import Child, ChildFailed, family
from fakes.demo.control import Control
from fakes.demo.live import LiveView
from fakes.demo.outcome import collect, result_table

app = typer.Typer(add_completion=False)


@app.command()
def demo(
    *,
    seed: Annotated[int, typer.Option(help="Another seed is another cell.")] = 1,
    scenario: Annotated[Path, typer.Option(help="Scenario of the fake cell.")] = Path(
        "config/fake-cell.toml"
    ),
    cell: Annotated[Path, typer.Option(help="The daemon's cell file.")] = Path(
        "config/cell.fake.toml"
    ),
    out: Annotated[Path | None, typer.Option(help="Folder for record, report, logs.")] = None,
    calibrate: Annotated[bool, typer.Option(help="Run all calibrations instead.")] = False,
    stay: Annotated[bool, typer.Option(help="Start and wait for an outside PLC.")] = False,
    quiet: Annotated[bool, typer.Option(help="No live view.")] = False,
    fault: Annotated[
        list[str] | None, typer.Option(help="Inject before the start: device:name.")
    ] = None,
) -> None:
    """Assemble one deck on the fake cell; exit code 0 only for a good part."""
    console = Console(highlight=False, quiet=quiet, soft_wrap=True)
    folder = out or Path("runs") / f"{datetime.now(UTC):%Y%m%d-%H%M%S}-seed-{seed}"
    folder.mkdir(parents=True, exist_ok=True)
    signal.signal(signal.SIGTERM, _as_interrupt)
    try:
        with family() as children:
            session = Session(children, console, folder, seed)
            session.start(scenario, cell)
            for item in fault or []:
                session.inject(item)
            code = session.run(calibrate=calibrate, stay=stay)
    except ChildFailed as error:
        Console(stderr=True, highlight=False, soft_wrap=True).print(
            str(error), style="bold red", markup=False
        )
        code = 1
    except KeyboardInterrupt:
        console.print("\nstopped: motion ended, run closed as aborted, no process left")
        code = 130
    raise typer.Exit(code)


class Session:
    """Fake cell and daemon, running."""

    def __init__(self, children: list[Child], console: Console, folder: Path, seed: int) -> None:
        self._children = children
        self._console = console
        self._folder = folder
        self._seed = seed
        self._begun_s = time.monotonic()

    def start(self, scenario: Path, cell: Path) -> None:
        """Both processes, each until it says that it is ready."""
        arguments = ["-m", "fakes", "run", "--scenario", str(scenario), "--seed", str(self._seed)]
        ports = self._spawn("fake-cell", arguments).wait_ready()["ports"]
        self._control = Control(int(ports["control"]))
        store = self._folder / "store"
        daemon = self._spawn(
            "daemon", ["-m", "cellctl", "run", str(cell), "--data-dir", str(store)]
        )
        self._modbus_port = int(daemon.wait_ready()["modbus_port"])
        self._console.print(
            f"fake cell (seed {self._seed}) and daemon are up; record in {self._folder}/"
        )

    def inject(self, item: str) -> None:
        """A fault of the fake cell, given as device:name."""
        device, _, name = item.partition(":")
        self._control.request("inject", device=device, name=name)
        self._console.print(f"injected {item}")

    def run(self, *, calibrate: bool, stay: bool) -> int:
        """The job; its exit code."""
        if stay:
            return self._stay()
        return self._calibrate() if calibrate else self._assemble()

    def _stay(self) -> int:
        self._console.print(f"Modbus TCP on 127.0.0.1:{self._modbus_port}; Ctrl-C ends both")
        daemon = self._children[-1]
        while daemon.next_line(timeout_s=None) is not None:
            continue
        raise ChildFailed(f"the daemon ended:\n{daemon.log_tail()}")

    def _calibrate(self) -> int:
        for procedure in PROCEDURES:
            procedure.prepare(self._control)
            self._console.print(f"procedure {procedure.number}: {procedure.title}")
            result = self._line("--mode", "maintenance", "--recipe", str(procedure.number))
            if result.get("result") != "good":
                return self._failed(result)
        return 0

    def _assemble(self) -> int:
        result = self._line("--serial", f"SAT-{self._seed:04d}")
        truth = self._control.request("truth")["truth"]
        outcome = collect(self._folder, result, truth, time.monotonic() - self._begun_s)
        self._console.print(result_table(outcome))
        if not outcome["passed"]:
            return self._failed(result)
        self._console.print(f"report: {self._folder / 'report' / 'report.html'}")
        return 0

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
            raise ChildFailed(f"the line PLC ended without a result:\n{plc.log_tail()}")
        return result

    def _failed(self, result: dict[str, Any]) -> int:
        console = Console(stderr=True, highlight=False, soft_wrap=True)
        console.print(f"not good: {json.dumps(result)}", style="bold red", markup=False)
        for line in self._children[1].faults():
            console.print(line, style="red", markup=False)
        return 2

    def _spawn(self, name: str, command: list[str]) -> Child:
        child = Child.start(name, command, self._folder / f"{name}.log")
        self._children.append(child)
        return child


def _as_interrupt(_number: int, _frame: object) -> None:
    raise KeyboardInterrupt


if __name__ == "__main__":
    sys.exit(app())
