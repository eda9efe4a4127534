"""The outer state machine: ISA-TR88.00.02 (PackML), 2022 edition.

``transition_tables`` is the whole machine as data. ``chart`` builds a `transitions` machine from
it, ``validation`` says why a command is refused, ``activities`` runs the coroutine of each state,
and ``machine`` joins the three and reacts to faults. ``unit_command`` is a command in the form that
all interfaces share. Nothing here knows an interface, a device or a process.
"""

from cellctl.packml.command import Command
from cellctl.packml.machine import PackMLMachine
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State

__all__ = ["Command", "Mode", "PackMLMachine", "RejectCode", "State"]
