"""What an operator may ask of the unit at this moment, and why not the rest."""

from collections.abc import Mapping

from cellctl.command.validator import validate_authority, validate_in_mode
from cellctl.packml.command import Command
from cellctl.packml.machine import PackMLMachine
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.unit_command import Source, UnitCommand
from cellctl.packml.validation import validate_mode
from cellctl.runtime.jobs.factory import JobFactory

PLAIN = ("clear", "reset", "hold", "unhold", "stop", "abort")
"""Commands without parameters, by their name in the API."""
_STARTS = {"start": Mode.PRODUCTION, "procedure": Mode.MAINTENANCE}


def permitted(
    machine: PackMLMachine, jobs: JobFactory, *, line_alive: bool
) -> Mapping[str, RejectCode]:
    """By name of the request: NONE if it would be taken now, else why it would be refused.

    For whoever shows it to a person, for instance as a button that is greyed out. It decides
    nothing: the command path asks all of it again when a command comes.
    """
    found = {name: _plain(machine, Command[name.upper()], line_alive=line_alive) for name in PLAIN}
    for name, mode in _STARTS.items():
        found[name] = _start(machine, jobs, mode, line_alive=line_alive)
    others = [mode for mode in Mode if mode not in (machine.mode, Mode.INVALID)]
    codes = [_mode(machine, mode, line_alive=line_alive) for mode in others]
    # NONE is the smallest code: the choice of a mode is offered when one of them would be taken.
    found["mode"] = min(codes, default=RejectCode.NONE)
    return found


def _plain(machine: PackMLMachine, command: Command, *, line_alive: bool) -> RejectCode:
    asked = UnitCommand(Source.PAGE, cntrl_cmd=command)
    authority = validate_authority(asked, machine.mode, line_alive=line_alive)
    return authority or machine.validate(command)


def _start(machine: PackMLMachine, jobs: JobFactory, mode: Mode, *, line_alive: bool) -> RejectCode:
    asked = UnitCommand(Source.PAGE, cntrl_cmd=Command.START, in_mode=mode)
    authority = validate_authority(asked, machine.mode, line_alive=line_alive)
    code = authority or validate_in_mode(asked, machine.mode, machine.state)
    return code or machine.validate(Command.START) or jobs.refusal(mode)


def _mode(machine: PackMLMachine, mode: Mode, *, line_alive: bool) -> RejectCode:
    asked = UnitCommand(Source.PAGE, unit_mode=mode)
    authority = validate_authority(asked, machine.mode, line_alive=line_alive)
    return authority or validate_mode(machine.state, mode)
