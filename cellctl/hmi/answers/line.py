"""The registers of the line PLC as the cell holds them."""

from collections.abc import Mapping
from typing import Any

from cellctl.hmi.answers.form import Form


class Register(Form):
    """One item of the register map."""

    address: int
    name: str
    text: str
    unit: str
    writer: str
    """Who writes it: `cell` (input registers) or `line` (holding registers)."""
    value: Any
    """What the cell says, null for a value that there is not; of what the line writes the plain
    words of its registers."""


class RegisterList(Form):
    """The register map with its values; the cell says them anew every 3 s."""

    line_alive: bool | None
    """The heartbeat of the line PLC is there."""
    control: str | None
    """`line` while the line PLC is in control, else `shared`."""
    heartbeat_age_s: float | None
    """Time since the heartbeat of the line changed; null where it never did."""
    registers: tuple[Register, ...]


def register_list(snapshot: Mapping[str, Any], registers: tuple[Register, ...]) -> RegisterList:
    """All of them with the state of the line."""
    return RegisterList(
        line_alive=snapshot.get("line_alive"),
        control=snapshot.get("control"),
        heartbeat_age_s=snapshot.get("daemon", {}).get("line_beat_age_s"),
        registers=registers,
    )
