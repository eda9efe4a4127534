"""The outer state machine: ISA-TR88.00.02 (PackML), 2022 edition."""

from cellctl.packml.command import Command
from cellctl.packml.machine import PackMLMachine
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State

__all__ = ["Command", "Mode", "PackMLMachine", "RejectCode", "State"]
