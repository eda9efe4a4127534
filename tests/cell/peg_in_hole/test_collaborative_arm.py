"""The antenna's cell with an arm that is reached by its remote interface, without a job."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.rigs.whole_cell.own_cell import OwnCell

PROCESS = ("--process", "antenna-module")


@pytest.fixture
def rpc(tmp_path: Path) -> Iterator[OwnCell]:
    cell = OwnCell.make(tmp_path, "antenna-rpc")
    yield cell
    cell.kill_all()


@pytest.mark.figures  # the contracts hold this arm to the same
@pytest.mark.timeout(120)
def test_the_daemon_finds_the_arm(rpc: OwnCell) -> None:
    assert "arm" in rpc.fake().ready()["ports"], "it listens"
    assert rpc.daemon().ready()["modbus_port"] == rpc.modbus_port
    plc = rpc.plc("--mode", "maintenance", "--recipe", "1")
    assert plc.end(60) != 0, "no procedure has this number"
    states = [message["state"] for message in plc.messages if message["event"] == "report"]
    assert states[0] == "STOPPED"
    assert states[-1] == "IDLE", "the arm went home"
    assert plc.messages[-1]["reject_code"] == 0x102


@pytest.mark.long
@pytest.mark.timeout(400)
def test_a_module_is_plugged(rpc: OwnCell) -> None:
    out = rpc.folder / "run"
    demo = rpc.demo(out, *PROCESS, "--seed", "2")
    assert demo.end(300) == 0, demo.stdout + demo.stderr
    demo.nobody_left()
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert result["passed"]
    assert result["pins_inside"] == result["pins"] == 15
    assert result["peak_side_n"] < 3.0
