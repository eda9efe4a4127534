"""The register map as data: what lies where, in which unit. `docs/register-map.md` shows it.

Zero-based addresses. The line writes holding registers and reads input registers, which no client
can write. Who changes an address or a meaning raises ``MAP_VERSION`` and adds to the history.
"""

from dataclasses import dataclass
from enum import StrEnum

MAP_VERSION = 8


class Kind(StrEnum):
    """How a value lies in registers."""

    U16 = "u16"
    BITS = "bits"
    U32 = "u32"
    I32 = "i32"
    F32 = "f32"
    TEXT = "text"


@dataclass(frozen=True, slots=True)
class Item:
    """One value of the map."""

    address: int
    name: str
    text: str
    kind: Kind = Kind.U16
    unit: str = ""
    length: int = 1
    """Length in registers."""

    @property
    def addresses(self) -> range:
        """Every register it occupies."""
        return range(self.address, self.address + self.length)


def _text(address: int, name: str, characters: int, text: str) -> Item:
    return Item(address, name, text, Kind.TEXT, length=characters // 2)


def _i32(address: int, name: str, unit: str, text: str) -> Item:
    return Item(address, name, text, Kind.I32, unit, length=2)


HOLDING: tuple[Item, ...] = (
    Item(0, "unit_mode", "1 Production, 2 Maintenance, 3 Manual; 0 keeps the mode"),
    Item(1, "cntrl_cmd", "PackML command; 0 with a mode or an alarm to acknowledge"),
    Item(2, "recipe_id", "recipe in Production, procedure in Maintenance"),
    Item(3, "options", "bit 0 dry run, bit 1 single step", Kind.BITS),
    Item(4, "spare_4", "spare, write 0"),
    Item(5, "spare_5", "spare, write 0"),
    _text(6, "serial", 24, "serial number of the part, A-Z 0-9 . _ -"),
    _text(18, "order", 16, "operator or order, A-Z 0-9 . _ -"),
    Item(26, "alarm_ack_id", "number of the alarm to acknowledge, 0 for none"),
    Item(27, "cmd_seq", "a change commits registers 0-26 and 28-39; 0 means no command"),
    _text(28, "mate_serial", 24, "serial number of the part it is joined to, or empty; as serial"),
    Item(40, "plc_heartbeat", "counter, in a request of its own"),
)

_ALARMS = tuple(
    Item(14 + index, f"alarm_{index + 1}", f"active alarm {index + 1}, 0 for none")
    for index in range(8)
)
VALIDITY_REGISTERS = {
    "stereo": (27, "the two stereo heads"),
    "base_frame": (28, "the base frame"),
    "board_transfer": (29, "head I to head II"),
    "payload": (30, "force sensor and payload"),
}
"""Groups of calibrations whose remaining hours the line sees: address and text of each. A further
one takes a free address."""
_VALIDITY = tuple(
    Item(
        address,
        f"validity_{name}",
        f"calibration of {what}; 0 is invalid, or nothing in this cell needs it",
        unit="h",
    )
    for name, (address, what) in VALIDITY_REGISTERS.items()
)
_POSE_ERROR = tuple(
    _i32(
        31 + 2 * index,
        f"pose_error_{axis}",
        "µm" if index < 3 else "µdeg",
        f"of the moved part: {axis}",
    )
    for index, axis in enumerate(("x", "y", "z", "rx", "ry", "rz"))
)
_PEAKS = tuple(
    _i32(
        43 + 2 * index, f"peak_{axis}", "mN" if index < 3 else "mN·m", f"greatest {axis} of the run"
    )
    for index, axis in enumerate(("fx", "fy", "fz", "mx", "my", "mz"))
)
REFUSALS = 8
_REFUSALS = tuple(
    Item(
        84 + 4 * index + offset,
        f"refusal_{index + 1}_{what}",
        f"refusal {index + 1}: {text}",
        unit=unit,
    )
    for index in range(REFUSALS)
    for offset, (what, unit, text) in enumerate(
        (
            ("age", "s", "how long ago; 65535 is that long or longer"),
            ("where", "", "mode x 256 + state at that moment"),
            ("request", "", "PackML command, or 0x100 + mode"),
            ("code", "", "reject code; 0 where there is no refusal"),
        )
    )
)

INPUT: tuple[Item, ...] = (
    Item(0, "seq_head", "equal to seq_tail when the block is of one piece"),
    Item(1, "map_version", "of this map"),
    Item(2, "state", "PackML StateCurrent"),
    Item(3, "mode", "PackML UnitModeCurrent"),
    Item(4, "state_requested", "PackML StateRequested"),
    Item(5, "status", "see the status bits", Kind.BITS),
    Item(6, "step", "inner step of Execute, see plc-integration.md"),
    Item(7, "ack_seq", "last cmd_seq that was taken or refused; 0: none since start"),
    Item(8, "done_seq", "last cmd_seq that has ended"),
    Item(9, "result", "of done_seq, see the results"),
    Item(10, "reject_code", "of ack_seq, see the reject codes; 0 when it was taken"),
    Item(11, "cell_heartbeat", "counter, driven by the state machine"),
    Item(12, "alarm_count", "active alarms, also those beyond the eight shown"),
    Item(13, "first_out_alarm", "fault number that stopped the cell (StopReason)"),
    *_ALARMS,
    Item(22, "recipe_active", "recipe or procedure of the present run"),
    Item(23, "cycle_counter", "parts since installation", Kind.U32, length=2),
    Item(25, "run_number", "number of the present or last run", Kind.U32, length=2),
    *_VALIDITY,
    *_POSE_ERROR,
    *_PEAKS,
    _text(55, "serial_echo", 24, "serial number of the present or last run"),
    Item(67, "test_u32", "always 0x12345678", Kind.U32, length=2),
    Item(69, "test_f32", "always 123.456", Kind.F32, length=2),
    _text(71, "test_text", 6, "always ABCDEF"),
    Item(74, "iteration", "of the measure-correct loop, or of a procedure, from 1; 0 outside them"),
    _i32(
        75,
        "force_z",
        "mN",
        "present force on the moved part along its z, without gravity, with inertia; no value "
        "while the payload is not known, no axes of a part are set, or the newest sample is more "
        "than 1 s old",
    ),
    _i32(77, "force_limit", "mN", "its limit in the present recipe"),
    Item(79, "run_result", "of run_number: 0 open, else as the results"),
    Item(80, "mode_time", "since the mode changed: PackML ModeTimeCurrent", Kind.U32, "s", 2),
    Item(82, "state_time", "since the state changed: PackML StateTimeCurrent", Kind.U32, "s", 2),
    *_REFUSALS,
    Item(
        116,
        "validity_least",
        "of the calibrations that this cell requires, the first to end; 0 is invalid, 65535 where "
        "none is required",
        unit="h",
    ),
    Item(124, "seq_tail", "equal to seq_head; will stay at 124"),
)

STATUS_BITS: tuple[tuple[str, str], ...] = (
    ("ready", "Idle, and Start would be taken; off with heartbeat_lost"),
    ("busy", "a command was taken and has not ended"),
    ("done", "the last command taken has ended; see result"),
    ("error", "a fault is latched"),
    ("warning", "an alarm is active that does not stop the cell"),
    (
        "heartbeat_lost",
        "plc_heartbeat stands still; off before its first change, when Reset is refused (0x101)",
    ),
    (
        "calibration_ok",
        "every calibration that production needs is valid, and none of any recipe is invalidated",
    ),
    ("simulation", "the devices are simulated; no part of this cell is real"),
    ("manual", "a robot is not in remote mode"),
    (
        "force_guard_tripped",
        "the guard has requested a stop and is latched, other than for the touch that a step looks "
        "for; it protects parts only",
    ),
    ("state_change_in_process", "PackML StateChangeInProcess"),
    ("hold_requested", "Hold or Suspend waits for the next safe point"),
    ("stop_not_confirmed", "a robot did not confirm its stop and may still move; see the alarms"),
)

UNDEFINED_I32 = -(2**31)
"""Stands in an i32 for a value that does not exist yet."""
HOLDING_SIZE = 41
INPUT_SIZE = 125
"""One FC4 request."""

_BY_NAME = {item.name: item for item in (*HOLDING, *INPUT)}


def item(name: str) -> Item:
    """An item of either block by its name."""
    return _BY_NAME[name]
