"""The small fake cell and the daemon: every device of its cell file connects, the truth is told."""

from pathlib import Path

import pytest

from tests.rigs.whole_cell.own_cell import OwnCell

pytestmark = pytest.mark.timeout(120)


def test_the_daemon_finds_every_device(tmp_path: Path) -> None:
    own = OwnCell.make(tmp_path, "small")
    try:
        assert set(own.fake().ready()["ports"]) == {"camera", "force", "control"}
        assert own.daemon().ready()["modbus_port"] == own.modbus_port
        with own.control() as control:
            assert control.request("status")["channels"] == {"arm": ["CMD", "GRD", "STA"]}
            truth = control.request("truth")["truth"]
        assert set(truth["plates"]["plate"]["holes_mm"]) == {"H1", "H2", "H3", "H4"}
        assert truth["payload_kg"] == {"force": 5.0}
    finally:
        own.kill_all()
