"""The register map as the line's programmer read it: docs/register-map.md, version 8."""

import struct
from collections.abc import Sequence
from dataclasses import dataclass

MAP_VERSION = 8
INPUT_COUNT = 125
HEARTBEAT_ADDRESS = 40
NO_VALUE = -(2**31)

STATES = (
    "UNDEFINED",
    "CLEARING",
    "STOPPED",
    "STARTING",
    "IDLE",
    "SUSPENDED",
    "EXECUTE",
    "STOPPING",
    "ABORTING",
    "ABORTED",
    "HOLDING",
    "HELD",
    "UNHOLDING",
    "SUSPENDING",
    "UNSUSPENDING",
    "RESETTING",
    "COMPLETING",
    "COMPLETED",
)
MODES = {"production": 1, "maintenance": 2, "manual": 3}
RESET, START, STOP, ABORT, CLEAR = 1, 2, 3, 8, 9
RESULTS = ("none", "good", "bad", "rejected", "stopped", "aborted", "ignored")
STATUS_BITS = (
    "ready",
    "busy",
    "done",
    "error",
    "warning",
    "heartbeat_lost",
    "calibration_ok",
    "simulation",
    "manual",
    "force_guard_tripped",
    "state_change_in_process",
    "hold_requested",
    "stop_not_confirmed",
)


@dataclass(frozen=True, slots=True)
class Report:
    """What the cell shows, in mm, degrees, N and N·m; None where there is no value."""

    state: str
    mode: int
    state_requested: str
    status: tuple[str, ...]
    step_number: int
    """Which step it is depends on the process of the cell."""
    iteration: int
    ack_seq: int
    done_seq: int
    result: str
    reject_code: int
    cell_heartbeat: int
    alarms: tuple[int, ...]
    first_out_alarm: int
    recipe: int
    run: int
    run_result: str
    error_mm: tuple[float | None, ...]
    error_deg: tuple[float | None, ...]
    force_peaks: tuple[float | None, ...]
    force_z_n: float | None
    force_limit_n: float | None
    serial: str


class MapMismatch(RuntimeError):
    """The cell does not show the map that this program was written for."""


def read_report(block: Sequence[int]) -> Report:
    """Input registers 0-124; raises ``MapMismatch`` when version or test patterns differ."""
    if block[1] != MAP_VERSION:
        raise MapMismatch(f"map_version is {block[1]}, this program knows {MAP_VERSION}")
    number = struct.unpack(">f", struct.pack(">HH", *block[69:71]))[0]
    # In a wrong order of words or bytes most fields would still look possible. For these three the
    # values are known beforehand.
    patterns = (_u32(block, 67), round(number, 3), _text(block, 71, 3))
    if patterns != (0x12345678, 123.456, "ABCDEF"):
        raise MapMismatch(f"test patterns read {patterns}: other word order?")
    # Equal when the block is of one piece (docs/register-map.md).
    if block[0] != block[124]:
        raise MapMismatch("the block is torn")
    errors = [_i32(block, 31 + 2 * index) for index in range(6)]
    peaks = [_i32(block, 43 + 2 * index) for index in range(6)]
    return Report(
        state=STATES[block[2]],
        mode=block[3],
        state_requested=STATES[block[4]],
        status=tuple(name for bit, name in enumerate(STATUS_BITS) if block[5] >> bit & 1),
        step_number=block[6],
        iteration=block[74],
        ack_seq=block[7],
        done_seq=block[8],
        result=RESULTS[block[9]],
        reject_code=block[10],
        cell_heartbeat=block[11],
        alarms=tuple(alarm for alarm in block[14:22] if alarm),
        first_out_alarm=block[13],
        recipe=block[22],
        run=_u32(block, 25),
        run_result=RESULTS[block[79]],
        error_mm=tuple(_scale(value, 1e3) for value in errors[:3]),
        error_deg=tuple(_scale(value, 1e6) for value in errors[3:]),
        force_peaks=tuple(_scale(value, 1e3) for value in peaks),
        force_z_n=_scale(_i32(block, 75), 1e3),
        force_limit_n=_scale(_i32(block, 77), 1e3),
        serial=_text(block, 55, 12),
    )


def command_block(
    seq: int, command: int, *, mode: int, recipe: int, serial: str, mate_serial: str = ""
) -> list[int]:
    """Holding registers 0-39."""
    parameters = [mode, command, recipe, 0, 0, 0, *_characters(serial, 12), *[0] * 8, 0]
    return [*parameters, seq, *_characters(mate_serial, 12)]


def _u32(block: Sequence[int], address: int) -> int:
    return block[address] << 16 | block[address + 1]


def _i32(block: Sequence[int], address: int) -> int:
    value = _u32(block, address)
    return value - (1 << 32) if value >> 31 else value


def _scale(value: int, divisor: float) -> float | None:
    return None if value == NO_VALUE else value / divisor


def _text(block: Sequence[int], address: int, registers: int) -> str:
    data = b"".join(word.to_bytes(2, "big") for word in block[address : address + registers])
    return data.split(b"\0")[0].decode("ascii", "replace")


def _characters(text: str, registers: int) -> list[int]:
    data = text.encode("ascii")
    if len(data) > 2 * registers:
        raise ValueError(f"{text!r} has more than {2 * registers} characters")
    padded = data.ljust(2 * registers, b"\0")
    return [int.from_bytes(padded[i : i + 2], "big") for i in range(0, len(padded), 2)]
