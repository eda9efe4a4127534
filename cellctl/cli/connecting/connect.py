"""Asks the devices of a checked cell file and shows what each has answered."""

import asyncio
from pathlib import Path

from rich.console import Console
from rich.status import Status
from rich.text import Text

from cellctl.cli.cell_daemon import require_no_daemon
from cellctl.cli.connecting.answer import Answer, remedy_here
from cellctl.cli.connecting.asking import ask_devices
from cellctl.config import CellConfig
from cellctl.errors import CellError
from cellctl.terminal.consoles import console_of_lines, print_hanging

LEFT_AS_FOUND = (
    "Nothing was moved, switched, re-armed or acknowledged. The links have ended with this "
    "command: a controller that stops when it loses them is latched until the daemon has re-armed "
    "it."
)


def asked(cell: CellConfig, cell_file: Path, socket: Path | None) -> list[Answer]:
    """The answers of all devices; on a terminal it says on stderr whom it waits for.

    Raises ``CellInUse`` while a daemon of this cell runs, before anything is asked.
    """
    require_no_daemon(cell, socket)
    waiting: list[str] = []
    with console_of_lines(stderr=True).status("connecting") as status:
        return asyncio.run(ask_devices(cell, cell_file.parent, _Waiting(status, waiting)))


class _Waiting:
    """Shows the devices that have not answered yet."""

    def __init__(self, status: Status, paths: list[str]) -> None:
        self._status = status
        self._paths = paths

    def __call__(self, path: str, begun: bool) -> None:  # noqa: FBT001 - as the questions tell it
        if begun:
            self._paths.append(path)
        else:
            self._paths.remove(path)
        self._status.update(Text(f"asking {', '.join(self._paths)}"))


def show(console: Console, answers: list[Answer]) -> None:
    """Every device with its answer, then what is to be done."""
    for answer in answers:
        _show_one(console, answer)
    devices = [answer for answer in answers if answer.asked]
    there = sum(answer.fault is None for answer in devices)
    other = sum(bool(answer.differs) for answer in devices)
    console.print(
        f"{there} of {len(devices)} devices answer, {other} of them differ from what is meant",
        style="bold green" if all(answer.good for answer in answers) else "bold red",
    )
    print_hanging(console, LEFT_AS_FOUND, 0)


def _serial(number: str) -> str:
    # A sensor whose box does not tell its number, and whose section states none, says so itself.
    if not number or number.startswith("no serial number"):
        return f", {number}" if number else ""
    return f", serial number {number}"


def _show_one(console: Console, answer: Answer) -> None:
    serial = _serial(answer.serial_number)
    says = "no answer" if answer.fault is not None else f"answers{serial}"
    if not answer.asked:
        says = "not asked, the PLC calls the daemon"
    style = None if answer.good else "bold red"
    console.print(f"{answer.path} by {answer.driver}: {says}", style=style)
    for name, text in answer.facts.items():
        print_hanging(console, f"  {name:24} {text}", 27)
    for note in answer.notes:
        print_hanging(console, f"  note: {note}", 8, "yellow")
    for fault in answer.faults:
        _show_fault(console, fault)


def _show_fault(console: Console, fault: CellError) -> None:
    print_hanging(console, f"  {fault}", 4, "bold red")
    print_hanging(console, f"    cause:  {fault.cause}", 12)
    print_hanging(console, f"    remedy: {remedy_here(fault)}", 12)
