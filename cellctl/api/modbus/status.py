"""The status that the line PLC sees, and the item of the register map for each value."""

from dataclasses import dataclass

from cellctl.api.modbus.encoding import Value, millionths, thousandths
from cellctl.api.modbus.register_map import MAP_VERSION, REFUSALS, STATUS_BITS, VALIDITY_REGISTERS
from cellctl.calibration.store.kind import Kinds
from cellctl.errors.internal import Unexpected
from cellctl.runtime.cell_status import CellStatus

_BIT = {name: 1 << number for number, (name, _) in enumerate(STATUS_BITS)}
_AXES = ("x", "y", "z", "rx", "ry", "rz")
_WRENCH = ("fx", "fy", "fz", "mx", "my", "mz")
_U16_MAX, _U32_MAX = 0xFFFF, 0xFFFF_FFFF


@dataclass(frozen=True, slots=True)
class Handshake:
    """What the interface itself adds to the status: the handshake and the heartbeats."""

    ack_seq: int = 0
    done_seq: int = 0
    result: int = 0
    reject_code: int = 0
    cell_heartbeat: int = 0
    heartbeat_lost: bool = False


def values(status: CellStatus, handshake: Handshake, seq: int) -> dict[str, Value]:
    """Every item of the input block by name."""
    alarms = (*status.alarms[:8], *(0,) * 8)[:8]
    return {
        "seq_head": seq,
        "seq_tail": seq,
        "map_version": MAP_VERSION,
        "state": status.state,
        "mode": status.mode,
        "state_requested": status.state_requested,
        "status": _status_word(status, handshake),
        "step": status.step,
        "iteration": status.iteration,
        "ack_seq": handshake.ack_seq,
        "done_seq": handshake.done_seq,
        "result": handshake.result,
        "reject_code": handshake.reject_code,
        "cell_heartbeat": handshake.cell_heartbeat,
        "alarm_count": len(status.alarms),
        "first_out_alarm": status.first_out_alarm,
        **{f"alarm_{index + 1}": number for index, number in enumerate(alarms)},
        "recipe_active": status.recipe_active,
        "cycle_counter": status.cycle_counter,
        "run_number": status.run_number,
        "run_result": status.run_result,
        **{
            f"validity_{name}": _hours(status.validity_h.get(name, 0.0))
            for name in VALIDITY_REGISTERS
        },
        "validity_least": _hours(status.validity_least_h),
        **{
            f"pose_error_{axis}": (thousandths if index < 3 else millionths)(value)
            for index, (axis, value) in enumerate(zip(_AXES, status.error_mm_deg, strict=True))
        },
        **{
            f"peak_{axis}": thousandths(value)
            for axis, value in zip(_WRENCH, status.force_peaks, strict=True)
        },
        "force_z": thousandths(status.force_z_n),
        "force_limit": thousandths(status.force_limit_n),
        "serial_echo": status.serial,
        "mode_time": min(_U32_MAX, int(status.mode_time_s)),
        "state_time": min(_U32_MAX, int(status.state_time_s)),
        **_refusals(status),
        "test_u32": 0x12345678,
        "test_f32": 123.456,
        "test_text": "ABCDEF",
    }


def require_registers(kinds: Kinds) -> None:
    """Raise ``Unexpected`` for a kind whose register the map does not have.

    The line would read 0 there for ever, and a validity that nobody shows is noticed by nobody.
    """
    for kind in kinds:
        if kind.register is not None and kind.register not in VALIDITY_REGISTERS:
            known = ", ".join(VALIDITY_REGISTERS)
            raise Unexpected(
                f"{kind.name}: no register validity_{kind.register}; there are {known}"
            )


def _hours(left_h: float) -> int:
    # Whole hours, rounded down: the line must not be told of one that is not left.
    return int(max(0.0, min(_U16_MAX, left_h)))


def _refusals(status: CellStatus) -> dict[str, Value]:
    found: dict[str, Value] = {}
    for index in range(REFUSALS):
        entry = status.refusals[index] if index < len(status.refusals) else None
        registers = (
            (0, 0, 0, 0)
            if entry is None
            else (
                min(_U16_MAX, int(entry.age_s)),
                entry.mode << 8 | entry.state,
                min(_U16_MAX, entry.request),
                int(entry.code),
            )
        )
        names = (f"refusal_{index + 1}_{what}" for what in ("age", "where", "request", "code"))
        found |= dict(zip(names, registers, strict=True))
    return found


def _status_word(status: CellStatus, handshake: Handshake) -> int:
    # Both numbers are 0 before the first command: nothing is busy, and nothing is done either.
    ended = handshake.ack_seq == handshake.done_seq
    flags = {
        # A Start of a client whose heartbeat is lost is refused.
        "ready": status.ready and not handshake.heartbeat_lost,
        "busy": not ended,
        "done": ended and handshake.ack_seq != 0,
        "error": status.error,
        "warning": status.warning,
        "heartbeat_lost": handshake.heartbeat_lost,
        "calibration_ok": status.calibration_ok,
        "simulation": status.simulation,
        "manual": status.manual,
        "force_guard_tripped": status.force_guard_tripped,
        "state_change_in_process": status.state is not status.state_requested,
        "hold_requested": status.hold_requested,
        "stop_not_confirmed": status.stop_not_confirmed,
    }
    return sum(_BIT[name] for name, on in flags.items() if on)
