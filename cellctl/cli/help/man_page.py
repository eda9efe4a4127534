"""The manual page, `man cellctl`, made from the commands: `python -m cellctl.cli.help.man_page`.

Written with the macros of man(7). All commands are loaded for it, which takes seconds; it is made
once, by the installation.
"""

import datetime
import inspect
from collections.abc import Iterator
from typing import Any, cast

import typer
from typer.core import TyperGroup

from cellctl import __version__
from cellctl.cli.commands import LoadedWhenAsked, whole_app

_FILES = (
    ("/etc/cellctl/cell.toml", "The cell: devices, recipes, folders."),
    ("/var/lib/cellctl", "Run store, records and calibrations of the service."),
    ("/run/cellctl/cellctl.sock", "The running daemon listens here for commands of this PC."),
)


def man_page() -> str:
    """The whole page."""
    return "".join(f"{line}\n" for line in _lines())


def _lines() -> Iterator[str]:
    today = datetime.datetime.now(datetime.UTC).date()
    yield f'.TH CELLCTL 1 {today} "cellctl {__version__}"'
    yield ".SH NAME"
    yield r"cellctl \- cell controller for vision- and force-guided satellite assembly"
    yield ".SH SYNOPSIS"
    yield r".B cellctl \fICOMMAND\fR [\fIOPTIONS\fR] [\fIARGUMENTS\fR]"
    root = cast(LoadedWhenAsked, typer.main.get_command(whole_app()))
    context = typer.Context(root, info_name="cellctl")
    panel = ""
    for name, its_panel, _ in root.rows(context):
        if its_panel != panel:
            panel = its_panel
            yield f".SH {_escaped(panel.upper())}"
        yield from _command(name, root.get_command(context, name))
    yield ".SH FILES"
    for path, text in _FILES:
        yield from (".TP", f".I {path}", text)
    yield ".SH EXIT STATUS"
    yield "0 when all is good, 1 for what was refused or has failed, 2 for a wrong command line."


def _command(name: str, command: Any) -> Iterator[str]:
    """A command with its arguments and options; a group with its commands."""
    yield f".SS cellctl {_escaped(name)}"
    yield _text(command.help)
    for parameter in command.params:
        if text := getattr(parameter, "help", None):
            yield from (".TP", rf"\fB{_escaped(_written(parameter))}\fR", _text(text))
    if isinstance(command, TyperGroup):
        for below, its in command.commands.items():
            yield from _command(f"{name} {below}", its)


def _written(parameter: Any) -> str:
    if parameter.param_type_name == "argument":
        return str(parameter.name).upper()
    return ", ".join((*parameter.opts, *parameter.secondary_opts))


def _text(text: str | None) -> str:
    return _escaped(inspect.cleandoc(text or "").replace("\n\n", "\n.PP\n"))


def _escaped(text: str) -> str:
    """A line that begins with a dot or an apostrophe would be a request, and not every terminal has
    the character of three dots."""
    lines = text.replace("\\", r"\e").replace("-", r"\-").replace("…", "...").splitlines()
    return "\n".join(
        line if line == ".PP" or not line.startswith((".", "'")) else rf"\&{line}" for line in lines
    )


if __name__ == "__main__":
    typer.echo(man_page(), nl=False)
