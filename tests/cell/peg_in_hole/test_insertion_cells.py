"""The fake cells in which a part finds its hole by touch, and the daemon: devices and truth."""

from pathlib import Path

import pytest

from tests.rigs.sweeps import sweep
from tests.rigs.whole_cell.own_cell import OwnCell

pytestmark = pytest.mark.timeout(120)


@pytest.mark.parametrize(
    ("cell", "seat_mm"), sweep((("connector", 10.0), ("pin", 12.0)), (("connector", 10.0),))
)
def test_the_daemon_finds_every_device(tmp_path: Path, cell: str, seat_mm: float) -> None:
    own = OwnCell.make(tmp_path, f"insertion-{cell}")
    try:
        assert set(own.fake().ready()["ports"]) == {"force", "control"}
        assert own.daemon().ready()["modbus_port"] == own.modbus_port
        with own.control() as control:
            assert control.request("status")["channels"] == {"arm": ["CMD", "GRD", "STA"]}
            control.request("inject", device="world", name="peg_slip", grip_n=5.0)
            assert control.request("load")["load"] == 2
            truth = control.request("truth")["truth"]
        assert truth["seat_depth_mm"] == seat_mm
        assert not truth["seated"]
        assert truth["peak_force_n"]["1_ms"] == 0.0
    finally:
        own.kill_all()
