"""The root command: options and appearance that every form of the command line has."""

from typing import Annotated

import typer

from cellctl.cli.help.help_groups import GroupedCommands

settings = {"debug": False}


def new_app(group: type[GroupedCommands] = GroupedCommands) -> typer.Typer:
    """`cellctl` without commands; ``group`` may find some of its own."""
    app = typer.Typer(
        name="cellctl",
        cls=group,
        help="Cell controller for vision- and force-guided satellite assembly.",
        no_args_is_help=True,
        # Faults are printed by ``main`` with their cause and remedy; a traceback is for bugs.
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
    )
    app.callback()(_root)
    return app


def _show_version(asked: bool) -> None:  # noqa: FBT001 - called by typer
    if asked:
        # Only here: git is asked for the revision of a checkout.
        from cellctl.version import software

        typer.echo(software())
        raise typer.Exit


def _root(
    *,
    debug: Annotated[bool, typer.Option(help="Show the traceback of a fault.")] = False,
    _version: Annotated[
        bool,
        typer.Option(
            "--version", help="Version and revision.", is_eager=True, callback=_show_version
        ),
    ] = False,
) -> None:
    """Numbered faults end with exit code 1 and one clear line; `--debug` shows where."""
    settings["debug"] = debug
