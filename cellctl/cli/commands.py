"""The commands of `cellctl` by name, each loaded only when it is asked for.

Offline commands of a process are found as entry points of the group ``cellctl.command``: a name and
a function that takes a Typer application and adds the command of that name to it. Those of the
group ``cellctl.calibrate`` are added to `cellctl calibrate`.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import astuple
from typing import Any, cast

import typer
from typer.core import TyperGroup

from cellctl import plugins
from cellctl.cli.help.help_groups import OFFLINE, GroupedCommands
from cellctl.cli.help.listing import CELL, FILES, OPERATOR, installed
from cellctl.cli.root import new_app
from cellctl.errors.config import UnknownDriver
from cellctl.terminal.consoles import print_warning

_CELL, _RECORDS = "The cell", "Records and faults"
_OPERATOR_NAMES = frozenset(listed.name for listed in OPERATOR)


class LoadedWhenAsked(GroupedCommands):
    """Every command of `cellctl`; only the one that is asked for is loaded."""

    def list_commands(self, ctx: Any) -> list[str]:
        """All names, in the order of the help."""
        return [name for name, _, _ in self.rows(ctx)]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """The command of this name, loaded now; None for a name that there is not."""
        app = app_with(cmd_name)
        if app is None:
            return None
        return cast(TyperGroup, typer.main.get_command(app)).get_command(ctx, cmd_name)

    def rows(self, ctx: Any) -> Iterator[tuple[str, str, str]]:  # noqa: ARG002
        """Name, panel and summary of each command."""
        listed = (*CELL, *OPERATOR, *FILES, *installed(_from_processes()))
        yield from (astuple(one) for one in listed)


def whole_app() -> typer.Typer:
    """Every command, in the order of the help."""
    return new_app(LoadedWhenAsked)


def app_with(name: str) -> typer.Typer | None:
    """A command line with this command alone; None for a name that is not here.

    Together the commands load OpenCV, scipy and matplotlib for seconds, and most need little of it.
    """
    if name in _OPERATOR_NAMES:
        # Their messages are models of pydantic, which take a while to build.
        from cellctl.cli.operator.commands import app as operator_app

        return operator_app
    app = new_app()
    if name in _ADD:
        _ADD[name](app)
    elif name in _from_processes():
        plugins.load_function(plugins.COMMAND, name)(app)
    else:
        return None
    return app


def _from_processes() -> list[str]:
    """Commands that processes bring. One of ours keeps its name and its meaning."""
    ours = {*_ADD, *_OPERATOR_NAMES}
    return [name for name in plugins.names(plugins.COMMAND) if name not in ours]


def _add_from_process(app: typer.Typer, group: str, name: str) -> None:
    try:
        plugins.load_function(group, name)(app)
    except UnknownDriver as fault:
        # The help of all other commands must not fail because one package is incomplete. Whoever
        # asks for this command by its name gets the fault.
        print_warning(str(fault))


def _check(app: typer.Typer) -> None:
    from cellctl.cli.check import check

    app.command("check", rich_help_panel=_CELL)(check)


def _doctor(app: typer.Typer) -> None:
    from cellctl.cli.commissioning.doctor import doctor

    app.command("doctor", rich_help_panel=_CELL)(doctor)


def _run(app: typer.Typer) -> None:
    from cellctl.cli.run import run

    app.command("run", rich_help_panel=_CELL)(run)


def _demo(app: typer.Typer) -> None:
    from cellctl.cli.demo import PASS_THROUGH, demo

    app.command("demo", rich_help_panel=_CELL, context_settings=PASS_THROUGH)(demo)


def _study(app: typer.Typer) -> None:
    from cellctl.cli.demo import PASS_THROUGH
    from cellctl.cli.study import study

    app.command("study", rich_help_panel=OFFLINE, context_settings=PASS_THROUGH)(study)


def _robot(app: typer.Typer) -> None:
    from cellctl.cli.commissioning.robot import robot

    app.command("robot", rich_help_panel=_CELL)(robot)


def _keys(app: typer.Typer) -> None:
    from cellctl.cli.commissioning.keys import keys

    app.command("keys", rich_help_panel=_CELL)(keys)


def _teach(app: typer.Typer) -> None:
    from cellctl.cli.commissioning.teach import teach

    app.command("teach", rich_help_panel=_CELL)(teach)


def _service_limits(app: typer.Typer) -> None:
    from cellctl.cli.commissioning.service_limits import limits

    app.command("service-limits", rich_help_panel=_CELL)(limits)


def _grab(app: typer.Typer) -> None:
    from cellctl.cli.cameras.grab import grab

    app.command("grab", rich_help_panel=_CELL)(grab)


def _focus(app: typer.Typer) -> None:
    from cellctl.cli.cameras.focus import focus

    app.command("focus", rich_help_panel=_CELL)(focus)


def _runs(app: typer.Typer) -> None:
    from cellctl.cli.records import runs

    app.add_typer(runs.app, name="runs", rich_help_panel=_RECORDS)


def _calibrations(app: typer.Typer) -> None:
    from cellctl.cli.records import calibrations

    app.add_typer(calibrations.app, name="calibrations", rich_help_panel=_RECORDS)


def _replay(app: typer.Typer) -> None:
    from cellctl.cli.records.replay import replay

    app.command("replay", rich_help_panel=_RECORDS)(replay)


def _audit(app: typer.Typer) -> None:
    from cellctl.cli.records.audit import audit

    app.command("audit", rich_help_panel=_RECORDS)(audit)


def _faults(app: typer.Typer) -> None:
    from cellctl.cli.faults import faults

    app.command("faults", rich_help_panel=_RECORDS)(faults)


def _fleet(app: typer.Typer) -> None:
    from cellctl.cli.fleet.app import app as fleet

    app.add_typer(fleet, name="fleet", rich_help_panel=_RECORDS)


def _calibrate(app: typer.Typer) -> None:
    from cellctl.cli.offline import calibrate

    # The application of `calibrate` lasts longer than this one, so a name may be there already.
    known = {command.name for command in calibrate.app.registered_commands}
    for name in plugins.names(plugins.CALIBRATE):
        if name not in known:
            _add_from_process(calibrate.app, plugins.CALIBRATE, name)
    app.add_typer(calibrate.app, name="calibrate", rich_help_panel=OFFLINE)


def _measure(app: typer.Typer) -> None:
    from cellctl.cli.offline.measure import measure

    app.command("measure", rich_help_panel=OFFLINE)(measure)


def _identify_payload(app: typer.Typer) -> None:
    from cellctl.cli.offline.identify_payload import identify_payload

    app.command("identify-payload", rich_help_panel=OFFLINE)(identify_payload)


def _judge_insertion(app: typer.Typer) -> None:
    from cellctl.cli.offline.judge_insertion import judge_insertion

    app.command("judge-insertion", rich_help_panel=OFFLINE)(judge_insertion)


def _plan(app: typer.Typer) -> None:
    from cellctl.cli.planning.app import app as plan

    app.add_typer(plan, name="plan", rich_help_panel=OFFLINE)


_ADD: Mapping[str, Callable[[typer.Typer], None]] = {
    "check": _check,
    "doctor": _doctor,
    "run": _run,
    "demo": _demo,
    "robot": _robot,
    "teach": _teach,
    "keys": _keys,
    "service-limits": _service_limits,
    "grab": _grab,
    "focus": _focus,
    "runs": _runs,
    "calibrations": _calibrations,
    "replay": _replay,
    "faults": _faults,
    "audit": _audit,
    "fleet": _fleet,
    "calibrate": _calibrate,
    "measure": _measure,
    "judge-insertion": _judge_insertion,
    "identify-payload": _identify_payload,
    "plan": _plan,
    "study": _study,
}
