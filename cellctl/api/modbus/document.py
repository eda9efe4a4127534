"""Writes the register map: ``python -m cellctl.api.modbus.document docs/register-map.md``."""

import sys
from collections.abc import Iterable
from pathlib import Path

from cellctl.api.modbus.register_map import HOLDING, INPUT, MAP_VERSION, STATUS_BITS, Item, Kind
from cellctl.packml.command import COMMANDS
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.packml.state import STATES

_HISTORY = (
    (1, "first map; angle errors are microdegrees"),
    (
        2,
        "test_text takes its third register (73); iteration, force_z, force_limit and run_result "
        "added at 74-79; seq_tail moved to 124, the end of the block, to stay there",
    ),
    (3, "status bit 12, stop_not_confirmed"),
    (4, "mode_time, state_time and the last eight refusals added at 80-115"),
    (5, "mate_serial added at holding 28-39"),
    (6, "validity_least added at 116"),
    (
        7,
        "status bit 9 is not set by the touch that a step looks for; force_z has no value in the "
        "sensor's own axes, where its sign could be wrong. No address has moved",
    ),
    (
        8,
        "force_z has no value when the newest sample of the sensor is more than 1 s old, as after "
        "the death of its guard; status bit 6 is off while a calibration of any recipe is "
        "invalidated. No address has moved",
    ),
)
_RESULTS = {
    Result.NONE: "not ended",
    Result.GOOD: "done; for Start: the part is good",
    Result.BAD: "ended elsewhere than asked; for Start: the part is not good",
    Result.REJECTED: "not begun, see reject_code",
    Result.STOPPED: "ended in Stopped",
    Result.ABORTED: "ended in Aborted",
    Result.IGNORED: "stood in the registers when the cell started; not executed",
}


def register_map_document() -> str:
    """The whole page."""
    sections = (
        _INTRODUCTION.format(version=MAP_VERSION),
        "## Holding registers: the line writes (FC 6, 16, 22, 23; read back with FC 3)\n",
        _items(HOLDING),
        "## Input registers: the line reads (FC 4)\n",
        "Addresses that are not listed are spare and read 0.\n",
        _items(INPUT),
        "## Status bits (input 5)\n",
        _table(("bit", "name", "meaning"), ((i, *bit) for i, bit in enumerate(STATUS_BITS))),
        "## States (input 2 and 4)\n",
        _numbers(STATES),
        "## Commands (holding 1)\n",
        _numbers(COMMANDS),
        "## Modes (holding 0, input 3)\n",
        _numbers(mode for mode in Mode if mode is not Mode.INVALID),
        "## Results (input 9 and 79)\n",
        _table(("number", "meaning"), ((int(result), text) for result, text in _RESULTS.items())),
        "## Reject codes (input 10)\n",
        _table(("number", "meaning"), ((f"0x{int(c):X}", c.text) for c in RejectCode)),
        "## History\n",
        _table(("map_version", "change"), _HISTORY),
    )
    return "\n".join(sections)


_INTRODUCTION = """\
# Register map for the line PLC

Generated from `cellctl/api/modbus/register_map.py`; do not edit. Map version {version}.
How to use it: [plc-integration.md](plc-integration.md).

Addresses are zero-based. The cell is the Modbus TCP server; every unit id is served.
`u32`, `i32` and `f32` take two registers, high word first unless `plc.word_order` says otherwise
(input 67-73 tell). Text has two characters a register, high byte first, and is padded with NUL.
An `i32` of -2147483648 means that there is no value yet.
"""


def _items(items: Iterable[Item]) -> str:
    rows = ((_addresses(i), i.name, _kind(i), i.unit, i.text) for i in items)
    return _table(("address", "name", "type", "unit", "meaning"), rows)


def _addresses(item: Item) -> str:
    last = item.addresses[-1]
    return str(item.address) if last == item.address else f"{item.address}-{last}"


def _kind(item: Item) -> str:
    return f"text {2 * item.length}" if item.kind is Kind.TEXT else item.kind.value


def _numbers(members: Iterable[int]) -> str:
    rows = ((int(m), m.name.capitalize()) for m in members)  # type: ignore[attr-defined]
    return _table(("number", "name"), rows)


def _table(head: tuple[str, ...], rows: Iterable[tuple[object, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines) + "\n"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(register_map_document(), encoding="utf-8")
