"""The map: no overlaps, the agreed addresses, values there and back."""

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.api.modbus.encoding import (
    WordOrder,
    decode,
    encode,
    input_block,
    millionths,
    thousandths,
)
from cellctl.api.modbus.register_map import (
    HOLDING,
    HOLDING_SIZE,
    INPUT,
    INPUT_SIZE,
    STATUS_BITS,
    UNDEFINED_I32,
    Item,
    Kind,
    item,
)
from cellctl.api.modbus.status import Handshake, require_registers, values
from cellctl.calibration.store.kind import CalibrationKind
from cellctl.errors.internal import Unexpected
from cellctl.packml import Mode, RejectCode, State
from cellctl.runtime.cell_status import CellStatus, ShownRefusal

# Written out from the agreed map, not derived from it.
AGREED = {
    "unit_mode": 0, "cntrl_cmd": 1, "recipe_id": 2, "options": 3, "serial": 6, "order": 18,
    "alarm_ack_id": 26, "cmd_seq": 27, "mate_serial": 28, "plc_heartbeat": 40,
    "seq_head": 0, "map_version": 1, "state": 2, "mode": 3, "state_requested": 4, "status": 5,
    "step": 6, "ack_seq": 7, "done_seq": 8, "result": 9, "reject_code": 10, "cell_heartbeat": 11,
    "alarm_count": 12, "first_out_alarm": 13, "alarm_1": 14, "alarm_8": 21, "recipe_active": 22,
    "cycle_counter": 23, "run_number": 25, "validity_stereo": 27, "validity_payload": 30,
    "pose_error_x": 31, "pose_error_rz": 41, "peak_fx": 43, "peak_mz": 53, "serial_echo": 55,
    "test_u32": 67, "test_f32": 69, "test_text": 71,
    "iteration": 74, "force_z": 75, "force_limit": 77, "run_result": 79, "seq_tail": 124,
    "mode_time": 80, "state_time": 82, "refusal_1_age": 84, "refusal_1_code": 87,
    "refusal_8_age": 112, "refusal_8_code": 115, "validity_base_frame": 28,
    "validity_board_transfer": 29, "validity_least": 116,
}  # fmt: skip


@pytest.mark.parametrize(("block", "size"), [(HOLDING, HOLDING_SIZE), (INPUT, INPUT_SIZE)])
def test_items_neither_overlap_nor_leave_the_block(block: tuple[Item, ...], size: int) -> None:
    used = [address for entry in block for address in entry.addresses]
    assert len(used) == len(set(used))
    assert max(used) == size - 1
    assert size <= 125


def test_the_addresses_are_the_agreed_ones() -> None:
    assert {name: item(name).address for name in AGREED} == AGREED


@pytest.mark.parametrize("order", ["big", "little"])
def test_test_patterns_tell_the_word_order(order: WordOrder) -> None:
    block = input_block(values(CellStatus(), Handshake(), 1), order)
    words = list(block[67:74])
    expected = [0x1234, 0x5678] if order == "big" else [0x5678, 0x1234]
    assert words[:2] == expected
    assert words[2:4] == ([0x42F6, 0xE979] if order == "big" else [0xE979, 0x42F6])
    assert words[4:] == [0x4142, 0x4344, 0x4546]


@given(st.integers(-(2**31), 2**31 - 1), st.sampled_from(["big", "little"]))
def test_i32_survives_the_wire(value: int, order: WordOrder) -> None:
    entry = Item(0, "x", "", Kind.I32, length=2)
    assert decode(entry, encode(entry, value, order), order) == value


@given(st.text("ABCXYZ0189._-", max_size=24))
def test_text_survives_the_wire(text: str) -> None:
    entry = Item(0, "x", "", Kind.TEXT, length=12)
    assert decode(entry, encode(entry, text, "big"), "big") == text


def test_lengths_become_micrometres_and_angles_microdegrees() -> None:
    status = CellStatus(
        error_mm_deg=(0.0123, -0.05, 12.0, 0.005, -0.0049999, 180.0),
        force_peaks=(35.0, -0.5, 49.999, 1.25, 0.0, -2.0),
    )
    shown = values(status, Handshake(), 7)
    assert [shown[f"pose_error_{a}"] for a in ("x", "y", "z", "rx", "ry", "rz")] == [
        12, -50, 12000, 5000, -5000, 180_000_000,
    ]  # fmt: skip
    assert [shown[f"peak_{a}"] for a in ("fx", "fy", "fz", "mx", "my", "mz")] == [
        35000, -500, 49999, 1250, 0, -2000,
    ]  # fmt: skip


def test_what_does_not_exist_is_undefined_and_what_is_too_large_is_clipped() -> None:
    assert thousandths(math.nan) == UNDEFINED_I32
    assert millionths(1e9) == 2**31 - 1
    assert thousandths(-math.inf) == -(2**31 - 1)
    assert values(CellStatus(), Handshake(), 1)["force_z"] == UNDEFINED_I32


def test_the_status_word_has_its_bits() -> None:
    names = [name for name, _ in STATUS_BITS]
    busy = values(CellStatus(simulation=True), Handshake(ack_seq=3, done_seq=2), 1)["status"]
    assert busy == (1 << names.index("busy")) | (1 << names.index("simulation"))
    changing = CellStatus(state=State.CLEARING, state_requested=State.STOPPED)
    done = values(changing, Handshake(ack_seq=3, done_seq=3, heartbeat_lost=True), 1)["status"]
    assert done == sum(
        1 << names.index(n) for n in ("done", "heartbeat_lost", "state_change_in_process")
    )
    assert values(CellStatus(), Handshake(), 1)["status"] == 0


@pytest.mark.parametrize("lost", [False, True])
def test_a_client_without_a_heartbeat_sees_no_cell_that_is_ready(lost: bool) -> None:
    """Its Start would be refused."""
    names = [name for name, _ in STATUS_BITS]
    word = values(CellStatus(ready=True), Handshake(heartbeat_lost=lost), 1)["status"]
    assert isinstance(word, int)
    assert bool(word & 1 << names.index("ready")) is not lost


def test_alarms_beyond_eight_are_counted() -> None:
    shown = values(CellStatus(alarms=tuple(range(501, 511))), Handshake(), 1)
    assert shown["alarm_count"] == 10
    assert (shown["alarm_1"], shown["alarm_8"]) == (501, 508)


def test_the_ring_of_refusals_begins_with_the_newest() -> None:
    code = RejectCode.COMMAND_NOT_ALLOWED
    refusals = (
        ShownRefusal(2.6, Mode.PRODUCTION, State.EXECUTE, 1, code),
        ShownRefusal(1e9, Mode.MAINTENANCE, State.IDLE, 0x103, RejectCode.MODE_CHANGE_NOT_ALLOWED),
    )
    shown = values(CellStatus(refusals=refusals), Handshake(), 1)
    entries = [
        tuple(shown[f"refusal_{n}_{what}"] for what in ("age", "where", "request", "code"))
        for n in (1, 2, 3)
    ]
    assert entries == [(2, 0x0106, 1, 0x84), (65535, 0x0204, 0x103, 0x83), (0, 0, 0, 0)]


def test_times_in_mode_and_state_are_whole_seconds() -> None:
    shown = values(CellStatus(mode_time_s=90_000.7, state_time_s=3.9), Handshake(), 1)
    assert (shown["mode_time"], shown["state_time"]) == (90_000, 3)


def test_head_and_tail_agree() -> None:
    block = input_block(values(CellStatus(), Handshake(), 0xBEEF), "big")
    assert block[0] == block[124] == 0xBEEF


def test_the_documented_map_is_current() -> None:
    from cellctl.api.modbus.document import register_map_document

    page = Path(__file__).parents[4] / "docs/register-map.md"
    assert page.read_text(encoding="utf-8") == register_map_document()


@pytest.mark.parametrize(
    ("left_h", "shown"), [(23.9, 23), (0.0, 0), (-1.0, 0), (1e6, 65535), (math.inf, 65535)]
)
def test_hours_are_whole_and_within_their_register(left_h: float, shown: int) -> None:
    status = CellStatus(validity_h={"stereo": left_h}, validity_least_h=left_h)
    found = values(status, Handshake(), 1)
    assert (found["validity_stereo"], found["validity_least"]) == (shown, shown)
    assert found["validity_payload"] == 0


def test_a_calibration_may_not_name_a_register_that_there_is_not() -> None:
    known = CalibrationKind(name="head", parse=dict, register="stereo")
    require_registers([known, CalibrationKind(name="tool", parse=dict)])
    with pytest.raises(Unexpected, match="no register validity_tool"):
        require_registers([known, CalibrationKind(name="tool", parse=dict, register="tool")])
