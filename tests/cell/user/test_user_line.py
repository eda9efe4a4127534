"""A PLC from outside, written from the documents only, drives the cell and is refused by them."""

from collections.abc import Iterator

import pytest

from tests.rigs.whole_cell.outside_plc import HOLDING, INPUT, OutsidePlc
from tests.rigs.whole_cell.own_cell import OwnCell, cellctl

pytestmark = pytest.mark.timeout(180)

PRODUCTION, MAINTENANCE, MANUAL = 1, 2, 3


@pytest.fixture
def plc(visited: OwnCell) -> Iterator[OutsidePlc]:
    visited.daemon().ready()
    with OutsidePlc(visited.modbus_port) as outside:
        yield outside


def test_a_cycle_with_its_refusals(visited: OwnCell, plc: OutsidePlc) -> None:
    _first_contact(plc)
    _nothing_from_before_the_start(plc)
    assert plc.command("Reset") == 0x101
    plc.start_heartbeat()
    _refused_in_stopped(plc)
    assert plc.command("Reset") == 0
    assert plc.done() == "done; for Start: the part is good"
    assert plc.state == "Idle"
    assert plc.bit("ready")
    assert plc.bit("simulation")
    _refused_in_idle(plc)
    _started_held_and_stopped(plc)
    assert plc.command("Reset") == 0
    plc.done(60)
    assert plc.state == "Idle"
    shown = cellctl("runs", "list", "--data-dir", str(visited.data))
    assert "OUTSIDE.1" in shown.stdout
    assert "stopped" in shown.stdout


def _first_contact(plc: OutsidePlc) -> None:
    block = plc.block()
    assert block[INPUT["map_version"]] == 8
    assert block[INPUT["test_u32"] : INPUT["test_u32"] + 2] == [0x1234, 0x5678]
    text = INPUT["test_text"]
    assert bytes(b for word in block[text : text + 3] for b in divmod(word, 256)) == b"ABCDEF"
    assert plc.state == "Stopped"
    assert plc.value("ack_seq") == 0
    assert plc.client.read_coils(0, count=1).exception_code == 1
    assert plc.client.read_input_registers(124, count=2).exception_code == 2
    assert plc.client.write_register(HOLDING["cmd_seq"] + 5, 1).exception_code == 2


def _nothing_from_before_the_start(plc: OutsidePlc) -> None:
    """Whatever stands in the PLC's registers is not executed."""
    plc.seq = 41
    assert plc.command("Start", mode=PRODUCTION, recipe=1, serial="OLD.1") == 0x100
    assert plc.done().startswith("stood in the registers when the cell started")
    assert plc.state == "Stopped"


def _refused_in_stopped(plc: OutsidePlc) -> None:
    assert plc.command("Start", mode=PRODUCTION, recipe=1, serial="A.1") == 0x84
    assert plc.done() == "not begun, see reject_code"
    assert plc.command("Clear") == 0x84
    assert plc.command(99) == 0x81
    assert plc.command("Reset", mode=99) == 0x80
    assert plc.command("Reset", mode=17) == 0x82
    assert plc.state == "Stopped"


def _refused_in_idle(plc: OutsidePlc) -> None:
    start = {"mode": PRODUCTION, "recipe": 1, "serial": "A.1"}

    def refused(**other: object) -> int:
        return plc.command("Start", **{**start, **other})  # type: ignore[arg-type]

    assert refused(recipe=77) == 0x102
    assert refused(mode=MAINTENANCE, recipe=7) == 0x102
    assert refused(serial="") == 0x103
    assert refused(serial="lower") == 0x103
    assert refused(order="A B") == 0x104
    assert refused(options=0x8000) == 0x105
    assert refused(mode=99) == 0x80
    assert refused(mode=17) == 0x82
    assert refused(mode=MANUAL) == 0x87
    assert plc.command(0, alarm=512) == 0x109
    assert plc.state == "Idle"
    assert plc.value("mode") == PRODUCTION


def _started_held_and_stopped(plc: OutsidePlc) -> None:
    assert plc.command("Start", mode=PRODUCTION, recipe=1, serial="OUTSIDE.1") == 0
    plc.until("Execute", lambda: plc.state == "Execute")
    plc.until("first step", lambda: plc.value("step") == 10)
    assert plc.value("run_result") == 0
    assert plc.command(0, mode=MAINTENANCE) == 0x83
    assert plc.command("Hold") == 0
    assert plc.bit("hold_requested") or plc.state == "Held"
    assert plc.done(60) == "done; for Start: the part is good"
    assert plc.state == "Held"
    assert plc.command("Unhold") == 0
    plc.done()
    assert plc.command("Stop") == 0
    plc.done(30)
    assert plc.state == "Stopped"
    assert plc.value("run_result") == 4


@pytest.mark.long
def test_a_heartbeat_that_stands_still(visited: OwnCell) -> None:
    visited.change("heartbeat_timeout_s = 3.0", "heartbeat_timeout_s = 1.0")
    visited.daemon().ready()
    with OutsidePlc(visited.modbus_port) as first:
        first.start_heartbeat()
        assert first.command("Reset") == 0
        first.done()
        assert first.command("Start", mode=PRODUCTION, recipe=1, serial="LOST.1") == 0
        first.until("Execute", lambda: first.state == "Execute")
    with OutsidePlc(visited.modbus_port) as second:
        second.until("loss", lambda: second.bit("heartbeat_lost"))
        second.until("Held", lambda: second.state == "Held", 60)
        assert second.value("first_out_alarm") == 701
        second.seq = second.value("ack_seq")
        assert second.command("Unhold") == 0x101
        assert second.command("Stop") == 0
        second.done(30)
        assert second.state == "Stopped"
