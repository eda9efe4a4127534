"""What is not there, or not well, while a cell runs: numbered faults, and the daemon stays."""

import json
from datetime import UTC, datetime, timedelta
from pathlib import Path
from shutil import copytree

import pytest

from cellctl.calibration.store.envelope import StoredCalibration, read_calibration, write_stored
from tests.rigs.whole_cell.endings import refuses, taken, waits
from tests.rigs.whole_cell.outside_plc import OutsidePlc
from tests.rigs.whole_cell.own_cell import ROOT, OwnCell, cellctl

pytestmark = pytest.mark.timeout(120)


@pytest.mark.parametrize("shipped", [7002, pytest.param(7003, marks=pytest.mark.long)])
def test_port_of_a_robot_is_taken(visited: OwnCell, shipped: int) -> None:
    port = visited.ports[shipped]
    with taken(port):
        waits(visited.daemon(), "F206", str(port))


@pytest.mark.long
def test_the_daemon_is_there_before_its_devices(own: OwnCell) -> None:
    """Every device that is missing is named, for the line too; Clear finds them once they are."""
    own.change('robot_name = "SR500A"', 'robot_name = "SR500A"\nconnect_timeout_s = 2.0', count=1)
    daemon = own.daemon()
    said = waits(daemon, "F201")
    for device in ("robots.main", "robots.aux_1", "robots.aux_2", "head_1", "head_2", "tracker"):
        assert device in said, device
    assert "force_sensors.force" in said
    with OutsidePlc(own.modbus_port) as plc:
        plc.start_heartbeat()
        assert (plc.state, plc.value("first_out_alarm")) == ("Aborted", 201)
        assert plc.command("Clear") == 0
        assert plc.done().startswith("ended in Aborted")
        assert plc.command("Reset") == 0x84
        own.fake().ready()
        for name in ("Clear", "Reset"):
            assert plc.command(name) == 0
            assert plc.done(60).startswith("done")
        assert plc.state == "Idle"
    daemon.ready()


@pytest.mark.parametrize(
    ("device", "fault", "words"),
    [
        pytest.param(
            "force", "silent", ("F205", "force sensor", "no frame"), marks=pytest.mark.long
        ),
        ("main", "wrong_version", ("F204", "SR500A", "SJL/9")),
        pytest.param("tracker", "silent", ("F205", "tracker"), marks=pytest.mark.long),
    ],
)
def test_one_device_is_silent_or_strange(
    visited: OwnCell, device: str, fault: str, words: tuple[str, ...]
) -> None:
    with visited.control() as control:
        control.request("inject", device=device, name=fault)
    said = waits(visited.daemon(), *words)
    assert "T90A-2" not in said  # which is well


@pytest.mark.long  # `tests/unit/records/test_store.py` shows the lock without two daemons
def test_store_is_in_use(visited: OwnCell) -> None:
    daemon = visited.daemon()
    daemon.ready()
    refuses(visited.daemon(), "F802", str(visited.data))
    assert daemon.process.poll() is None


@pytest.mark.long  # `tests/unit/calibration/store` shows each reason without a cell
def test_calibrations_that_cannot_be_used(visited: OwnCell) -> None:
    """One daemon, three states of the folder: Start is refused each time, with the reason."""
    folder = visited.folder / "calibration"
    visited.change(str(visited.calibration), str(folder))
    daemon = visited.daemon()
    daemon.ready()

    def refused() -> str:
        known = len(daemon.log)
        plc = visited.plc("--timeout", "30")
        assert plc.end(40) == 3
        assert plc.messages[-1]["reject_code"] == 0x106
        return "\n".join(str(entry.get("fault")) for entry in daemon.log[known:])

    assert "F632" in refused()  # missing
    copytree(ROOT / "config" / "demo-calibration", folder, dirs_exist_ok=True)
    payload = folder / "payload.json"
    payload.write_text(payload.read_text(encoding="utf-8").replace("1", "2", 1), encoding="utf-8")
    assert "F631" in refused()  # damaged
    _expire(folder, "head_2")
    copytree(
        ROOT / "config" / "demo-calibration",
        folder,
        dirs_exist_ok=True,
        ignore=lambda _folder, names: [name for name in names if name == "head_2.json"],
    )
    said = refused()
    assert "F633" in said
    assert "head_2" in said
    assert daemon.process.poll() is None


def _expire(folder: Path, kind: str) -> None:
    old = read_calibration(folder, kind)
    now = datetime.now(UTC)
    made, until = now - timedelta(days=200), now - timedelta(days=20)
    expired = StoredCalibration(kind, old.record, made, until, old.software, old.serial_number)
    write_stored(folder, expired)


@pytest.mark.long
def test_head_that_sees_no_hole(visited: OwnCell) -> None:
    with visited.control() as control:
        control.request("inject", device="head_1", name="no_hole")
    daemon = visited.daemon()
    daemon.ready()
    plc = visited.plc("--serial", "BLIND-1")
    assert plc.end(60) == 4
    assert plc.messages[-1]["result"] in ("stopped", "aborted")
    fault = daemon.logged("fault", timeout_s=5)
    assert 400 <= fault["number"] < 500
    assert "P" in fault["fault"]  # names the holes
    assert plc.messages[-1]["alarm"] == fault["number"]
    shown = cellctl("runs", "show", "1", "--data-dir", str(visited.data))
    assert f"F{fault['number']}" in shown.stdout
    assert "Traceback" not in daemon.stderr


@pytest.mark.long
def test_frame_server_that_never_answers(visited: OwnCell) -> None:
    visited.change("reply_timeout_s = 60.0", "reply_timeout_s = 3.0")
    daemon = visited.daemon()
    daemon.ready()
    with visited.control() as control:
        control.request("inject", device="head_2", name="silent")
    plc = visited.plc()
    assert plc.end(60) == 4
    fault = daemon.logged("fault", timeout_s=5)
    assert fault["number"] == 205
    assert "head_2" in fault["fault"]
    assert "Traceback" not in daemon.stderr


@pytest.mark.long
def test_demonstration_tells_the_fault(own: OwnCell) -> None:
    """A fault that the user injects: exit code, words, and a record all the same."""
    out = own.folder / "run"
    demo = own.demo(out, "--fault", "head_1:no_hole")
    assert demo.end(90) == 2
    demo.nobody_left()
    assert "Traceback" not in demo.stderr
    assert "not good: " in demo.stderr
    assert "F4" in demo.stderr
    assert "remedy: " in demo.stderr
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert not result["passed"]
    assert (out / "report" / "report.html").is_file()
