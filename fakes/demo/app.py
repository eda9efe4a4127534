"""`python -m fakes demo`: a whole cell as separate processes, and one job for it."""

import sys
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer
from pydantic import ValidationError
from rich.console import Console

from fakes.demo import registry
from fakes.demo.children import ChildFailed, Family
from fakes.demo.control import Refused
from fakes.demo.demo import Demo
from fakes.demo.gentl import Cameras, UnusualCellFile
from fakes.demo.ports import NoLoopback, PortInUse, check_ports
from fakes.demo.safety import (
    FolderInUse,
    NotSimulated,
    UnfitCell,
    require_own_folder,
    require_simulated,
)
from fakes.demo.session import GOOD, INTERRUPTED, NOT_STARTED, Files, Session
from fakes.gentl.build import NoCompilerError
from fakes.imperfections import UnknownImperfection, parsed_scale
from fakes.known_faults import UnknownFault, known_faults, require_known
from fakes.scenario_file.sections import JobController
from fakes.scenes.load import load
from fakes.scenes.registry import UnknownScene

DEFAULT_PROCESS = "deck-to-frame"
_REFUSALS = (
    ChildFailed,
    Refused,
    OSError,
    FolderInUse,
    NotSimulated,
    PortInUse,
    NoLoopback,
    registry.UnknownProcess,
    UnknownScene,
    UnknownImperfection,
    NoCompilerError,
    UnusualCellFile,
    UnfitCell,
)
"""Each of them is a sentence for the user."""

app = typer.Typer(add_completion=False, rich_markup_mode=None)


@dataclass(frozen=True, slots=True)
class Job:
    """What the user asked for."""

    seed: int
    calibrate: bool
    stay: bool
    faults: tuple[str, ...]


@app.command()
def demo(
    *,
    process: Annotated[
        str, typer.Option(help="Which process; an unknown name lists those that there are.")
    ] = DEFAULT_PROCESS,
    seed: Annotated[
        int, typer.Option(help="Another seed is another day: other parts, grips and noise.", min=0)
    ] = 1,
    scenario: Annotated[
        Path | None,
        typer.Option(help="Of the fake cell; default: NAME.scenario.toml beside --cell NAME.toml."),
    ] = None,
    cell: Annotated[
        str | None,
        typer.Option(
            help="The daemon's cell file, or the short name of a shipped one (peg-in-hole: "
            "connector, pin, pin-rpc); default: the process's own."
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for record, report, logs.")] = None,
    calibrate: Annotated[bool, typer.Option(help="Run all calibrations instead.")] = False,
    stay: Annotated[bool, typer.Option(help="Start and wait for an outside PLC.")] = False,
    quiet: Annotated[bool, typer.Option(help="No live view.")] = False,
    fault: Annotated[
        list[str] | None,
        typer.Option(
            help="Inject before the start: device:name; unknown ones list those there are."
        ),
    ] = None,
    imperfection: Annotated[
        list[str] | None, typer.Option(help="NAME=SCALE, in place of that of the scenario file.")
    ] = None,
    robots: Annotated[
        JobController | None,
        typer.Option(help="What all robot controllers do; default: what the scenario file says."),
    ] = None,
    cameras: Annotated[
        Cameras | None,
        typer.Option(
            help="How images come: as from GigE cameras, or from frame servers; default: gentl "
            "where there is a C compiler."
        ),
    ] = None,
) -> None:
    """Run one job of a process on its fake cell; exit code 0 only for a good part.

    With --stay the cell waits for an outside PLC, and Ctrl-C is its ordinary end.
    """
    console = Console(highlight=False, quiet=quiet, soft_wrap=True)
    complaint = Console(stderr=True, highlight=False, soft_wrap=True, style="red")
    job = Job(seed=seed, calibrate=calibrate, stay=stay, faults=tuple(fault or ()))
    try:
        shown = registry.find(process)
        file = None if cell is None else _cell_file(cell, shown)
        files = Files(
            scenario=scenario or _beside(file) or shown.scenario,
            cell=file or shown.cell,
            out=out or Path("runs") / f"{datetime.now(UTC):%Y%m%d-%H%M%S}-seed-{seed}",
            imperfections=dict(parsed_scale(item) for item in imperfection or ()),
            robots=robots,
            cameras=cameras,
        )
        _check(files, job.faults)
        code = _run(shown, files, job, console, complaint)
    except UnknownFault as error:
        raise typer.BadParameter(str(error), param_hint="--fault") from error
    except _REFUSALS as error:
        complaint.print(str(error), markup=False)
        code = NOT_STARTED
    raise typer.Exit(code)


def _cell_file(cell: str, shown: Demo) -> Path:
    """By its short name or path; raises ``UnfitCell`` for what is neither of this process."""
    file = shown.cells.get(cell, Path(cell))
    if not file.exists():
        raise UnfitCell(_no_cell_file(cell, shown))
    try:
        recipes = tomllib.loads(file.read_text(encoding="utf-8")).get("recipes", [])
    except ValueError:
        return file  # the daemon says what is wrong with it
    others = sorted({str(one.get("process", "")) for one in recipes} - {shown.process})
    if others and shown.process not in {one.get("process") for one in recipes}:
        raise UnfitCell(f"{file} is of the process {', '.join(others)}: name that by --process")
    return file


def _no_cell_file(cell: str, shown: Demo) -> str:
    here = ", ".join(shown.cells) or "no short names"
    elsewhere = [
        f"; --process {name} has {cell!r}"
        for name in registry.demonstrated()
        if name != shown.process and cell in registry.find(name).cells
    ]
    return f"no cell file {cell}; {shown.process} has {here}{''.join(elsewhere)}"


def _beside(cell: Path | None) -> Path | None:
    """The scenario that belongs to a cell file, where there is one."""
    if cell is None:
        return None
    scenario = cell.with_suffix(".scenario.toml")
    return scenario if scenario.is_file() else None


def _check(files: Files, faults: Sequence[str]) -> None:
    """Everything that can be said before a process starts; raises ``UnknownFault`` or one of
    ``_REFUSALS``."""
    require_simulated(files.cell)
    require_own_folder(files.out)
    try:
        scenario = load(files.scenario, files.imperfections)
    except (tomllib.TOMLDecodeError, ValidationError) as error:
        raise ChildFailed(f"scenario {files.scenario}: {error}") from error
    if files.robots is not None:
        scenario = scenario.with_controllers(files.robots)
    known = known_faults(scenario, files.cameras)
    for item in faults:
        require_known(item, known)
    check_ports(scenario, files.cell)


def _run(shown: Demo, files: Files, job: Job, console: Console, complaint: Console) -> int:
    code = INTERRUPTED
    files.out.mkdir(parents=True, exist_ok=True)
    with Family() as family:
        session = Session(
            shown, files, job.seed, family=family, console=console, complaint=complaint
        )
        try:
            session.start_fake()
            session.inject(job.faults)
            session.start_daemon()
            session.start_page()
            code = session.run(calibrate=job.calibrate, stay=job.stay)
        except KeyboardInterrupt:
            console.print("\nstopping the cell …")
    if code == INTERRUPTED:
        console.print(session.how_it_ended())
        return GOOD if job.stay else INTERRUPTED
    return code


if __name__ == "__main__":
    sys.exit(app())
