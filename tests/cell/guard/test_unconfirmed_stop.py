"""The whole cell with a main robot that overhears every stop: it stands all the same."""

import time

import pytest

from tests.rigs.whole_cell.outside_plc import OutsidePlc
from tests.rigs.whole_cell.own_cell import OwnCell

pytestmark = [pytest.mark.timeout(300), pytest.mark.long]

MAINTENANCE = 2
IDENTIFY_PAYLOAD = 106
"""Its moves are long and straight."""
STANDS_S = 8.0
"""Time-out of the stop, dead man, and the controller's own latency."""


def test_an_abort_that_is_not_confirmed_ends_with_the_arm_at_rest(own: OwnCell) -> None:
    own.fake().ready()
    own.daemon().ready()
    with OutsidePlc(own.modbus_port) as plc, own.control() as control:

        def place() -> list[float]:
            flange: list[float] = control.request("truth")["truth"]["base_T_flange_mm_deg"]
            return flange

        def moves() -> bool:
            before = place()
            time.sleep(0.2)
            return max(abs(a - b) for a, b in zip(place(), before, strict=True)) > 0.5

        plc.start_heartbeat()
        plc.command("Clear")
        plc.command("Reset", mode=MAINTENANCE)
        plc.done(60)
        assert plc.command("Start", mode=MAINTENANCE, recipe=IDENTIFY_PAYLOAD, serial="STOP.1") == 0
        plc.until("a move in Execute", lambda: plc.state == "Execute" and moves(), 60)
        control.request("inject", device="main", name="ignore_stop")
        assert plc.command("Abort") == 0
        plc.until("standstill", lambda: not moves(), STANDS_S)
        plc.until("Aborted", lambda: plc.state == "Aborted", 30)
        assert plc.bit("stop_not_confirmed")
        assert plc.value("first_out_alarm") == 304
        assert not moves()
        control.request("clear", device="main")
        assert plc.command("Clear") == 0
        plc.done(30)
        assert plc.state == "Stopped"
        assert not plc.bit("stop_not_confirmed")
        assert not moves()
