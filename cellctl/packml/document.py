"""Writes the machine's page from its tables: ``python -m cellctl.packml.document FILE``."""

import sys
from collections import defaultdict
from pathlib import Path

from cellctl.packml.command import COMMANDS, Command
from cellctl.packml.mode import Mode
from cellctl.packml.state import STATES, State
from cellctl.packml.transition_tables import MODE_CHANGE_IN, NOT_IN_MODE, ON_COMMAND, WHEN_DONE

_INTRODUCTION = """\
# State machine

Generated from `cellctl/packml/transition_tables.py`; do not edit.

The unit follows ISA-TR88.00.02 (PackML), 2022 edition, with its default masks. The tables in that
file are the whole machine: `transitions` is built from them, and nothing else changes the state.

- Entering an acting state or Execute starts its coroutine; leaving cancels it. The next state
  begins when the cancelled coroutine has cleaned up. Stopping, Completing and Aborting, which begin
  with the stop of all motion, act at once and wait for it afterwards.
- Hold and Suspend in Execute are noted and executed at the next safe point of the step. Execute is
  then parked, not cancelled: after Unhold it goes on and is told that it was held. A process may
  begin again then: that of the deck lifts off, drives home and measures the frame anew.
- A numbered fault leads by its reaction to Holding, Stopping or Aborting; where the present state
  does not allow that, to the next stronger one. Any other exception aborts. Faults latch; the
  command that leaves Held, Stopped or Aborted (Unhold, Reset, Clear) releases them.
- A command is validated when it arrives and again when its turn comes.
- After a start of the daemon the unit is Stopped or Aborted, whatever it was before.
"""


def state_machine_document() -> str:
    """The whole page."""
    return "\n".join((_INTRODUCTION, _diagram(), _commands(), _modes()))


def _diagram() -> str:
    stoppable = {state for state in STATES if (state, Command.STOP) in ON_COMMAND}
    lines = ["```mermaid", "stateDiagram-v2", "    direction LR"]
    for (state, command), target in ON_COMMAND.items():
        if command not in (Command.STOP, Command.ABORT):
            lines.append(f"    {_name(state)} --> {_name(target)}: {_name(command)}")
    for state, target in WHEN_DONE.items():
        lines.append(f"    {_name(state)} --> {_name(target)}")
    lines += [
        "    [*] --> Stopped",
        "    note right of Stopping: Stop, from " + ", ".join(map(_name, sorted(stoppable))),
        "    note right of Aborting: Abort, from everywhere but Aborting and Aborted",
        "```",
        "",
    ]
    return "\n".join(lines)


def _commands() -> str:
    sources: dict[tuple[Command, State], list[State]] = defaultdict(list)
    for (state, command), target in ON_COMMAND.items():
        sources[command, target].append(state)
    lines = [
        "## Commands",
        "",
        "| command | number | accepted in | leads to |",
        "|---|---|---|---|",
    ]
    for command in COMMANDS:
        for (key, target), states in sources.items():
            if key is command:
                names = ", ".join(_name(state) for state in sorted(states))
                lines.append(f"| {_name(command)} | {int(command)} | {names} | {_name(target)} |")
    lines += ["", "## State complete", "", "| state | number | leads to |", "|---|---|---|"]
    for state in STATES:
        end = _name(WHEN_DONE[state]) if state in WHEN_DONE else "waits for a command"
        lines.append(f"| {_name(state)} | {int(state)} | {end} |")
    return "\n".join(lines) + "\n"


def _modes() -> str:
    where = ", ".join(_name(state) for state in sorted(MODE_CHANGE_IN))
    lines = [
        "## Modes",
        "",
        f"The mode changes in {where} only.",
        "",
        "| mode | number | no command leads to |",
        "|---|---|---|",
    ]
    for mode in Mode:
        if mode is not Mode.INVALID:
            names = ", ".join(_name(state) for state in sorted(NOT_IN_MODE[mode])) or "–"
            lines.append(f"| {_name(mode)} | {int(mode)} | {names} |")
    return "\n".join(lines) + "\n"


def _name(member: State | Command | Mode) -> str:
    return member.name.capitalize()


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(state_machine_document(), encoding="utf-8")
