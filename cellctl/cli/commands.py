"""The commands of `cellctl` by name, each loaded only when it is asked for."""

from collections.abc import Callable, Mapping

import typer

from cellctl.cli.operator.commands import add_operator_commands
from cellctl.cli.root import new_app

_CELL, _RECORDS, _OFFLINE = "The cell", "Records and faults", "From files, without a cell"


def whole_app() -> typer.Typer:
    """Every command, in the order of the help."""
    app = new_app()
    for name in ("check", "run", "demo"):
        _ADD[name](app)
    add_operator_commands(app)
    for name in ("runs", "replay", "faults", "calibrate", "measure", "identify-payload"):
        _ADD[name](app)
    return app


def app_with(name: str) -> typer.Typer | None:
    """A command line with this command alone; None for a name that is not here.

    Together the commands load OpenCV, scipy and matplotlib for seconds, and most need little of it.
    """
    if name not in _ADD:
        return None
    app = new_app()
    _ADD[name](app)
    return app


def _check(app: typer.Typer) -> None:
    from cellctl.cli.check import check

    app.command("check", rich_help_panel=_CELL)(check)


def _run(app: typer.Typer) -> None:
    from cellctl.cli.run import run

    app.command("run", rich_help_panel=_CELL)(run)


def _demo(app: typer.Typer) -> None:
    from cellctl.cli.demo import PASS_THROUGH, demo

    app.command("demo", rich_help_panel=_CELL, context_settings=PASS_THROUGH)(demo)


def _runs(app: typer.Typer) -> None:
    from cellctl.cli import runs

    app.add_typer(runs.app, name="runs", rich_help_panel=_RECORDS)


def _replay(app: typer.Typer) -> None:
    from cellctl.cli.replay import replay

    app.command("replay", rich_help_panel=_RECORDS)(replay)


def _faults(app: typer.Typer) -> None:
    from cellctl.cli.faults import faults

    app.command("faults", rich_help_panel=_RECORDS)(faults)


def _calibrate(app: typer.Typer) -> None:
    from cellctl.cli.offline import calibrate

    app.add_typer(calibrate.app, name="calibrate", rich_help_panel=_OFFLINE)


def _measure(app: typer.Typer) -> None:
    from cellctl.cli.offline.measure import measure

    app.command("measure", rich_help_panel=_OFFLINE)(measure)


def _identify_payload(app: typer.Typer) -> None:
    from cellctl.cli.offline.identify_payload import identify_payload

    app.command("identify-payload", rich_help_panel=_OFFLINE)(identify_payload)


_ADD: Mapping[str, Callable[[typer.Typer], None]] = {
    "check": _check,
    "run": _run,
    "demo": _demo,
    "runs": _runs,
    "replay": _replay,
    "faults": _faults,
    "calibrate": _calibrate,
    "measure": _measure,
    "identify-payload": _identify_payload,
}
