"""The small fake cell and the daemon: every device of its cell file connects, the truth is told."""

from pathlib import Path

import pytest

from tests.rigs.whole_cell.own_cell import OwnCell, cellctl

pytestmark = pytest.mark.timeout(120)


def test_the_daemon_finds_every_device(tmp_path: Path) -> None:
    own = OwnCell.make(tmp_path, "small")
    try:
        assert set(own.fake().ready()["ports"]) == {"camera", "force", "control"}
        assert own.daemon().ready()["modbus_port"] == own.modbus_port
        # A daemon that has the cell keeps it: it is found by its socket, and without by its line.
        for words in ((), ("--socket", str(own.data / "cellctl.sock"))):
            asked = cellctl("check", str(own.cell), "--connect", *words)
            assert asked.returncode == 1, asked.stdout
            assert "F740 The devices of this cell are not asked" in asked.stderr
        assert "the daemon of small-cell runs and is" in asked.stderr
        with own.control() as control:
            assert control.request("status")["channels"] == {"arm": ["CMD", "GRD", "STA"]}
            truth = control.request("truth")["truth"]
        assert set(truth["plates"]["plate"]["holes_mm"]) == {"H1", "H2", "H3", "H4"}
        assert truth["payload_kg"] == {"force": 5.0}
    finally:
        own.kill_all()
