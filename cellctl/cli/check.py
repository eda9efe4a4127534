"""`cellctl check`: everything that is wrong with a cell file; with `--connect` its devices too."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console

from cellctl.cli.commissioning.hints import hints_of_this_pc
from cellctl.cli.nearest_cell import SocketOption
from cellctl.cli.records.plain_json import as_plain
from cellctl.config import CellConfig
from cellctl.config.checks.arms.needs import ArmNeeds, rooms
from cellctl.config.checks.plausible.mounted import how_it_lies
from cellctl.config.checks.zones import taught_in_zone
from cellctl.config.commissioning import Examination, examine_before_commissioning
from cellctl.config.document.lines import FILL_IN, left_open
from cellctl.config.driver_settings import robot_driver
from cellctl.config.issue import ConfigIssue
from cellctl.config.model_file import model_path
from cellctl.config.process_definition import installed_processes, process_definition
from cellctl.config.roles import lacking_roles
from cellctl.files.hand_written import read_hand_written
from cellctl.planning.model.read_document import document_issues
from cellctl.terminal.consoles import console_of_lines, print_hanging

if TYPE_CHECKING:
    from cellctl.cli.connecting.answer import Answer

_UNDECIDED = (
    "The values contradict each other, and no other one decides which is wrong: the one above, or"
)

_DETAIL = 5
"""Where further lines of an error begin, as what is allowed does."""
_ABOUT = 32
"""Width of the first column of what is said of a good file."""

_POSES = (
    "contradict each other by less than 100 mm and 10 deg, over places with taught_above_mm by "
    "less than 10 mm and 3 deg, as far as anything here can be compared; whether they are right "
    "within that, only the cell shows"
)


def check(
    cell_file: Annotated[Path, typer.Argument(help="The cell's TOML file.")],
    *,
    connect: Annotated[
        bool, typer.Option("--connect", help="Ask every device too; moves and switches nothing.")
    ] = False,
    moves: Annotated[
        bool, typer.Option("--moves", help="Hold every move against the model beside the file.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    socket: SocketOption = None,
) -> None:
    """Check a cell file; exit code 1, with every error and what is allowed, when it is not good.

    With --connect every device of a good file is asked, and the exit code is 1 also when one is
    silent or another one than the file says. Nothing is asked while a daemon has the cell. With
    --moves every pose and every move that the processes of a good file can command is held against
    the model of the cell, and the exit code is 1 also when one of them is not good.
    """
    examined = examine_before_commissioning(cell_file)
    found = [*examined.errors, *_left_open(cell_file), *_of_model(cell_file)]
    remarks = [] if found else examined.remarks
    cell = None if found else examined.cell
    console = console_of_lines()
    if not as_json:
        _show_findings(console, cell_file, found)
        if cell is not None:
            _show_cell(console, cell_file, cell, examined)
    answers = _asked(cell, cell_file, socket) if connect and cell is not None else []
    bad_moves = list(_bad_moves(console, cell_file, quiet=as_json)) if moves and not found else []
    if as_json:
        told = _as_json(cell_file, found, remarks, answers, bad_moves)
        typer.echo(as_plain(told | _of_good_file(cell, cell_file.parent)))
    elif answers:
        from cellctl.cli.connecting.connect import show

        show(console, answers)
    if found or bad_moves or not all(answer.good for answer in answers):
        raise typer.Exit(1)


def _bad_moves(console: Console, cell_file: Path, *, quiet: bool) -> Iterator[str]:
    """Every move that is not good, with its number; said at once, because all take minutes."""
    # Planning is an extra, and its libraries take longer to load than a file to check.
    from cellctl.cli.planning.move_findings import move_findings
    from cellctl.cli.planning.opening import open_scene

    good = True
    for text in move_findings(open_scene(cell_file, None)):
        good = False
        yield text
        if not quiet:
            print_hanging(console, text, _DETAIL)
    if good and not quiet:
        console.print("  every move is free, by the model")


def _asked(cell: CellConfig, cell_file: Path, socket: Path | None) -> "list[Answer]":
    # Loaded when it is asked for: a file alone is checked in a fraction of the time that drivers,
    # calibrations and processes take to load.
    from cellctl.cli.connecting.connect import asked

    try:
        return asked(cell, cell_file, socket)
    except KeyboardInterrupt:
        typer.echo("ended by Ctrl-C: the links are dropped, nothing was moved", err=True)
        raise typer.Exit(130) from None


def _as_json(
    cell_file: Path,
    found: Sequence[ConfigIssue],
    remarks: Sequence[ConfigIssue],
    answers: "Sequence[Answer]",
    bad_moves: Sequence[str],
) -> dict[str, Any]:
    return {
        "cell_file": str(cell_file),
        "good": not found and not bad_moves and all(answer.good for answer in answers),
        "errors": [asdict(problem) for problem in found],
        "remarks": [asdict(remark) for remark in remarks],
        "devices": [answer.as_json() for answer in answers],
        "moves": list(bad_moves),
    }


def _of_good_file(cell: CellConfig | None, folder: Path) -> dict[str, Any]:
    """What is said of a file without errors; empty lists of any other."""
    return {
        "hints": [] if cell is None else hints_of_this_pc(cell, folder),
        "not_checked": [] if cell is None else list(_never_checked(cell)),
        "not_checked_yet": [] if cell is None else _not_yet_checked(cell, folder),
    }


def _show_findings(console: Console, cell_file: Path, found: Sequence[ConfigIssue]) -> None:
    if not found:
        return
    errors = "1 error" if len(found) == 1 else f"{len(found)} errors"
    console.print(f"{cell_file}: {errors}", style="bold red")
    for problem in found:
        print_hanging(console, f"F{problem.number} {problem.written}", _DETAIL)
        print_hanging(console, f"     {problem.allowed}", _DETAIL)
        if problem.against:
            print_hanging(console, f"     {_UNDECIDED}", _DETAIL)
        for other in problem.against:
            print_hanging(console, f"       {other}", _DETAIL + 4)


def _show_cell(console: Console, cell_file: Path, cell: CellConfig, examined: Examination) -> None:
    console.print(f"{cell_file}: good. Cell '{cell.name}', simulated: {cell.simulated}")
    for key, (_, device) in cell.devices().items():
        _say(console, key, device.driver)
    for what in _never_checked(cell):
        print_hanging(console, f"  {what}", _DETAIL, "yellow")
    _say_what_zones_hold(console, cell)
    _say_what_boxes_leave(console, cell, examined.needs)
    _say_how_sensors_lie(console, cell)
    _say(console, "poses", _POSES)
    model = model_path(cell_file)
    if model.exists():
        text = f"`cellctl check --moves {cell_file}` holds every move against it"
        _say(console, f"model {model.name}", text)
    for recipe in cell.recipes:
        text = f"{recipe.name} ({recipe.process}): this cell can run it"
        _say(console, f"recipe {recipe.id}", text)
    for what in _not_yet_checked(cell, cell_file.parent):
        print_hanging(console, f"  not checked yet: {what}", _DETAIL, "yellow")
    _say_what_others_need(console, cell)
    _say_what_the_daemon_needs(console, cell, cell_file.parent)
    if examined.remarks:
        # Last, where they are read.
        console.print("Look at these again; each may be meant as it stands:", style="yellow")
    for remark in examined.remarks:
        print_hanging(console, f"  {remark.written}", _DETAIL, "yellow")
        print_hanging(console, f"     {remark.allowed}", _DETAIL, "yellow")


def _say(console: Console, about: str, text: str) -> None:
    """One line of a good file; on a narrow terminal the text goes on below itself."""
    print_hanging(console, f"  {about:{_ABOUT}} {text}", _ABOUT + 3)


def _left_open(cell_file: Path) -> Iterator[ConfigIssue]:
    """Places that a template leaves to whoever commissions the cell."""
    # The daemon takes such a file, which the programs that rehearse a cell also do; whoever checks
    # it before a first start must not be told that it is good.
    for number, key in left_open(read_hand_written(cell_file)).items():
        allowed = "the value of this cell, and the mark taken away"
        yield ConfigIssue(key, f"{FILL_IN} (mark of the template)", allowed, line=number)


def _of_model(cell_file: Path) -> list[ConfigIssue]:
    """A model that cannot be read: nothing of the cell file was held against it."""
    model = model_path(cell_file)
    return document_issues(model) if model.exists() else []


def _never_checked(cell: CellConfig) -> Iterator[str]:
    """Robots whose joint moves nobody holds against the bounds of their flange."""
    for name, robot in cell.robots.items():
        driver, settings = robot_driver(robot)
        if not driver.checks_joint_ways(settings):
            yield (
                f"robots.{name}: joint moves are not checked against its workspace (the driver's "
                "settings say nothing of its kinematics)"
            )


def _not_yet_checked(cell: CellConfig, folder: Path) -> list[str]:
    """Each line once: recipes share cameras and boards."""
    lines = dict.fromkeys(
        what
        for recipe in cell.recipes
        for what in process_definition(recipe.process).not_yet_checked(cell, recipe, folder)
    )
    return list(lines)


def _say_what_zones_hold(console: Console, cell: CellConfig) -> None:
    """The taught poses in each zone, to be compared with what is seen in the cell."""
    for name, zone in cell.zones.items():
        texts = [
            f"{robot}: {', '.join(taught_in_zone(cell.robots[robot], share)) or 'no taught pose'}"
            for robot, share in zone.robots.items()
        ]
        order = ", then ".join(zone.retreat) or "nobody while another one is in it"
        _say(console, f"zones.{name}", f"holds of {'; of '.join(texts)}")
        _say(console, "", f"leaves first: {order}")


def _say_what_boxes_leave(console: Console, cell: CellConfig, needs: Sequence[ArmNeeds]) -> None:
    """Room of each box of a flange: it is to hold what the arm has to reach, and little more."""
    for of_arm in needs:
        for room in rooms(cell.robots[of_arm.name], of_arm):
            left = ", ".join(
                f"-{axis} {below:.0f} +{axis} {above:.0f}"
                for axis, below, above in zip("xyz", room.below_mm, room.above_mm, strict=True)
            )
            name = f"robots.{of_arm.name} {room.key.rsplit('.', 1)[-1]}"
            _say(console, name, f"leaves beyond taught poses and stated moves: {left} mm")


def _say_how_sensors_lie(console: Console, cell: CellConfig) -> None:
    for name, sensor in cell.force_sensors.items():
        _say(console, f"force_sensors.{name}", how_it_lies(sensor))


def _say_what_the_daemon_needs(console: Console, cell: CellConfig, folder: Path) -> None:
    """Hints, not errors: whoever checks a file is often neither the user nor on the PC that the
    daemon runs as and on."""
    for hint in hints_of_this_pc(cell, folder):
        print_hanging(console, f"  {hint}", _DETAIL, "yellow")


def _say_what_others_need(console: Console, cell: CellConfig) -> None:
    """Processes that are installed and have no recipe here: could this cell run them?

    A cell that has recipes is what it is; what it lacks for others is said of one that has none.
    """
    used = {recipe.process for recipe in cell.recipes}
    for name in installed_processes():
        if name in used:
            continue
        definition = process_definition(name)
        lacks = list(lacking_roles(cell, definition.roles))
        if lacks and used:
            continue
        text = (
            "no recipe; for one this cell is not complete:"
            if lacks
            else "no recipe; has its devices"
        )
        _say(console, f"process {name}", text)
        for allowed, same in _by_text(lacks).items():
            print_hanging(console, f"     {', '.join(same)}: {allowed}", _DETAIL)


def _by_text(issues: Iterable[ConfigIssue]) -> dict[str, list[str]]:
    """Keys by what belongs there: poses of one robot make one line instead of one for each."""
    found: dict[str, list[str]] = {}
    for issue in issues:
        found.setdefault(issue.allowed, []).append(issue.key)
    return found
